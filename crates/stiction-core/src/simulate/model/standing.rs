//! What steps change of a friction model: the state of its law, and where effects have come to.

use std::borrow::Cow;

use super::{EVENT_ROOM, qualified};
use crate::friction::{AnyState, AnyTrial, Channels, Entry, FrictionLaw, Law, LawState, Outcome};
use crate::integrate::{Held, through_events};
use crate::math::scalar::Scalar;
use crate::plant::effects::EffectSpec;
use crate::plant::{ContactEffects, Reach};

/// The state of a law, and of effects where there are any.
#[derive(Debug, Clone)]
pub(crate) struct Contact<S: Scalar> {
    /// Of the law.
    pub state: AnyState<S>,
    /// Of the effects.
    pub effects: Option<Box<ContactEffects<S>>>,
}

impl<S: Scalar> Contact<S> {
    /// One that was never moved; `number` makes numbers of this type of the values of effects.
    pub fn new(law: &Law<S>, effects: &[EffectSpec], mut number: impl FnMut(f64) -> S) -> Self {
        let built = effects.iter().map(|effect| {
            let values: Vec<S> = effect.values.iter().map(|value| number(*value)).collect();
            effect.built(&values)
        });
        let any = !effects.is_empty();
        let effects = any.then(|| Box::new(ContactEffects::new(built, law.sliding_force())));
        Self { state: law.initial(), effects }
    }

    /// Goes on through a sample at a held velocity; the friction at its end, with what effects add.
    pub fn advance(&mut self, law: &Law<S>, velocity: S, span: S, channels: &Channels<S>) -> S {
        let Self { state, effects } = self;
        let reach = match effects {
            Some(effects) => effects.advance(velocity, span, channels),
            None => Reach { channels: *channels, added: S::constant(0.0), creep: S::constant(0.0) },
        };
        let creeps = effects.as_ref().is_some_and(|effects| effects.relaxes());
        let force = with_law_and_state!(law, state, |law, state| {
            state.make_room(EVENT_ROOM);
            if creeps {
                reach.through::<_, true>(law, state, velocity, span)
            } else {
                reach.through::<_, false>(law, state, velocity, span)
            }
        });
        if let Some(effects) = effects {
            effects.note(force);
        }
        force - reach.added
    }
}

impl Contact<f64> {
    /// The state as named entries.
    pub fn entries(&self) -> Vec<(Cow<'static, str>, Entry)> {
        let law = with_state!(&self.state, |state| state.entries());
        let Some(effects) = &self.effects else {
            return law.into_iter().map(|(name, entry)| (Cow::Borrowed(name), entry)).collect();
        };
        let own = effects.entries().map(|(name, entry)| (Cow::Borrowed(name), entry));
        own.chain(law.into_iter().map(|(name, entry)| (qualified(name), entry))).collect()
    }
}

impl<S: Scalar> Reach<S> {
    /// Takes a law through the sample, with every mode change in it.
    fn through<L: FrictionLaw<S>, const CREEPS: bool>(
        &self,
        law: &L,
        state: &mut L::State,
        velocity: S,
        span: S,
    ) -> S {
        let mut held = Held::<S, CREEPS>::giving(velocity, self.creep, self.channels);
        through_events(&mut held, law, state, span);
        held.outcome.force
    }

    /// The sample of a law where no contact mode changes in it.
    pub(super) fn quiet_step(
        &self,
        law: &Law<S>,
        state: &AnyState<S>,
        velocity: S,
        span: S,
        creeps: bool,
    ) -> Option<(AnyTrial<S>, Outcome<S>)> {
        if creeps {
            let held = Held::<S, true>::giving(velocity, self.creep, self.channels);
            law.quiet_step(state, &held, span)
        } else {
            law.quiet_step(state, &Held::<S>::new(velocity, self.channels), span)
        }
    }
}
