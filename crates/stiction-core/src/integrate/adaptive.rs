//! Steps as long as an error allows, for inputs that are held long; rests in one evaluation.
//!
//! The body on its contact is taken as a damped oscillator, which is solved exactly, and a
//! remainder, which is fitted by a parabola through the start, the middle and the end of a step.
//! The longer a ring lasts, the smaller the remainder, and the longer the steps. A body on a spring
//! goes through its rings in rows of short steps ([`super::row`]).

use std::cell::Cell;

use super::events::Stepper;
use super::row::{Rows, Taken};
use super::swing::{Landing, Swing, located};
use crate::friction::{FrictionLaw, LawState, Motion};
use crate::math::scalar::sign;
use crate::plant::{Machine, Run, Work};
use crate::support::error::Error;
use crate::support::work::{IN_A_ROW, Meter, STEP};

/// Share of the tolerance that a step may add to the error, by an estimate of one order less.
const LOCAL: f64 = 0.05;
/// Share of the tolerance below which what is left of a ring is dropped.
const SILENT: f64 = 0.1;
/// Share of that by which a resting body may miss its balance.
const BALANCED: f64 = 1e-2;
/// Share of the tolerance by which a turn of the motion may be passed over.
const PASSED: f64 = 0.01;
/// Steps aim this much short of a turn, so that it is the last point of its branch.
const SHORT_OF_A_TURN: f64 = 0.997;
/// Swings that a ring without damping is thought to last.
const MOST_SWINGS: f64 = 100.0;
/// Steps grow by no more than this.
const GROWTH: f64 = 4.0;
/// The error is not asked below this share of a step of the fast integrator.
const FINEST: f64 = 1.0 / 64.0;
/// Events without any progress after which a step is taken as it is.
const MOST_EVENTS: u32 = 16;

/// Evaluations of friction too steep to be linearised take as long as so many others.
const STEEP: u64 = 3;
/// Steps of a row are fewer than what is done about them.
const AROUND: u64 = 2;

/// What a long run cost.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Account {
    /// Evaluations of the friction law.
    pub evaluations: u64,
    /// Steps accepted.
    pub steps: u64,
    /// Steps refused.
    pub refused: u64,
    /// Rests passed in one evaluation, or held rigidly.
    pub rests: u64,
}

/// The adaptive integrator: what it carries from step to step, none of it state of the machine.
#[derive(Debug, Clone)]
pub struct Adaptive {
    /// Error of a position that is allowed.
    tolerance: f64,
    /// Duration of a step of the fast integrator.
    natural: f64,
    /// The next step, as far as errors go.
    next: f64,
    /// Slopes of friction by position and velocity about which a step is solved.
    stiffness: f64,
    damping: f64,
    /// How many times its size what is left of a ring would still move the body.
    over: f64,
    rows: Rows,
    meter: Meter,
    /// Why it came to an end before its time.
    pub ended: Option<Error>,
    /// What it cost.
    pub account: Account,
}

impl Adaptive {
    /// With this error and so much work allowed; a step of the fast integrator lasts `natural`.
    pub fn new(tolerance: f64, natural: f64, most: f64) -> Self {
        Self {
            tolerance,
            natural,
            next: natural,
            stiffness: f64::NAN,
            damping: 0.0,
            over: 1.0,
            rows: Rows::new(tolerance, natural),
            meter: Meter::new(most),
            ended: None,
            account: Account::default(),
        }
    }
}

impl Adaptive {
    /// Runs on for `span` with input and load held.
    pub fn run<L: FrictionLaw<f64>>(
        &mut self,
        machine: &Machine<f64>,
        law: &L,
        state: &mut L::State,
        run: &mut Run<f64>,
        (input, load): (f64, f64),
        span: f64,
    ) {
        if self.stiffness.is_nan() {
            self.stiffness = law.greatest_stiffness();
        }
        let evaluations = Cell::new(0);
        let (stiffness, damping) = (self.stiffness, self.damping);
        let mut swing = Swing { machine, run, input, load, stiffness, damping, evaluations };
        // A new input: what the last steps were like says nothing of the next.
        self.next = self.next.min(16.0 * self.natural);
        self.over = 1.0;
        self.rows.begin::<L>(&swing);
        let (mut left, mut stalled, mut mayrest) = (span, 0, true);
        let evaluation = STEP * if L::STEEP { STEEP } else { 1 };
        let (mut counted, mut rowed) = (0, 0);
        while left > 0.0 {
            let evaluated = swing.evaluations.get() - counted;
            let alone = evaluated - rowed;
            // Also what is asked of the contact without an evaluation takes its time.
            let cost = AROUND * IN_A_ROW * rowed + evaluation * (alone + 1);
            self.ended = self.meter.take(cost).err();
            if self.ended.is_some() {
                break;
            }
            (counted, rowed) = (swing.evaluations.get(), 0);
            state.make_room(64);
            if swing.run.velocity == 0.0
                && let Some(held) = self.hold(&mut swing, law, state, left)
            {
                left = lesser(left, held, span);
                self.rows.leave(true);
                self.account.rests += 1;
                continue;
            }
            if stalled < MOST_EVENTS
                && let Some(event) = law.pending(state, swing.run.velocity)
            {
                law.switch(state, event);
                stalled += 1;
                continue;
            }
            if mayrest {
                match self.rest(&mut swing, law, state, left) {
                    Resting::Passed(rested) => {
                        left = lesser(left, rested, span);
                        self.rows.leave(false);
                        self.account.rests += 1;
                        continue;
                    }
                    Resting::Never => mayrest = false,
                    Resting::NotYet => (),
                }
            }
            let before = swing.evaluations.get();
            let passed = self.row(&mut swing, law, state, left);
            rowed = swing.evaluations.get() - before;
            if let Some(passed) = passed {
                left = lesser(left, passed, span);
                continue;
            }
            let counts = machine.counts_work();
            let work = counts
                .then(|| Work::begin(machine, swing.run, (input, load), (0.0, f64::INFINITY)));
            let passed = self.step(&mut swing, law, state, left, &mut stalled);
            if let Some(mut work) = work {
                work.rough = machine.roughness(law.greatest_stiffness(), passed);
                work.count(machine, swing.run);
            }
            left = lesser(left, passed, span);
            if swing.run.is_lost() {
                break;
            }
        }
        self.account.evaluations += swing.evaluations.get();
    }

    /// Plain steps in a row, where they are worth more than one of the oscillator; their duration.
    fn row<L: FrictionLaw<f64>>(
        &mut self,
        swing: &mut Swing<'_>,
        law: &L,
        state: &mut L::State,
        left: f64,
    ) -> Option<f64> {
        let worth = self.rows.worth();
        if self.next > worth && self.turn(swing, law, state).0 > worth {
            return None;
        }
        let taken = self.rows.take(swing, law, state, self.stiffness, left)?;
        let Taken { duration, steps, refused, stiffness, damping } = taken;
        (self.stiffness, self.damping) = (stiffness, damping);
        self.account.steps += steps as u64;
        self.account.refused += refused;
        // What the oscillator may do by now only a step of it can tell.
        self.next = self.next.max(GROWTH * duration);
        Some(duration)
    }

    /// One step, or one up to an event; its duration.
    fn step<L: FrictionLaw<f64>>(
        &mut self,
        swing: &mut Swing<'_>,
        law: &L,
        state: &mut L::State,
        left: f64,
        stalled: &mut u32,
    ) -> f64 {
        let (aim, way) = self.turn(swing, law, state);
        let mut span = self.next.min(aim);
        if span > 0.9 * left {
            span = left;
        } else if span > 0.5 * left {
            span = 0.5 * left;
        }
        let finest = FINEST * self.natural;
        let (mut attempt, mut relative);
        loop {
            (swing.stiffness, swing.damping) = (self.stiffness, self.damping);
            attempt = swing.attempt(law, state, span);
            relative = attempt.error / (LOCAL * self.tolerance);
            // A state that is not finite cannot be mended by a shorter step.
            if relative > 1.0 && span > finest {
                self.account.refused += 1;
                span = (span * (0.9 * relative.powf(-0.25)).clamp(0.1, 0.7)).max(finest);
                self.next = span;
                continue;
            }
            if let Some(earlier) = self.overshot(swing, &attempt, way, span)
                && earlier > finest
            {
                self.account.refused += 1;
                span = earlier;
                continue;
            }
            break;
        }
        self.account.steps += 1;
        if *stalled < MOST_EVENTS
            && let Some(at) = located(swing, law, state, &attempt, span)
        {
            *stalled = if at > 0.0 { 0 } else { *stalled + 1 };
            self.next = self.natural;
            self.rows.leave(true);
            return at;
        }
        *stalled = 0;
        self.rows.leave(false);
        self.learn(swing, law, &attempt, span);
        Stepper::<f64, L>::accept(swing, law, state, &attempt, false);
        let grown = span * (0.9 * relative.max(1e-12).powf(-0.25)).clamp(0.3, GROWTH);
        self.next = if span < 0.9 * self.next { self.next.max(grown) } else { grown };
        span
    }

    /// Takes the slopes of friction from a step.
    fn learn<L: FrictionLaw<f64>>(
        &mut self,
        swing: &Swing<'_>,
        law: &L,
        attempt: &Landing<L::Trial>,
        span: f64,
    ) {
        if L::STEEP {
            return;
        }
        let outcome = law.outcome(&attempt.trial);
        let Motion { displacement, velocity, start_velocity, .. } = attempt.motion;
        let dry = attempt.run.friction
            - swing.run.friction
            - outcome.damping * (velocity - start_velocity);
        self.damping = outcome.damping;
        let secant = dry / displacement;
        // Of a step that came back to where it began a secant tells nothing.
        let went = displacement.abs() > 0.1 * velocity.abs().max(start_velocity.abs()) * span;
        if went && secant.is_finite() {
            let greatest = law.greatest_stiffness();
            self.stiffness = secant.max(0.0).min(2.0 * greatest);
        }
    }

    /// When the motion turns round if friction goes on as it does, and which way it goes until then.
    fn turn<L: FrictionLaw<f64>>(
        &self,
        swing: &Swing<'_>,
        law: &L,
        state: &L::State,
    ) -> (f64, f64) {
        const FREE: (f64, f64) = (f64::INFINITY, 0.0);
        if L::STEEP {
            return FREE;
        }
        let inertia = swing.machine.inertia;
        let (square, decay) = (self.stiffness / inertia, 0.5 * self.damping / inertia);
        let velocity = swing.run.velocity;
        let surplus = square - decay * decay;
        let (net, over) = (swing.net(law, state), self.over);
        if square > 0.0 && self.rows.linear() {
            return FREE;
        }
        if square > 0.0 && self.swings(over * net / self.stiffness, over * velocity, square) {
            return FREE;
        }
        if surplus <= 0.0 {
            return (f64::INFINITY, sign(velocity));
        }
        let pace = (net + self.damping * velocity) / inertia;
        let omega = surplus.sqrt();
        let way = if velocity == 0.0 { sign(pace) } else { sign(velocity) };
        let until = (velocity.abs() * omega).atan2(way * (decay * velocity - pace)) / omega;
        let over = 0.5 * velocity * velocity / pace.abs();
        if velocity == 0.0 || (velocity * pace < 0.0 && over < PASSED * self.tolerance) {
            let again = until + std::f64::consts::PI / omega;
            let again = if velocity == 0.0 { std::f64::consts::PI / omega } else { again };
            return (SHORT_OF_A_TURN * again, sign(pace));
        }
        (SHORT_OF_A_TURN * until, way)
    }

    /// Whether a ring is so small that its turns are of no account.
    fn swings(&self, displaced: f64, velocity: f64, square: f64) -> bool {
        displaced * displaced + velocity * velocity / square
            < (SILENT * self.tolerance) * (SILENT * self.tolerance)
    }

    /// How far a step should have gone that ran past a turn of the motion.
    fn overshot<T>(
        &self,
        swing: &Swing<'_>,
        attempt: &Landing<T>,
        way: f64,
        span: f64,
    ) -> Option<f64> {
        let velocity = attempt.run.velocity;
        if way == 0.0 || velocity * way >= 0.0 {
            return None;
        }
        let pace = (self.net_after(swing, attempt)) / swing.machine.inertia;
        let over = 0.5 * velocity * velocity / pace.abs();
        if over <= PASSED * self.tolerance || pace * way >= 0.0 {
            return None;
        }
        let earlier = span - velocity.abs() / pace.abs();
        Some(earlier.max(0.3 * span).min(0.98 * span))
    }

    fn net_after<T>(&self, swing: &Swing<'_>, attempt: &Landing<T>) -> f64 {
        let at = attempt.run.situation();
        swing.around(&at).0 - attempt.run.friction
    }

    /// Holds a body at rest; for how long.
    fn hold<L: FrictionLaw<f64>>(
        &self,
        swing: &mut Swing<'_>,
        law: &L,
        state: &mut L::State,
        left: f64,
    ) -> Option<f64> {
        let mut held = left;
        if swing.machine.effects.changes_levels() {
            // A level may fall below the effort meanwhile.
            let at = swing.run.situation();
            let (effort, _) = swing.here();
            let holds = |span: f64| {
                let then = at.after(0.0, 0.0, span);
                let channels = swing.machine.channels(&then, effort, swing.load);
                law.holds(&mut state.clone(), &channels)
            };
            if !holds(0.0) {
                return None;
            }
            if !holds(left) {
                let (mut low, mut high) = (0.0, left);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if holds(middle) { low = middle } else { high = middle }
                }
                held = high;
            }
        }
        swing.count(1);
        Stepper::<f64, L>::hold(swing, law, state, held).then_some(held)
    }

    /// Passes a rest where the ring has died out.
    fn rest<L: FrictionLaw<f64>>(
        &mut self,
        swing: &mut Swing<'_>,
        law: &L,
        state: &mut L::State,
        left: f64,
    ) -> Resting {
        let silent = SILENT * self.tolerance;
        let (effort, channels) = swing.here();
        let stiffness = self.stiffness;
        if stiffness <= 0.0 || (effort - swing.run.friction).abs() > 2.0 * silent * stiffness {
            return Resting::NotYet;
        }
        swing.count(1);
        let Some(now) = law.rest(state, &channels, 0.0) else { return Resting::Never };
        let creeping = now.velocity;
        let friction = law.force(state, creeping, &channels);
        let missing = effort - friction;
        let faster = swing.run.velocity - creeping;
        if !self.swings(missing / stiffness, faster, stiffness / swing.machine.inertia) {
            return Resting::NotYet;
        }
        // A rest that goes on, after a row was written, has nothing left to die out.
        let square = stiffness / swing.machine.inertia;
        let over = 1.0 / BALANCED;
        if !self.swings(over * missing / stiffness, over * faster, square) {
            self.over = self.left_over(swing, law, state, silent);
            let over = self.over;
            if over > 1.0 && !self.swings(over * missing / stiffness, over * faster, square) {
                return Resting::NotYet;
            }
        }
        if missing.abs() > BALANCED * silent * stiffness
            && !self.balance(swing, law, state, creeping, missing)
        {
            return Resting::NotYet;
        }
        let (effort, channels) = swing.here();
        let at = swing.run.situation();
        let mut span = left;
        loop {
            swing.count(1);
            let Some(rest) = law.rest(state, &channels, span) else { return Resting::NotYet };
            let then = at.after(rest.displacement, rest.velocity, span);
            let (effort_then, channels_then) = swing.around(&then);
            let changed = (effort_then - effort).abs()
                + (channels_then.level / channels.level - 1.0).abs() * swing.run.friction.abs();
            if changed <= BALANCED * 10.0 * silent * stiffness {
                law.commit(state, &rest.trial);
                *swing.run = swing.after(&then, law.outcome(&rest.trial).force);
                return Resting::Passed(span);
            }
            span *= 0.25;
            if span < 4.0 * self.natural {
                return Resting::NotYet;
            }
        }
    }

    /// How many times its size a small ring would still move the body on: where friction rises more
    /// steeply one way than the other, and where loops do not close and so drift with every swing.
    fn left_over<L: FrictionLaw<f64>>(
        &self,
        swing: &Swing<'_>,
        law: &L,
        state: &L::State,
        silent: f64,
    ) -> f64 {
        let (_, channels) = swing.here();
        let mut swung = state.clone();
        swung.make_room(8);
        let way = if self.stiffness > 0.0 { sign(swing.run.friction) } else { 1.0 };
        let mut go = |displacement: f64| {
            let motion = Motion { displacement, ..Motion::held(0.0, 0.0) };
            swing.count(1);
            let trial = law.advance(&swung, &motion, &channels);
            law.commit(&mut swung, &trial);
            law.outcome(&trial).force
        };
        let before = go(0.0);
        let there = go(way * silent);
        go(-2.0 * way * silent);
        let again = go(2.0 * way * silent);
        let softest = ((there - before).abs() / silent).max(f64::MIN_POSITIVE);
        let drift = (again - there).abs() / self.stiffness;
        let omega = (self.stiffness / swing.machine.inertia).sqrt();
        let decay = 0.5 * self.damping / swing.machine.inertia;
        let swings = (omega / (2.0 * std::f64::consts::PI * decay)).min(MOST_SWINGS);
        (self.stiffness / softest).max(1.0) + drift / silent * swings
    }

    /// Moves a body that hardly swings any more to where friction balances the effort.
    fn balance<L: FrictionLaw<f64>>(
        &self,
        swing: &mut Swing<'_>,
        law: &L,
        state: &mut L::State,
        creeping: f64,
        missing: f64,
    ) -> bool {
        let silent = SILENT * self.tolerance;
        let (mut stiffness, mut displacement) = (self.stiffness, missing / self.stiffness);
        let start = swing.run.situation();
        for _ in 0..8 {
            if displacement.abs() > 4.0 * silent {
                return false;
            }
            let at = start.after(displacement, creeping, 0.0);
            let (effort, channels) = swing.around(&at);
            let motion = Motion {
                displacement,
                duration: 0.0,
                start_velocity: creeping,
                velocity: creeping,
            };
            swing.count(1);
            let trial = law.advance(state, &motion, &channels);
            let force = law.outcome(&trial).force;
            let still = effort - force;
            if still.abs() <= BALANCED * silent * self.stiffness {
                law.commit(state, &trial);
                *swing.run = swing.after(&at, force);
                return true;
            }
            let secant = (missing - still) / displacement;
            if secant > 0.0 {
                stiffness = secant;
            }
            displacement += still / stiffness;
        }
        false
    }
}

/// What became of a rest.
enum Resting {
    /// It was passed, for so long.
    Passed(f64),
    /// The ring is still alive, or the law about to slide.
    NotYet,
    /// This law cannot tell.
    Never,
}

/// What is left of a span, round-off apart.
fn lesser(left: f64, passed: f64, span: f64) -> f64 {
    let left = left - passed;
    if left <= f64::EPSILON * span { 0.0 } else { left }
}
