//! Steps of sticking hooks that do not all go on as they went: creep begins or ends, a spring turns
//! round, closes a loop or is evaluated from its reverse point.

use stiction_dispatch::{Mask, Vector};

use super::onward::{line, second};
use super::{Lanes, SLACK};
use crate::friction::elements::abreast::{Block, Bodies, Rest};
use crate::friction::elements::branch::SYNCHRONISED;
use crate::math::exponential::faded;
use crate::math::scalar::{SECOND, SHORT, SHORTER};

/// Steps of these sticking hooks of a row. What few of them need is left out where none does.
#[inline(always)]
pub(super) fn stick<V: Vector>(block: &mut Block<Lanes>, lanes: u8) -> Rest {
    let Block { bodies, contacts } = block;
    let (mut accepted, mut turned, mut closed, mut tame) = (0, 0, 0, 0);
    for chunk in 0..V::CHUNKS {
        let first = chunk * V::LANES;
        let bits = (lanes >> first) & ((1_u32 << V::LANES) - 1) as u8;
        if bits == 0 {
            continue;
        }
        let mut crept = contacts.known::<V>(chunk);
        if bits & !crept.found.bits() != 0 {
            let begun = contacts.depart(chunk, bodies);
            crept = contacts.creep(chunk, &begun).unless(&crept);
            if bits & !crept.found.bits() != 0 {
                crept = contacts.any_creep(chunk, &begun, bodies).unless(&crept);
            }
        }
        let mut pulled = contacts.stretch(chunk, crept.left);
        if bits & !pulled.found.bits() != 0 {
            pulled = contacts.walk(chunk, pulled);
        }
        let [all, back, closes, short] =
            contacts.arrive(chunk, V::Mask::of(bits), &crept, &pulled, bodies);
        accepted |= (all.bits() & bits) << first;
        turned |= (back.bits() & bits) << first;
        closed |= (closes.bits() & bits) << first;
        tame |= (short.bits() & bits) << first;
    }
    contacts.turned = turned;
    contacts.untold |= accepted;
    contacts.wild = contacts.wild & !accepted | accepted & !tame;
    Rest { missed: lanes & !accepted, changed: turned | closed }
}

/// How a sticking hook begins a step, and what drives its creep.
#[derive(Clone, Copy)]
struct Departure<V: Vector> {
    displacement: V,
    /// Sign of the force, limit less hardening, and what a held force would gain.
    side: V,
    margin: V,
    starts: V::Mask,
    held: V,
    /// What a displacement adds to the limit, α·h times that, and this one.
    gain: V,
    pace: V,
    risen: V,
}

/// A step up to the spring: the way of the body, creep, and the way of the spring.
#[derive(Clone, Copy)]
struct Crept<V: Vector> {
    displacement: V,
    hardening: V,
    left: V,
    found: V::Mask,
}

impl<V: Vector> Crept<V> {
    /// This, or another one where that was found.
    #[inline(always)]
    fn unless(self, other: &Self) -> Self {
        let found = other.found;
        Self {
            displacement: self.displacement,
            hardening: self.hardening.or(found, other.hardening),
            left: self.left.or(found, other.left),
            found: self.found.or(found),
        }
    }
}

/// On which branch a spring goes on.
#[derive(Clone, Copy)]
struct Here<V: Vector> {
    back: V::Mask,
    closes: V::Mask,
}

impl<V: Vector> Here<V> {
    #[inline(always)]
    fn pick(self, turned: V, present: V, older: V) -> V {
        present.or(self.closes, older).or(self.back, turned)
    }
}

/// What a step does to the spring.
#[derive(Clone, Copy)]
struct Pulled<V: Vector> {
    position: V,
    force: V,
    slope: V,
    steps: V,
    found: V::Mask,
    back: V::Mask,
    closes: V::Mask,
}

/// Where a number is another.
#[inline(always)]
fn equal<V: Vector>(one: V, other: V) -> V::Mask {
    one.within(other).and(other.within(one))
}

impl Lanes {
    /// What is known of steps already.
    #[inline(always)]
    fn known<V: Vector>(&self, chunk: usize) -> Crept<V> {
        let known = &self.known;
        Crept {
            displacement: known.displacement.at(chunk),
            hardening: known.hardening.at(chunk),
            left: known.left.at(chunk),
            found: V::Mask::of(known.lanes >> (chunk * V::LANES)),
        }
    }

    /// Where a step of a sticking hook goes to before its contact is asked.
    #[inline(always)]
    fn depart<V: Vector>(&self, chunk: usize, bodies: &Bodies) -> Departure<V> {
        let (force, slope) = (self.force.at::<V>(chunk), self.slope.at::<V>(chunk));
        let push = bodies.effort.at::<V>(chunk) - force;
        let velocity = bodies.velocity.at::<V>(chunk);
        let displacement =
            self.stride.at::<V>(chunk) * velocity + bodies.lever.at::<V>(chunk) * push;
        let (zero, one) = (V::all(0.0), V::all(1.0));
        let side = one.flipped(force);
        let margin =
            self.coefficient.at::<V>(chunk) * (force * force) - self.hardening.at::<V>(chunk);
        let starts = zero.below(margin);
        let held = (self.progress.at::<V>(chunk) * margin).kept(starts);
        let towards = displacement - side * held;
        let moving = one.flipped(towards).or(equal(towards, zero), side.minus());
        let onward = equal(moving, self.direction.at::<V>(chunk));
        let stiffness = self.initial_stiffness.at::<V>(chunk).or(onward, slope);
        let gain = self.twice_coefficient.at::<V>(chunk) * force.abs() * stiffness;
        let pace = self.pace.at::<V>(chunk) * force.abs() * stiffness;
        let risen = gain * (displacement * side);
        Departure { displacement, side, margin, starts, held, gain, pace, risen }
    }

    /// `Plastic::plain_creep`.
    #[inline(always)]
    fn creep<V: Vector>(&self, chunk: usize, begun: &Departure<V>) -> Crept<V> {
        let Departure { displacement, side, margin, starts, held, pace, risen, .. } = *begun;
        let (zero, one) = (V::all(0.0), V::all(1.0));
        let z = self.progress.at::<V>(chunk) + pace;
        let second = second(z);
        let mean = one - z * second;
        let outrun = (margin * (one - z * mean) + risen * mean).below_in(risen.below(zero), zero);
        let overtakes = zero.below_in(zero.below(risen), margin + risen);
        let long = V::all(SHORTER).within(z);
        let lagged = second * (held * side * z - pace * displacement);
        let gained = held - lagged * side;
        let rest = (displacement - held * side) + lagged;
        let idle =
            equal(self.force.at::<V>(chunk), zero).or(equal(self.coefficient.at::<V>(chunk), zero));
        let creeps = starts.but(idle);
        let goes_on = starts.but(long).but(outrun);
        let found = idle.or(goes_on).or(overtakes.or(starts).not());
        Crept {
            displacement,
            hardening: gained.kept(creeps),
            left: displacement.or(creeps, rest),
            found,
        }
    }

    /// Creep that begins or ends inside the step, by `Plastic::any_creep`, whose sums have another
    /// order, `Plastic::overtaken` and `Plastic::outrun`.
    #[inline(always)]
    fn any_creep<V: Vector>(
        &self,
        chunk: usize,
        begun: &Departure<V>,
        bodies: &Bodies,
    ) -> Crept<V> {
        let Departure { displacement, side, margin, starts, gain, pace, risen, .. } = *begun;
        let (zero, one) = (V::all(0.0), V::all(1.0));
        let progress = self.progress.at::<V>(chunk);
        let long = V::all(SHORTER).within(progress + pace);
        let z = progress + progress * gain;
        let mean = one - z * second(z);
        let outrun = (margin * (one - z * mean) + risen * mean).below(zero);
        let (span, rate) = (bodies.span.at::<V>(chunk), self.rate.at::<V>(chunk));
        let rise = gain * displacement * side / span;
        let (pace, since) = (z / span, margin / rise);
        let x = pace * margin / rise;
        // `logarithmic_mean`.
        let c = V::all;
        let mean = c(0.2) + x / c(6.0);
        let mean = one + x * (c(0.5) + x * (c(1.0 / 3.0) + x * (c(0.25) + x * mean)));
        let time = (span + since).or(starts, since.minus() * mean);
        let z = pace * time;
        let second = second(z);
        let later = rise * (time * time * second);
        let sooner = margin * time * (z * second - one).minus() + later;
        let gained = later.or(starts, sooner) * rate;
        let ends = outrun.but(long).and(x.abs().below(c(1e-3)));
        Crept {
            displacement,
            hardening: gained,
            left: displacement - gained * side,
            found: z.below(c(SHORTER)).and(ends.or(starts.not())),
        }
    }

    /// `Here::onward`.
    #[inline(always)]
    fn stretch<V: Vector>(&self, chunk: usize, left: V) -> Pulled<V> {
        let zero = V::all(0.0);
        let (force, slope) = (self.force.at::<V>(chunk), self.slope.at::<V>(chunk));
        let direction = self.direction.at::<V>(chunk);
        let steps = self.steps.at::<V>(chunk);
        let position = self.position.at::<V>(chunk) + left;
        let along = left * self.per_displacement.at::<V>(chunk);
        let far = V::all(f64::from(SYNCHRONISED)).within(steps).or(V::all(SHORT).within(along));
        let excess = slope - self.final_stiffness.at::<V>(chunk);
        let [there, steepness] = shortly(force, slope, excess, left, along);
        let back = (direction * left).below(zero);
        let closes = zero.within(direction * (position - self.present.target.at::<V>(chunk)));
        let still = equal(direction, zero);
        Pulled {
            position,
            force: there,
            slope: steepness,
            steps: steps + V::all(1.0).or(equal(left, zero), zero),
            found: far.or(back).or(closes.or(still)).not(),
            back,
            closes,
        }
    }

    /// `SpringState::walk_to`, where it closes at most one loop: the spring turns round, closes that or
    /// is evaluated from its reverse point, which is due now and then and after a long way. What was
    /// found stays.
    #[inline(always)]
    fn walk<V: Vector>(&self, chunk: usize, onward: Pulled<V>) -> Pulled<V> {
        let Pulled { position, back, closes, found, .. } = onward;
        let zero = V::all(0.0);
        let (direction, from) = (self.direction.at::<V>(chunk), self.position.at::<V>(chunk));
        let (new, old) = (&self.present, &self.older);
        let towards = direction.or(back, direction.minus());
        let mirrors = equal(self.mirrors.at::<V>(chunk), zero);
        let mirror = from.minus().or(mirrors, V::all(f64::INFINITY) * towards);
        let begin = new.origin.at::<V>(chunk);
        let turned = mirror.or(equal(self.first.at::<V>(chunk), zero), begin);
        let here = Here::<V> { back, closes };
        let target = here.pick(turned, new.target.at(chunk), old.target.at(chunk));
        let origin = here.pick(from, begin, old.origin.at(chunk));
        let force = self.force.at::<V>(chunk);
        let anchor = here.pick(force, new.force.at(chunk), old.force.at(chunk));
        let stretch = here.pick(towards, new.stretch.at(chunk), old.stretch.at(chunk));
        let scale = here.pick(towards, new.scale.at(chunk), old.scale.at(chunk));
        let way = (position - origin) * stretch;
        let gone = faded((way * self.inverse_distance.at::<V>(chunk)).minus());
        let gained =
            self.final_stiffness.at::<V>(chunk) * way + self.faded_force.at::<V>(chunk) * gone;
        let stiffness = self.initial_stiffness.at::<V>(chunk) - self.fading.at::<V>(chunk) * gone;
        let open = zero.within(way).and((towards * (position - target)).below(zero));
        Pulled {
            force: (anchor + gained * scale).or(found, onward.force),
            slope: stiffness.or(found, onward.slope),
            steps: zero.or(found, onward.steps),
            found: found.or(open.but(equal(direction, zero))),
            ..onward
        }
    }

    /// The end of a step of a sticking hook, accepted where one is `here`, its parts were found and it
    /// holds. Returns where it was, where its spring turned round and closed a loop, and where it is
    /// not `wild`.
    #[inline(always)]
    fn arrive<V: Vector>(
        &mut self,
        chunk: usize,
        here: V::Mask,
        crept: &Crept<V>,
        pulled: &Pulled<V>,
        bodies: &mut Bodies,
    ) -> [V::Mask; 4] {
        let zero = V::all(0.0);
        let (effort, velocity) = (bodies.effort.at::<V>(chunk), bodies.velocity.at::<V>(chunk));
        let (from, before) = (self.position.at::<V>(chunk), self.force.at::<V>(chunk));
        let (force, push) = (pulled.force, effort - before);
        let unbraked = (self.kept.at::<V>(chunk) * velocity
            + bodies.half.at::<V>(chunk) * (push + effort))
            * self.share.at::<V>(chunk);
        let arrived = unbraked - self.braking.at::<V>(chunk) * force;
        let reached = self.greatest.at::<V>(chunk).within(force.abs());
        let breaks = zero.below_in(reached, arrived * force);

        let accepted = here.and(crept.found).and(pulled.found).but(breaks);
        let turned = accepted.and(pulled.back);
        let closed = accepted.and(pulled.closes).but(pulled.back);
        self.present.origin.put_where(chunk, turned, from);
        self.present.force.put_where(chunk, turned, before);
        let back = self.direction.at::<V>(chunk).minus();
        self.direction.put_where(chunk, turned, back);
        self.force.put_where(chunk, accepted, force);
        self.slope.put_where(chunk, accepted, pulled.slope);
        self.position.put_where(chunk, accepted, pulled.position);
        self.steps.put_where(chunk, accepted, pulled.steps);
        self.plastic.more_where(chunk, accepted, crept.hardening.flipped(before));
        self.hardening.more_where(chunk, accepted, crept.hardening);
        bodies.go_where(chunk, accepted, crept.displacement, arrived);
        let steep = (pulled.slope * V::all(SLACK)).within(self.initial_stiffness.at(chunk));
        let short = force.abs().within(self.limit.at(chunk)).and(steep);
        let tame = short.and(zero.within(self.hardening.at(chunk)));
        [accepted, turned, closed, tame]
    }
}

/// `short_way`.
#[inline(always)]
pub(super) fn shortly<V: Vector>(force: V, slope: V, excess: V, left: V, along: V) -> [V; 2] {
    let (near, far) = (line(SECOND[0], SECOND[1], along), line(SECOND[2], SECOND[3], along));
    let square = along * along;
    let bent = (excess * left) * along;
    let fallen = excess * along;
    let eased = fallen * along;
    [
        ((force + left * slope) - bent * near) - (bent * square) * far,
        ((slope - fallen) + eased * near) + (eased * square) * far,
    ]
}
