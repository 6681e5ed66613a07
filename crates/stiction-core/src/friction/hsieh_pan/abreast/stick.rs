//! Steps of sticking hooks.

use super::{CLOSED, Lanes, TURNED};
use crate::exponential::faded;
use crate::friction::elements::branch::{SYNCHRONISED, short_way};
use crate::lanes::{Block, Bodies, WIDTH, pick};
use crate::scalar::{SHORT, SHORTER, second_share};

/// Steps of sticking hooks in one block or two, stage by stage: while one waits the other goes on.
/// With `ANY`, for those that missed the plain step.
#[inline(always)]
pub(super) fn stick<const ANY: bool, const N: usize>(blocks: &mut [Block<Lanes>; N]) {
    const { assert!(N == 1 || N == 2) };
    for lane in 0..WIDTH {
        // An only block is both, and the compiler leaves one of them out.
        let (p, q) = (&blocks[0], &blocks[N - 1]);
        let begun = [p.contacts.depart(lane, &p.bodies), q.contacts.depart(lane, &q.bodies)];
        let crept = [
            p.contacts.creep::<ANY>(lane, &begun[0], &p.bodies),
            q.contacts.creep::<ANY>(lane, &begun[1], &q.bodies),
        ];
        let pulled = [
            p.contacts.stretch::<ANY>(lane, &crept[0]),
            q.contacts.stretch::<ANY>(lane, &crept[1]),
        ];
        for (k, Block { bodies, contacts }) in blocks.iter_mut().enumerate() {
            contacts.arrive::<ANY>(lane, &begun[k], &crept[k], &pulled[k], bodies);
        }
    }
}

/// How a sticking hook begins a step, and what drives its creep.
#[derive(Clone, Copy)]
struct Departure {
    push: f64,
    displacement: f64,
    /// Sign of the force, limit less hardening, and what a held force would gain.
    side: f64,
    margin: f64,
    held: f64,
    /// What a displacement adds to the limit, α·h times that, and this one.
    gain: f64,
    pace: f64,
    risen: f64,
}

/// Creep of a step.
#[derive(Clone, Copy)]
struct Crept {
    hardening: f64,
    displacement: f64,
    left: f64,
    found: bool,
}

/// On which branch a spring goes on.
#[derive(Clone, Copy)]
struct Here {
    back: bool,
    closes: bool,
}

impl Here {
    #[inline(always)]
    fn pick(self, turned: f64, present: f64, older: f64) -> f64 {
        pick(self.back, turned, pick(self.closes, older, present))
    }
}

/// What a step does to the spring.
#[derive(Clone, Copy)]
struct Pulled {
    position: f64,
    force: f64,
    slope: f64,
    steps: f64,
    found: bool,
    back: bool,
    closes: bool,
}

impl Lanes {
    /// Where a step of a sticking hook goes to before its contact is asked.
    #[inline(always)]
    fn depart(&self, lane: usize, bodies: &Bodies) -> Departure {
        let velocity = bodies.velocity.0[lane];
        let (force, slope) = (self.force.0[lane], self.slope.0[lane]);
        let push = bodies.effort.0[lane] - force;
        let displacement = self.stride.0[lane] * velocity + bodies.lever.0[lane] * push;
        let side = 1.0_f64.copysign(force);
        let margin = self.coefficient.0[lane] * (force * force) - self.hardening.0[lane];
        let held = if margin > 0.0 { self.progress.0[lane] * margin } else { 0.0 };
        let towards = displacement - side * held;
        let moving = if towards == 0.0 { -side } else { 1.0_f64.copysign(towards) };
        let stiffness =
            if moving == self.direction.0[lane] { slope } else { self.initial_stiffness.0[lane] };
        let gain = self.twice_coefficient.0[lane] * force.abs() * stiffness;
        let pace = self.pace.0[lane] * force.abs() * stiffness;
        let risen = gain * (displacement * side);
        Departure { push, displacement, side, margin, held, gain, pace, risen }
    }

    /// `Plastic::plain_creep`. With `ANY`, also where creep begins or ends inside the step.
    #[inline(always)]
    fn creep<const ANY: bool>(&self, lane: usize, begun: &Departure, bodies: &Bodies) -> Crept {
        let Departure { displacement, side, margin, held, gain, pace, risen, .. } = *begun;
        let progress = self.progress.0[lane];
        let starts = margin > 0.0;
        let z = progress + pace;
        let second = second_share(z);
        let mean = 1.0 - z * second;
        let outrun = (risen < 0.0) & (margin * (1.0 - z * mean) + risen * mean < 0.0);
        let overtakes = (risen > 0.0) & (margin + risen > 0.0);
        let lagged = second * (held * side * z - pace * displacement);
        let gained = held - lagged * side;
        let rest = (displacement - held * side) + lagged;
        let idle = (self.force.0[lane] == 0.0) | (self.coefficient.0[lane] == 0.0);
        let creeps = starts & !idle;
        let long = z >= SHORTER;
        let plain = idle | if starts { !long & !outrun } else { !overtakes };
        let crept = Crept {
            hardening: if creeps { gained } else { 0.0 },
            displacement: if creeps { gained * side } else { 0.0 },
            left: if creeps { rest } else { displacement },
            found: plain,
        };
        if !ANY {
            return crept;
        }
        // `Plastic::any_creep`, whose sums have another order.
        let z = progress + progress * gain;
        let mean = 1.0 - z * second_share(z);
        let outrun = margin * (1.0 - z * mean) + risen * mean < 0.0;
        // `Plastic::overtaken` and `Plastic::outrun`.
        let (span, rate) = (bodies.span.0[lane], self.rate.0[lane]);
        let rise = gain * displacement * side / span;
        let (pace, since) = (z / span, margin / rise);
        let x = pace * margin / rise;
        // `logarithmic_mean`.
        let mean = 1.0 + x * (0.5 + x * (1.0 / 3.0 + x * (0.25 + x * (0.2 + x / 6.0))));
        let time = if starts { -since * mean } else { span + since };
        let z = pace * time;
        let second = second_share(z);
        let later = rise * (time * time * second);
        let sooner = margin * time * -(z * second - 1.0) + later;
        let gained = (if starts { sooner } else { later }) * rate;
        let taken = gained * side;
        let left = displacement - taken;
        let short = (z < SHORTER) & (!starts | (!long & outrun & (x.abs() < 1e-3)));
        Crept {
            hardening: pick(plain, crept.hardening, gained),
            displacement: pick(plain, crept.displacement, taken),
            left: pick(plain, crept.left, left),
            found: plain | short,
        }
    }

    /// `Here::onward`. With `ANY`, also where the spring turns round, closes a loop or is evaluated from
    /// its reverse point, which is due now and then and after a long way.
    #[inline(always)]
    fn stretch<const ANY: bool>(&self, lane: usize, crept: &Crept) -> Pulled {
        let left = crept.left;
        let (force, slope) = (self.force.0[lane], self.slope.0[lane]);
        let (direction, from) = (self.direction.0[lane], self.position.0[lane]);
        let position = from + left;
        let along = left * self.per_displacement.0[lane];
        let far = (self.steps.0[lane] >= f64::from(SYNCHRONISED)) | (along >= SHORT);
        let excess = slope - self.final_stiffness.0[lane];
        let [there, steepness] = short_way(force, slope, excess, left, along, |x| x);
        let back = direction * left < 0.0;
        let closes = direction * (position - self.present.target.0[lane]) >= 0.0;
        let plain = !far & !back & !closes;
        let onward = Pulled {
            position,
            force: there,
            slope: steepness,
            steps: self.steps.0[lane] + if left != 0.0 { 1.0 } else { 0.0 },
            found: plain & (direction != 0.0),
            back,
            closes,
        };
        if !ANY {
            return onward;
        }
        // `SpringState::walk_to`, where it closes at most one loop.
        let (new, old) = (&self.present, &self.older);
        let towards = if back { -direction } else { direction };
        let mirror = if self.mirrors.0[lane] != 0.0 { -from } else { f64::INFINITY * towards };
        let begin = new.origin.0[lane];
        let turned = if self.first.0[lane] != 0.0 { mirror } else { begin };
        let here = Here { back, closes };
        let target = here.pick(turned, new.target.0[lane], old.target.0[lane]);
        let origin = here.pick(from, new.origin.0[lane], old.origin.0[lane]);
        let anchor = here.pick(force, new.force.0[lane], old.force.0[lane]);
        let stretch = here.pick(towards, new.stretch.0[lane], old.stretch.0[lane]);
        let scale = here.pick(towards, new.scale.0[lane], old.scale.0[lane]);
        let way = (position - origin) * stretch;
        let gone = faded(-(way * self.inverse_distance.0[lane]));
        let gained = self.final_stiffness.0[lane] * way + self.faded_force.0[lane] * gone;
        let stiffness = self.initial_stiffness.0[lane] - self.fading.0[lane] * gone;
        let open = (way >= 0.0) & (towards * (position - target) < 0.0);
        Pulled {
            force: pick(plain, onward.force, anchor + gained * scale),
            slope: pick(plain, onward.slope, stiffness),
            steps: pick(plain, onward.steps, 0.0),
            found: (plain | open) & (direction != 0.0),
            ..onward
        }
    }

    /// The end of a step of a sticking hook, accepted where its parts were found and it holds. With
    /// `ANY`, of those that have missed it.
    #[inline(always)]
    fn arrive<const ANY: bool>(
        &mut self,
        lane: usize,
        begun: &Departure,
        crept: &Crept,
        pulled: &Pulled,
        bodies: &mut Bodies,
    ) {
        let Departure { push, displacement, .. } = *begun;
        let (effort, velocity) = (bodies.effort.0[lane], bodies.velocity.0[lane]);
        let (force, damping) = (pulled.force, self.damping.0[lane]);
        let unbraked = (self.kept.0[lane] * velocity + bodies.half.0[lane] * (push + effort))
            * self.share.0[lane];
        let arrived = unbraked - self.braking.0[lane] * force;
        let breaks = (force.abs() >= self.greatest.0[lane]) & (arrived * force > 0.0);

        let here = if ANY { bodies.missed[lane] != 0 } else { self.mode.0[lane] == 0.0 };
        let plain = crept.found & pulled.found & !breaks;
        let accepted = here & plain;
        bodies.missed[lane] = u64::from(here & !plain);
        if ANY {
            let turned = accepted & pulled.back;
            let closed = accepted & pulled.closes & !pulled.back;
            self.present.origin.take(lane, turned, self.position.0[lane]);
            self.present.force.take(lane, turned, self.force.0[lane]);
            self.direction.take(lane, turned, -self.direction.0[lane]);
            bodies.changed[lane] = TURNED * u64::from(turned) + CLOSED * u64::from(closed);
        }
        self.force.take(lane, accepted, force);
        self.slope.take(lane, accepted, pulled.slope);
        self.position.take(lane, accepted, pulled.position);
        self.steps.take(lane, accepted, pulled.steps);
        self.plastic.add(lane, accepted, crept.displacement);
        self.hardening.add(lane, accepted, crept.hardening);
        let friction = force + damping * arrived;
        bodies.accept(lane, accepted, displacement, arrived, friction);
    }
}
