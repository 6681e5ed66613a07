//! Steps of sticking hooks that do not all go on as they went: creep begins or ends, a spring turns
//! round, closes a loop or is evaluated from its reverse point.

use super::{CLOSED, Lanes, TURNED};
use crate::exponential::faded;
use crate::friction::elements::branch::{SYNCHRONISED, short_way};
use crate::lanes::{Block, Bodies, Row, WIDTH, pick};
use crate::scalar::{SHORT, SHORTER, second_share};

/// Steps of those sticking hooks of a row that have missed theirs. What few of them need is left out
/// where none does.
#[inline(always)]
#[allow(clippy::needless_range_loop)] // a lane of all rows at a time
pub(super) fn stick(block: &mut Block<Lanes>) {
    let Block { bodies, contacts } = block;
    let mut here = [0; WIDTH];
    let (mut crept, mut pulled) = (Creeps::default(), Pulls::default());
    let mut odd = 0;
    for lane in 0..WIDTH {
        here[lane] = u64::from((bodies.missed[lane] != 0) & (contacts.mode.0[lane] == 0.0))
            & bodies.alive[lane];
        let begun = contacts.depart(lane, bodies);
        odd |= here[lane] & !crept.take(lane, contacts.creep(lane, &begun));
    }
    if odd != 0 {
        for lane in 0..WIDTH {
            let begun = contacts.depart(lane, bodies);
            let any = contacts.any_creep(lane, &begun, bodies);
            let found = crept.found[lane] != 0;
            crept.take(lane, any.unless(found, crept.of(lane)));
        }
    }
    odd = 0;
    for lane in 0..WIDTH {
        let onward = contacts.stretch(lane, crept.left.0[lane]);
        odd |= here[lane] & !pulled.take(lane, onward);
    }
    if odd != 0 {
        for lane in 0..WIDTH {
            let found = pulled.found[lane] != 0;
            let walked = contacts.walk(lane, found, pulled.of(lane));
            pulled.take(lane, walked);
        }
    }
    for lane in 0..WIDTH {
        let (crept, pulled) = (crept.of(lane), pulled.of(lane));
        contacts.arrive(lane, here[lane] != 0, &crept, &pulled, bodies);
    }
}

/// How a sticking hook begins a step, and what drives its creep.
#[derive(Clone, Copy)]
struct Departure {
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

impl Crept {
    /// This, or another one where that was `found`.
    #[inline(always)]
    fn unless(self, found: bool, other: Self) -> Self {
        Self {
            hardening: pick(found, other.hardening, self.hardening),
            displacement: pick(found, other.displacement, self.displacement),
            left: pick(found, other.left, self.left),
            found: found | self.found,
        }
    }
}

/// The same, one in each lane.
#[derive(Clone, Copy, Default)]
struct Creeps {
    hardening: Row,
    displacement: Row,
    left: Row,
    found: [u64; WIDTH],
}

impl Creeps {
    /// Takes one in. Returns 1 where it was found.
    #[inline(always)]
    fn take(&mut self, lane: usize, crept: Crept) -> u64 {
        self.hardening.0[lane] = crept.hardening;
        self.displacement.0[lane] = crept.displacement;
        self.left.0[lane] = crept.left;
        self.found[lane] = u64::from(crept.found);
        self.found[lane]
    }

    #[inline(always)]
    fn of(&self, lane: usize) -> Crept {
        Crept {
            hardening: self.hardening.0[lane],
            displacement: self.displacement.0[lane],
            left: self.left.0[lane],
            found: self.found[lane] != 0,
        }
    }
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

/// The same, one in each lane.
#[derive(Clone, Copy, Default)]
struct Pulls {
    position: Row,
    force: Row,
    slope: Row,
    steps: Row,
    found: [u64; WIDTH],
    back: [u64; WIDTH],
    closes: [u64; WIDTH],
}

impl Pulls {
    /// Takes one in. Returns 1 where it was found.
    #[inline(always)]
    fn take(&mut self, lane: usize, pulled: Pulled) -> u64 {
        self.position.0[lane] = pulled.position;
        self.force.0[lane] = pulled.force;
        self.slope.0[lane] = pulled.slope;
        self.steps.0[lane] = pulled.steps;
        self.back[lane] = u64::from(pulled.back);
        self.closes[lane] = u64::from(pulled.closes);
        self.found[lane] = u64::from(pulled.found);
        self.found[lane]
    }

    #[inline(always)]
    fn of(&self, lane: usize) -> Pulled {
        Pulled {
            position: self.position.0[lane],
            force: self.force.0[lane],
            slope: self.slope.0[lane],
            steps: self.steps.0[lane],
            found: self.found[lane] != 0,
            back: self.back[lane] != 0,
            closes: self.closes[lane] != 0,
        }
    }
}

impl Lanes {
    /// Effort less force at the start, and the displacement of a sticking hook.
    #[inline(always)]
    fn pushed(&self, lane: usize, bodies: &Bodies) -> (f64, f64) {
        let push = bodies.effort.0[lane] - self.force.0[lane];
        let velocity = bodies.velocity.0[lane];
        (push, self.stride.0[lane] * velocity + bodies.lever.0[lane] * push)
    }

    /// Where a step of a sticking hook goes to before its contact is asked.
    #[inline(always)]
    fn depart(&self, lane: usize, bodies: &Bodies) -> Departure {
        let (force, slope) = (self.force.0[lane], self.slope.0[lane]);
        let (_, displacement) = self.pushed(lane, bodies);
        let side = 1.0_f64.copysign(force);
        let margin = self.coefficient.0[lane] * (force * force) - self.hardening.0[lane];
        let held = pick(margin > 0.0, self.progress.0[lane] * margin, 0.0);
        let towards = displacement - side * held;
        let moving = pick(towards == 0.0, -side, 1.0_f64.copysign(towards));
        let onward = moving == self.direction.0[lane];
        let stiffness = pick(onward, slope, self.initial_stiffness.0[lane]);
        let gain = self.twice_coefficient.0[lane] * force.abs() * stiffness;
        let pace = self.pace.0[lane] * force.abs() * stiffness;
        let risen = gain * (displacement * side);
        Departure { displacement, side, margin, held, gain, pace, risen }
    }

    /// `Plastic::plain_creep`.
    #[inline(always)]
    fn creep(&self, lane: usize, begun: &Departure) -> Crept {
        let Departure { displacement, side, margin, held, pace, risen, .. } = *begun;
        let starts = margin > 0.0;
        let z = self.progress.0[lane] + pace;
        let second = second_share(z);
        let mean = 1.0 - z * second;
        let outrun = (risen < 0.0) & (margin * (1.0 - z * mean) + risen * mean < 0.0);
        let overtakes = (risen > 0.0) & (margin + risen > 0.0);
        let long = z >= SHORTER;
        let lagged = second * (held * side * z - pace * displacement);
        let gained = held - lagged * side;
        let rest = (displacement - held * side) + lagged;
        let idle = (self.force.0[lane] == 0.0) | (self.coefficient.0[lane] == 0.0);
        let creeps = starts & !idle;
        Crept {
            hardening: pick(creeps, gained, 0.0),
            displacement: pick(creeps, gained * side, 0.0),
            left: pick(creeps, rest, displacement),
            found: idle | (starts & !long & !outrun) | (!starts & !overtakes),
        }
    }

    /// Creep that begins or ends inside the step, by `Plastic::any_creep`, whose sums have another
    /// order, `Plastic::overtaken` and `Plastic::outrun`.
    #[inline(always)]
    fn any_creep(&self, lane: usize, begun: &Departure, bodies: &Bodies) -> Crept {
        let Departure { displacement, side, margin, gain, pace, risen, .. } = *begun;
        let progress = self.progress.0[lane];
        let starts = margin > 0.0;
        let long = progress + pace >= SHORTER;
        let z = progress + progress * gain;
        let mean = 1.0 - z * second_share(z);
        let outrun = margin * (1.0 - z * mean) + risen * mean < 0.0;
        let (span, rate) = (bodies.span.0[lane], self.rate.0[lane]);
        let rise = gain * displacement * side / span;
        let (pace, since) = (z / span, margin / rise);
        let x = pace * margin / rise;
        // `logarithmic_mean`.
        let mean = 1.0 + x * (0.5 + x * (1.0 / 3.0 + x * (0.25 + x * (0.2 + x / 6.0))));
        let time = pick(starts, -since * mean, span + since);
        let z = pace * time;
        let second = second_share(z);
        let later = rise * (time * time * second);
        let sooner = margin * time * -(z * second - 1.0) + later;
        let gained = pick(starts, sooner, later) * rate;
        let taken = gained * side;
        Crept {
            hardening: gained,
            displacement: taken,
            left: displacement - taken,
            found: (z < SHORTER) & (!starts | (!long & outrun & (x.abs() < 1e-3))),
        }
    }

    /// `Here::onward`.
    #[inline(always)]
    fn stretch(&self, lane: usize, left: f64) -> Pulled {
        let (force, slope) = (self.force.0[lane], self.slope.0[lane]);
        let direction = self.direction.0[lane];
        let position = self.position.0[lane] + left;
        let along = left * self.per_displacement.0[lane];
        let far = (self.steps.0[lane] >= f64::from(SYNCHRONISED)) | (along >= SHORT);
        let excess = slope - self.final_stiffness.0[lane];
        let [there, steepness] = short_way(force, slope, excess, left, along, |x| x);
        let back = direction * left < 0.0;
        let closes = direction * (position - self.present.target.0[lane]) >= 0.0;
        Pulled {
            position,
            force: there,
            slope: steepness,
            steps: self.steps.0[lane] + pick(left != 0.0, 1.0, 0.0),
            found: !far & !back & !closes & (direction != 0.0),
            back,
            closes,
        }
    }

    /// `SpringState::walk_to`, where it closes at most one loop: the spring turns round, closes that or
    /// is evaluated from its reverse point, which is due now and then and after a long way. What was
    /// `found` stays.
    #[inline(always)]
    fn walk(&self, lane: usize, found: bool, onward: Pulled) -> Pulled {
        let Pulled { position, back, closes, .. } = onward;
        let (direction, from) = (self.direction.0[lane], self.position.0[lane]);
        let (new, old) = (&self.present, &self.older);
        let towards = pick(back, -direction, direction);
        let mirror = pick(self.mirrors.0[lane] != 0.0, -from, f64::INFINITY * towards);
        let begin = new.origin.0[lane];
        let turned = pick(self.first.0[lane] != 0.0, mirror, begin);
        let here = Here { back, closes };
        let target = here.pick(turned, new.target.0[lane], old.target.0[lane]);
        let origin = here.pick(from, new.origin.0[lane], old.origin.0[lane]);
        let anchor = here.pick(self.force.0[lane], new.force.0[lane], old.force.0[lane]);
        let stretch = here.pick(towards, new.stretch.0[lane], old.stretch.0[lane]);
        let scale = here.pick(towards, new.scale.0[lane], old.scale.0[lane]);
        let way = (position - origin) * stretch;
        let gone = faded(-(way * self.inverse_distance.0[lane]));
        let gained = self.final_stiffness.0[lane] * way + self.faded_force.0[lane] * gone;
        let stiffness = self.initial_stiffness.0[lane] - self.fading.0[lane] * gone;
        let open = (way >= 0.0) & (towards * (position - target) < 0.0);
        Pulled {
            force: pick(found, onward.force, anchor + gained * scale),
            slope: pick(found, onward.slope, stiffness),
            steps: pick(found, onward.steps, 0.0),
            found: found | (open & (direction != 0.0)),
            ..onward
        }
    }

    /// The end of a step of a sticking hook, accepted where one is `here`, its parts were found and it
    /// holds.
    #[inline(always)]
    fn arrive(
        &mut self,
        lane: usize,
        here: bool,
        crept: &Crept,
        pulled: &Pulled,
        bodies: &mut Bodies,
    ) {
        let (push, displacement) = self.pushed(lane, bodies);
        let (effort, velocity) = (bodies.effort.0[lane], bodies.velocity.0[lane]);
        let (force, damping) = (pulled.force, self.damping.0[lane]);
        let unbraked = (self.kept.0[lane] * velocity + bodies.half.0[lane] * (push + effort))
            * self.share.0[lane];
        let arrived = unbraked - self.braking.0[lane] * force;
        let breaks = (force.abs() >= self.greatest.0[lane]) & (arrived * force > 0.0);

        let accepted = here & crept.found & pulled.found & !breaks;
        bodies.missed[lane] &= u64::from(!accepted);
        let turned = accepted & pulled.back;
        let closed = accepted & pulled.closes & !pulled.back;
        self.present.origin.take(lane, turned, self.position.0[lane]);
        self.present.force.take(lane, turned, self.force.0[lane]);
        self.direction.take(lane, turned, -self.direction.0[lane]);
        bodies.changed[lane] = TURNED * u64::from(turned) + CLOSED * u64::from(closed);
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
