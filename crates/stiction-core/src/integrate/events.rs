//! The loop that every step goes through, and the location of events inside it.

use super::contact::Held;
use crate::friction::{Event, FrictionLaw, Motion};
use crate::scalar::Scalar;

/// Mode changes allowed within one step before the rest is taken in the present mode: a guard
/// against chatter at a degenerate set of parameters, never reached by a sane one.
const MOST_EVENTS: u32 = 16;

/// A way to attempt a step and to accept it.
pub trait Stepper<S: Scalar, L: FrictionLaw<S>> {
    /// An attempted step.
    type Attempt: Copy;

    /// Attempts a step of this duration in the present contact mode.
    fn attempt(&self, law: &L, state: &L::State, span: S) -> Self::Attempt;
    /// What the law makes of it, and the motion at the contact.
    fn contact<'a>(&self, attempt: &'a Self::Attempt) -> (&'a L::Trial, &'a Motion<S>);
    /// Accepts it; `stopped` when it ended where the velocity reached zero.
    fn accept(&mut self, law: &L, state: &mut L::State, attempt: &Self::Attempt, stopped: bool);
    /// Present velocity.
    fn velocity(&self) -> S;
    /// Holds a body at rest for this duration if the contact can.
    fn hold(&mut self, law: &L, state: &mut L::State, span: S) -> bool;
}

/// Takes one step, locating and passing every mode change inside it.
#[inline(always)]
pub fn through_events<S: Scalar, L: FrictionLaw<S>, P: Stepper<S, L>>(
    stepper: &mut P,
    law: &L,
    state: &mut L::State,
    span: S,
) {
    let velocity = stepper.velocity();
    if velocity.re() == 0.0 && stepper.hold(law, state, span) {
        return;
    }
    if law.pending(state, velocity).is_none() {
        let attempt = stepper.attempt(law, state, span);
        let (trial, motion) = stepper.contact(&attempt);
        if law.event(state, trial, motion).is_none() {
            stepper.accept(law, state, &attempt, false);
            return;
        }
    }
    pass_events(stepper, law, state, span);
}

/// The same for a step in which an event is due; whether the contact holds was asked already.
#[cold]
#[inline(never)]
pub(super) fn pass_events<S: Scalar, L: FrictionLaw<S>, P: Stepper<S, L>>(
    stepper: &mut P,
    law: &L,
    state: &mut L::State,
    span: S,
) {
    let mut left = span;
    let mut passed = 0;
    let mut asked = true;
    loop {
        if !asked && stepper.velocity().re() == 0.0 && stepper.hold(law, state, left) {
            return;
        }
        asked = false;
        if passed < MOST_EVENTS
            && let Some(event) = law.pending(state, stepper.velocity())
        {
            law.switch(state, event);
            passed += 1;
            continue;
        }
        let attempt = apart(stepper, law, state, left);
        let (trial, motion) = stepper.contact(&attempt);
        let event = if passed < MOST_EVENTS { law.event(state, trial, motion) } else { None };
        let Some(event) = event else {
            stepper.accept(law, state, &attempt, false);
            return;
        };
        passed += 1;
        let (event, at) = earliest(stepper, law, state, event, left);
        // Also where the event is due at once: a velocity that jumped has changed the force.
        let shortened = apart(stepper, law, state, at);
        stepper.accept(law, state, &shortened, event == Event::Reversal && at.re() > 0.0);
        left -= at;
        // What is left below round-off of the step still asks for the force after the event.
        if left.re() <= f64::EPSILON * span.re() {
            left = S::constant(0.0);
        }
        law.switch(state, event);
    }
}

/// An attempt where one more call is no matter: the usual one alone is part of its loop.
#[cold]
#[inline(never)]
fn apart<S: Scalar, L: FrictionLaw<S>, P: Stepper<S, L>>(
    stepper: &P,
    law: &L,
    state: &L::State,
    span: S,
) -> P::Attempt {
    stepper.attempt(law, state, span)
}

/// The step as a whole where no mode changes in it, evaluated and not accepted.
pub fn quiet<S: Scalar, L: FrictionLaw<S>>(
    held: &Held<S>,
    law: &L,
    state: &L::State,
    span: S,
) -> Option<L::Trial> {
    if law.pending(state, held.velocity).is_some() {
        return None;
    }
    let (trial, motion) = Stepper::<S, L>::attempt(held, law, state, span);
    law.event(state, &trial, &motion).is_none().then_some(trial)
}

/// The first event within `span`, and when.
#[cold]
pub(super) fn earliest<S: Scalar, L: FrictionLaw<S>, P: Stepper<S, L>>(
    stepper: &P,
    law: &L,
    state: &L::State,
    found: Event,
    span: S,
) -> (Event, S) {
    let (mut event, mut span) = (found, span);
    // Each pass ends earlier than the one before; three kinds of event bound their number.
    for _ in 0..4 {
        let at = locate(span, |h| {
            let attempt = apart(stepper, law, state, h);
            let (trial, motion) = stepper.contact(&attempt);
            law.margin(state, trial, motion, event)
        });
        if at.re() <= 0.0 {
            return (event, at);
        }
        let attempt = apart(stepper, law, state, at);
        let (trial, motion) = stepper.contact(&attempt);
        match law.event(state, trial, motion) {
            Some(other) if other != event => {
                (event, span) = (other, at);
            }
            _ => return (event, at),
        }
    }
    (event, span)
}

/// The zero of a margin that is positive at 0 and not at `span`.
///
/// Found on real parts by the Illinois rule with bisection as a guard; two Newton steps in the full
/// number type then carry the derivatives of the time of the event (implicit function theorem).
fn locate<S: Scalar>(span: S, mut margin: impl FnMut(S) -> S) -> S {
    let (mut low, mut high) = (0.0, span.re());
    let mut at_low = margin(S::constant(0.0)).re();
    if at_low <= 0.0 || high <= 0.0 {
        return S::constant(0.0);
    }
    let mut at_high = margin(span).re();
    if at_high >= 0.0 {
        return span;
    }
    let tolerance = 1e-15 * high;
    let mut side = 0;
    for _ in 0..100 {
        if high - low <= tolerance {
            break;
        }
        let secant = (low * at_high - high * at_low) / (at_high - at_low);
        let middle = if secant > low && secant < high { secant } else { 0.5 * (low + high) };
        let there = margin(S::constant(middle)).re();
        if there == 0.0 {
            (low, high) = (middle, middle);
        } else if there > 0.0 {
            (low, at_low) = (middle, there);
            if side == -1 {
                at_high *= 0.5;
            }
            side = -1;
        } else {
            (high, at_high) = (middle, there);
            if side == 1 {
                at_low *= 0.5;
            }
            side = 1;
        }
    }
    let root = 0.5 * (low + high);
    // Wide enough to stand above round-off; two Newton steps square the error of this slope.
    let width = (1e-5 * span.re()).min(root.max(1e-9 * span.re()));
    let slope = (margin(S::constant(root + width)).re() - margin(S::constant(root - width)).re())
        / (2.0 * width);
    let mut at = S::constant(root);
    if slope < 0.0 {
        for _ in 0..2 {
            at = at - margin(at) / slope;
        }
    }
    // The corrections move the value by round-off only; an event is never outside its step.
    let inside = at.re().clamp(0.0, span.re());
    at.chain(inside, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    #[test]
    fn an_event_is_located_with_the_derivative_of_its_time() {
        // margin(t) = a − t³ is zero at a^(1/3).
        let a = Dual::variable(0.3, 2);
        let at = locate(Dual::constant(1.0), |t| a - t * t * t);
        assert!((at.re() - 0.3_f64.cbrt()).abs() < 1e-15);
        let exact = 1.0 / (3.0 * 0.3_f64.cbrt().powi(2));
        assert!((at.partial(2) - exact).abs() < 1e-9 * exact);
    }

    #[test]
    fn an_event_at_the_start_or_the_end_stays_inside_the_step() {
        assert_eq!(locate(1.0, |t: f64| -1e-20 - t), 0.0);
        assert_eq!(locate(1.0, |t: f64| 1.0 - t), 1.0);
    }
}
