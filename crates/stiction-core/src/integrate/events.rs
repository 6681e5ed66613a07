//! The loop that every step goes through, and the location of events inside it.

use super::contact::Held;
use crate::friction::{AnyState, AnyTrial, Catalogued, Event, FrictionLaw, Law, Motion, Outcome};
use crate::math::scalar::Scalar;
use crate::support::work;

/// Mode changes allowed within one step before the rest is taken in the present mode: a guard
/// against chatter at a degenerate set of parameters, never reached by a sane one.
const MOST_EVENTS: u32 = 16;

/// A way to attempt a step and to accept it.
pub trait Stepper<S: Scalar, L: FrictionLaw<S>> {
    /// An attempted step.
    type Attempt: Copy;
    /// What one costs, see [`crate::support::work`].
    const COST: u64 = work::STEP;

    /// Attempts a step of this duration in the present contact mode.
    fn attempt(&self, law: &L, state: &L::State, span: S) -> Self::Attempt;
    /// In how many pieces what is left of a step is to be gone through in the present mode, a whole number.
    #[inline(always)]
    fn pieces(&self, _law: &L, _state: &L::State, _span: S) -> f64 {
        1.0
    }
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

/// [`through_events`] where a mode is likely to change, so that nothing is attempted before that is looked for.
#[inline]
pub(super) fn through_likely_events<S: Scalar, L: FrictionLaw<S>, P: Stepper<S, L>>(
    stepper: &mut P,
    law: &L,
    state: &mut L::State,
    span: S,
) {
    if stepper.velocity().re() != 0.0 || !stepper.hold(law, state, span) {
        pass_events(stepper, law, state, span);
    }
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
        let pieces = stepper.pieces(law, state, left);
        let next = if pieces > 1.0 { left / pieces } else { left };
        let attempt = apart(stepper, law, state, next);
        let (trial, motion) = stepper.contact(&attempt);
        let event = if passed < MOST_EVENTS { law.event(state, trial, motion) } else { None };
        let Some(event) = event else {
            stepper.accept(law, state, &attempt, false);
            if pieces > 1.0 {
                left -= next;
                continue;
            }
            return;
        };
        passed += 1;
        // Also where the event is due at once: a velocity that jumped has changed the force.
        let (event, at, shortened) = earliest(stepper, law, state, event, (next, attempt));
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
    work::spend(P::COST);
    stepper.attempt(law, state, span)
}

/// The step as a whole where no mode changes in it, evaluated and not accepted.
pub fn quiet<S: Scalar, L: FrictionLaw<S>, const CREEPS: bool>(
    held: &Held<S, CREEPS>,
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

impl<S: Scalar> Law<S> {
    /// A step at a held velocity, where no contact mode changes in it.
    pub fn quiet_step<const CREEPS: bool>(
        &self,
        state: &AnyState<S>,
        held: &Held<S, CREEPS>,
        span: S,
    ) -> Option<(AnyTrial<S>, Outcome<S>)> {
        with_law_and_state!(self, state, |law, state| quiet(held, law, state, span)
            .map(|trial| (any(law, trial), law.outcome(&trial))))
    }
}

/// A step of a law, as one of any.
fn any<S: Scalar, L: Catalogued<S>>(_: &L, trial: L::Trial) -> AnyTrial<S> {
    L::any(trial)
}

/// The first event within an attempt of this duration, when, and the attempt up to there.
#[cold]
pub(super) fn earliest<S: Scalar, L: FrictionLaw<S>, P: Stepper<S, L>>(
    stepper: &P,
    law: &L,
    state: &L::State,
    found: Event,
    (span, attempt): (S, P::Attempt),
) -> (Event, S, P::Attempt) {
    let (mut event, mut span, mut attempt) = (found, span, attempt);
    // Each pass ends earlier than the one before; three kinds of event bound their number.
    for _ in 0..4 {
        let left = |attempt: &P::Attempt| {
            let (trial, motion) = stepper.contact(attempt);
            law.margin(state, trial, motion, event)
        };
        let beyond = left(&attempt).re();
        let at = locate(span, beyond, &mut |h| left(&apart(stepper, law, state, h)));
        attempt = apart(stepper, law, state, at);
        if at.re() <= 0.0 {
            return (event, at, attempt);
        }
        let (trial, motion) = stepper.contact(&attempt);
        match law.event(state, trial, motion) {
            Some(other) if other != event => {
                (event, span) = (other, at);
            }
            _ => return (event, at, attempt),
        }
    }
    (event, span, attempt)
}

/// Of a step, how closely an event in it is enclosed: a margin is a difference of forces, or of
/// velocities, of which a step changes a small part, so that round-off hides what is closer.
const ENCLOSED: f64 = 1e-13;

/// The zero of a margin that is positive at 0 and, `beyond`, not at `span`.
///
/// Found on real parts by the secant of the last two attempts, bisection as a guard; two Newton steps
/// in the full number type then carry the derivatives of the time of the event (implicit function
/// theorem), where there are any. One search for all laws and steps: what it asks costs more than a call.
fn locate<S: Scalar>(span: S, beyond: f64, margin: &mut dyn FnMut(S) -> S) -> S {
    let (mut low, mut high) = (0.0, span.re());
    let mut at_low = margin(S::constant(0.0)).re();
    if at_low <= 0.0 || high <= 0.0 {
        return S::constant(0.0);
    }
    if beyond >= 0.0 {
        return span;
    }
    let mut at_high = beyond;
    let tolerance = ENCLOSED * high;
    let (mut before, mut at_before, mut last, mut at_last) = (low, at_low, high, at_high);
    // The last two moves, and how far a move that has come to its end goes past the zero.
    let (mut moves, mut past) = ([2.0 * high; 2], tolerance);
    for _ in 0..100 {
        if high - low <= tolerance {
            break;
        }
        let secant = last - at_last * (last - before) / (at_last - at_before);
        let sound = secant > low && secant < high && (secant - last).abs() <= 0.5 * moves[0];
        let middle = 0.5 * (low + high);
        let mut next = if sound { secant } else { middle };
        if (next - last).abs() < tolerance {
            next = if last == low { (low + past).min(middle) } else { (high - past).max(middle) };
            past *= 4.0;
        }
        let there = margin(S::constant(next)).re();
        moves = [moves[1], (next - last).abs()];
        (before, at_before, last, at_last) = (last, at_last, next, there);
        if there == 0.0 {
            (low, high) = (next, next);
        } else if there > 0.0 {
            (low, at_low) = (next, there);
        } else {
            (high, at_high) = (next, there);
        }
    }
    // Of so short a piece, its secant.
    let within = if high > low { at_low / (at_low - at_high) } else { 0.0 };
    // Margins that are no numbers any more tell of no place: then of its end.
    let root = if within.is_nan() { high } else { (low + (high - low) * within).clamp(low, high) };
    if !S::CARRIES {
        return S::constant(root);
    }
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
    // The corrections move the value by round-off only.
    at.with_value(root)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar::Dual;

    #[test]
    fn an_event_is_located_with_the_derivative_of_its_time() {
        // margin(t) = a − t³ is zero at a^(1/3).
        let a = Dual::variable(0.3, 2);
        let at = locate(Dual::constant(1.0), 0.3 - 1.0, &mut |t| a - t * t * t);
        assert!((at.re() - 0.3_f64.cbrt()).abs() < 1e-15);
        let exact = 1.0 / (3.0 * 0.3_f64.cbrt().powi(2));
        assert!((at.partial(2) - exact).abs() < 1e-9 * exact);
    }

    #[test]
    fn an_event_at_the_start_or_the_end_stays_inside_the_step() {
        assert_eq!(locate(1.0, -1.0, &mut |t: f64| -1e-20 - t), 0.0);
        assert_eq!(locate(1.0, 0.0, &mut |t: f64| 1.0 - t), 1.0);
    }

    #[test]
    fn an_event_takes_few_attempts_and_a_jump_does_not_mislead() {
        let mut attempts = 0;
        let at = locate(1e-4, (-0.3_f64).exp() - 0.9, &mut |t: f64| {
            attempts += 1;
            (-3e3 * t).exp() - 0.9
        });
        assert!((at - 0.9_f64.ln() / -3e3).abs() < 1e-18, "{at}");
        assert!(attempts <= 8, "{attempts}");
        for jump in [1e-9, 0.3, 0.999_999] {
            for after in [-1.0, -1e-12] {
                let mut margin = |t: f64| if t < jump { 1.0 } else { after * (0.5 + t) };
                let at = locate(1.0, margin(1.0), &mut margin);
                assert!((at - jump).abs() < 1e-12, "{at} {jump}");
            }
        }
    }

    #[test]
    fn a_margin_that_round_off_hides_ends_the_search() {
        let mut attempts = 0;
        let coarse = |t: f64| ((0.3 - t) * 1e-3 + 1e3) - 1e3;
        let at = locate(1.0, coarse(1.0), &mut |t: f64| {
            attempts += 1;
            coarse(t)
        });
        assert!((at - 0.3).abs() < 2e-10, "{at}");
        assert!(attempts <= 40, "{attempts}");
    }
}
