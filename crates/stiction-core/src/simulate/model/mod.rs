//! A friction law with its parameters and state: what `FrictionModel` is in Python.

mod slope;
mod standing;

use std::borrow::Cow;

use crate::friction::{AnyState, AnyTrial, Channels, Entry, Law, LawState, Statistics};
use crate::integrate::{Held, through_events};
use crate::plant::effects::{EffectSpec, Effects};
use crate::plant::naming::{blamed, parted, qualified};
use crate::plant::{ContactEffects, Run};
use crate::simulate::range::{Range, ordinary, sound};
use crate::support::error::{Error, Result};
use crate::support::finite;
use crate::support::interrupt;

pub use crate::friction::LawSpec;
pub use slope::Derivatives;
use standing::Contact;

/// Samples between two checks that the next reversals find room.
pub const CHUNK: usize = 128;
/// Commits that events may add to a chunk.
const EVENT_ROOM: usize = 32;

/// A friction law, its parameters and its state, with the effects that act at the contact.
#[derive(Debug, Clone)]
pub struct FrictionModel {
    spec: LawSpec,
    effects: Vec<EffectSpec>,
    law: Law<f64>,
    contact: Contact<f64>,
    /// What the last `trial` would lead to.
    proposed: Option<Proposed>,
    /// Within what a step needs no watch.
    range: Range,
}

/// A step not yet accepted.
#[derive(Debug, Clone)]
enum Proposed {
    /// Within one contact mode: what would change of the law, and what effects would be.
    Step(AnyTrial<f64>, Option<Box<ContactEffects<f64>>>),
    /// Through a change of mode: the contact after it.
    Contact(Box<Contact<f64>>),
}

impl FrictionModel {
    /// A contact that was never moved.
    pub fn new(spec: LawSpec) -> Self {
        Self::made(spec, Vec::new())
    }

    /// The same with effects; those that no contact alone can have are refused, and one stated twice.
    pub fn with_effects(spec: LawSpec, effects: Vec<EffectSpec>) -> Result<Self> {
        for EffectSpec { record, .. } in &effects {
            if let Some(hook) = record.hooks.iter().find(|hook| !hook.at_contact()) {
                return Err(Error::NotAtContact { effect: record.name, place: hook.word() });
            }
        }
        EffectSpec::refuse_twice(&effects)?;
        Ok(Self::made(spec, effects))
    }

    fn made(spec: LawSpec, effects: Vec<EffectSpec>) -> Self {
        let law = spec.plain();
        let contact = Contact::new(&law, &effects, |value| value);
        let own = ordinary(spec.record.parameters, spec.values.iter().copied());
        let others =
            effects.iter().all(|e| ordinary(e.record.parameters, e.values.iter().copied()));
        let range = Range::new(own && others, 0.0);
        Self { spec, effects, law, contact, proposed: None, range }
    }

    /// Law, parameters and options.
    pub fn spec(&self) -> &LawSpec {
        &self.spec
    }

    /// Effects at the contact.
    pub fn effects(&self) -> &[EffectSpec] {
        &self.effects
    }

    /// Names and values of all parameters: those of the law, then `effects.cogging.cosine` and so on.
    pub fn parameters(&self) -> Vec<(Cow<'static, str>, f64)> {
        let law = self.spec.record.parameters.iter().zip(&self.spec.values);
        let own = law.map(|(spec, value)| (Cow::Borrowed(spec.name), *value));
        own.chain(self.effects.iter().flat_map(|effect| {
            let name = effect.record.name;
            let values = effect.record.parameters.iter().zip(&effect.values);
            values.map(move |(spec, v)| (Cow::Owned(format!("effects.{name}.{}", spec.name)), *v))
        }))
        .collect()
    }

    /// The law itself.
    pub fn law(&self) -> &Law<f64> {
        &self.law
    }

    /// The present state of the law.
    pub fn state(&self) -> &AnyState<f64> {
        &self.contact.state
    }

    /// Where the contact is and what effects remember, where there are any.
    pub fn surroundings(&self) -> Option<&ContactEffects<f64>> {
        self.contact.effects.as_deref()
    }

    /// A contact like this one that was never moved.
    pub fn anew(&self) -> Self {
        Self::made(self.spec.clone(), self.effects.clone())
    }

    /// Goes on from the state of a law, from where a body is and from what those of its effects remember
    /// that stand at these places there.
    pub(crate) fn take(
        &mut self,
        state: AnyState<f64>,
        run: &Run<f64>,
        effects: &Effects<f64>,
        places: &[usize],
    ) {
        self.proposed = None;
        self.contact.state = state;
        if let Some(own) = &mut self.contact.effects {
            own.take(run, effects, places);
        }
        self.range.forget();
        self.range.meet(self.entries().iter().map(|(_, entry)| entry));
    }

    /// One sample at a held velocity; the friction at its end. Where that is no number, the contact
    /// stays as it is.
    #[inline]
    pub fn step(&mut self, velocity: f64, dt: f64, channels: &Channels<f64>) -> Result<f64> {
        if !self.needs_no_watch(velocity, dt, channels) {
            return self.step_watched(velocity, dt, channels);
        }
        self.proposed = None;
        let force = self.go(velocity, dt, channels);
        if force.is_finite() { Ok(force) } else { Err(self.out_of_range()) }
    }

    #[inline(always)]
    fn go(&mut self, velocity: f64, dt: f64, channels: &Channels<f64>) -> f64 {
        if self.contact.effects.is_some() {
            return self.contact.advance(&self.law, velocity, dt, channels);
        }
        with_law_and_state!(&self.law, &mut self.contact.state, |law, state| {
            state.make_room(EVENT_ROOM);
            let mut held = Held::new(velocity, *channels);
            through_events(&mut held, law, state, dt);
            held.outcome.force
        })
    }

    #[cold]
    #[inline(never)]
    fn step_watched(&mut self, velocity: f64, dt: f64, channels: &Channels<f64>) -> Result<f64> {
        let before = self.contact.clone();
        let force = self.go(velocity, dt, channels);
        self.keep_or_return(before, force.is_finite())?;
        Ok(force)
    }

    /// Whether a sample cannot lead to anything but numbers.
    #[inline]
    fn needs_no_watch(&self, velocity: f64, dt: f64, channels: &Channels<f64>) -> bool {
        let warmth = channels.temperature.map_or(0.0, f64::abs);
        let efforts = channels.effort.abs() + channels.load.abs();
        let place = self.contact.effects.as_ref().map_or(0.0, |effects| effects.size());
        self.range.covers(velocity.abs() + warmth + efforts + place, dt)
    }

    /// Keeps the present contact where it is one, and goes back to the one before where it is none.
    fn keep_or_return(&mut self, before: Contact<f64>, finite: bool) -> Result<()> {
        // What effects remember is of no size that shows elsewhere.
        let alone = self.contact.effects.is_none();
        let calm = alone && self.range.holds(0.0);
        if finite && (calm || sound(&before.entries(), &self.contact.entries())) {
            self.proposed = None;
            return Ok(());
        }
        self.contact = before;
        Err(self.out_of_range())
    }

    #[cold]
    fn out_of_range(&self) -> Error {
        Error::OutOfRange { law: self.spec.record.name }
    }

    /// Samples at held velocities; the friction at the end of each. Where one of them is no number, the
    /// contact stays as it is.
    ///
    /// `channels` yields what else reaches the contact at a sample.
    pub fn simulate(
        &mut self,
        velocity: &[f64],
        dt: f64,
        channels: impl Fn(usize) -> Channels<f64>,
        friction: &mut [f64],
    ) -> Result<()> {
        let before = self.contact.clone();
        if self.contact.effects.is_some() {
            for (k, (v, f)) in velocity.iter().zip(&mut *friction).enumerate() {
                if k % CHUNK == 0 && interrupt::due() {
                    self.contact = before;
                    return Err(Error::Interrupted);
                }
                *f = self.contact.advance(&self.law, *v, dt, &channels(k));
            }
            return self.keep_or_return(before, finite::check("friction", friction).is_ok());
        }
        with_law_and_state!(&self.law, &mut self.contact.state, |law, state| {
            let chunks = velocity.chunks(CHUNK).zip(friction.chunks_mut(CHUNK));
            for (chunk, (velocity, friction)) in chunks.enumerate() {
                if interrupt::due() {
                    self.contact = before;
                    return Err(Error::Interrupted);
                }
                state.make_room(CHUNK + EVENT_ROOM);
                for (k, (v, f)) in velocity.iter().zip(friction).enumerate() {
                    let mut held = Held::new(*v, channels(chunk * CHUNK + k));
                    through_events(&mut held, law, state, dt);
                    *f = held.outcome.force;
                }
            }
        });
        self.keep_or_return(before, finite::check("friction", friction).is_ok())
    }

    /// Friction and ∂friction/∂velocity of a sample, leaving the contact as it is.
    pub fn trial(
        &mut self,
        velocity: f64,
        dt: f64,
        channels: &Channels<f64>,
    ) -> Result<(f64, f64)> {
        self.proposed = None;
        let quiet = if self.contact.effects.is_some() {
            self.quiet_with_effects(velocity, dt, channels)
        } else {
            let held = Held::<f64>::new(velocity, *channels);
            let quiet = self.law.quiet_step(&self.contact.state, &held, dt);
            quiet.map(|(trial, found)| (Proposed::Step(trial, None), found.force, found.slope))
        };
        let (proposed, force, slope) = quiet.unwrap_or_else(|| {
            let mut next = self.contact.clone();
            let force = next.advance(&self.law, velocity, dt, channels);
            let slope = self.slope_through_events(velocity, dt, channels);
            (Proposed::Contact(Box::new(next)), force, slope)
        });
        if !(force.is_finite() && slope.is_finite()) {
            return Err(self.out_of_range());
        }
        if !self.needs_no_watch(velocity, dt, channels) {
            self.commits(&proposed)?;
        }
        self.proposed = Some(proposed);
        Ok((force, slope))
    }

    /// A step with effects, its friction and its slope, where no contact mode changes in it.
    fn quiet_with_effects(
        &self,
        velocity: f64,
        dt: f64,
        channels: &Channels<f64>,
    ) -> Option<(Proposed, f64, f64)> {
        let mut effects = self.contact.effects.clone()?;
        let reach = effects.advance(velocity, dt, channels);
        let (trial, found) =
            reach.quiet_step(&self.law, &self.contact.state, velocity, dt, effects.relaxes())?;
        effects.note(found.force);
        let slope = if effects.relaxes() {
            // What the law says is of a displacement that goes with the velocity.
            self.slope_through_events(velocity, dt, channels)
        } else {
            found.slope + self.slope_by_effects(velocity, dt, channels)
        };
        Some((Proposed::Step(trial, Some(effects)), found.force - reach.added, slope))
    }

    /// Refuses a step that leads to a state which is none.
    #[cold]
    fn commits(&self, proposed: &Proposed) -> Result<()> {
        let mut after = self.clone();
        after.accept(proposed.clone());
        after.keep_or_return(self.contact.clone(), true)
    }

    fn accept(&mut self, proposed: Proposed) {
        match proposed {
            Proposed::Step(trial, effects) => {
                self.law.commit(&mut self.contact.state, &trial);
                self.contact.effects = effects;
            }
            Proposed::Contact(next) => self.contact = *next,
        }
    }

    /// Accepts the last trial; false when there was none since the state last changed.
    pub fn commit(&mut self) -> bool {
        let proposed = self.proposed.take();
        let any = proposed.is_some();
        if let Some(proposed) = proposed {
            self.accept(proposed);
        }
        any
    }

    /// Back to a contact that was never moved.
    pub fn reset(&mut self) {
        self.reset_at(0.0, 0.0, 0.0);
    }

    /// The same at this position, with this time on the session clock and this path behind it: what
    /// effects go by.
    pub fn reset_at(&mut self, position: f64, time: f64, path: f64) {
        self.proposed = None;
        self.contact.state = self.law.initial();
        self.range.forget();
        if let Some(effects) = &mut self.contact.effects {
            effects.reset([position, time, path]);
            self.range.meet(&[position, time, path].map(Entry::Number));
        }
    }

    /// The state as named entries: of a contact with effects where it is and what they remember, called
    /// as a motor calls it, before those of the law.
    pub fn entries(&self) -> Vec<(Cow<'static, str>, Entry)> {
        self.contact.entries()
    }

    /// Sets the state from named entries; where one of them is wrong, nothing changes.
    pub fn restore(&mut self, entries: &[(String, Entry)]) -> Result<()> {
        self.contact = match &self.contact.effects {
            None => Contact { state: self.law.restore(entries)?, effects: None },
            Some(effects) => {
                let [own, law] = parted(entries);
                let effects = Some(Box::new(effects.restored(&own)?));
                Contact { state: self.law.restore(&law).map_err(blamed)?, effects }
            }
        };
        self.proposed = None;
        self.range.forget();
        self.range.meet(entries.iter().map(|(_, entry)| entry));
        Ok(())
    }

    /// Branch counters.
    pub fn statistics(&self) -> Statistics {
        with_state!(&self.contact.state, |state| state.statistics())
    }

    /// Greatest ∂force/∂position of the law.
    pub fn greatest_stiffness(&self) -> f64 {
        use crate::friction::FrictionLaw;
        with_law!(&self.law, |law| law.greatest_stiffness())
    }
}
