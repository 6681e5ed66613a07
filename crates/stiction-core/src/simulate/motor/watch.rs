//! Motions that run away: a motor never goes on from what is no number.

use super::Running;
use crate::friction::{AnyState, Entry, LawState};
use crate::plant::Run;
use crate::plant::drive::Way;
use crate::plant::effects::Effects;
use crate::simulate::range::sound;
use crate::support::error::{Error, Result};
use crate::support::work::Meter;

/// Where a motor stood, to go back to.
#[derive(Debug, Clone)]
pub struct Standing {
    run: Run<f64>,
    state: AnyState<f64>,
    way: Option<Way<f64>>,
    /// Where they remember anything.
    effects: Option<Effects<f64>>,
}

impl Running<f64> {
    /// Where it stands.
    pub fn standing(&self) -> Standing {
        let effects = &self.machine.effects;
        Standing {
            run: self.run,
            state: self.state.clone(),
            way: self.way.clone(),
            effects: effects.remembers().then(|| effects.clone()),
        }
    }

    /// Back to where it stood.
    pub fn return_to(&mut self, before: Standing) {
        (self.run, self.state, self.way) = (before.run, before.state, before.way);
        if let Some(effects) = before.effects {
            self.machine.effects = effects;
        }
    }

    /// One sample; where it leads to no number, the motor stays where it is.
    #[inline]
    pub fn step_or_stay(&mut self, input: f64, load: f64, dt: f64) -> Result<()> {
        if !self.needs_no_watch(input, load, dt) {
            return self.step_watched(input, load, dt);
        }
        self.step_within(input, load, dt, &mut Meter::unbounded())?;
        let run = &self.run;
        if (run.position + run.velocity + run.friction).is_finite() {
            return Ok(());
        }
        Err(self.ran_away(dt))
    }

    /// Whether a sample cannot lead to anything but numbers.
    #[inline]
    pub(crate) fn needs_no_watch(&self, input: f64, load: f64, dt: f64) -> bool {
        let moves = self.run.position.abs() + self.run.velocity.abs();
        let known = |each: Option<f64>| each.map_or(0.0, f64::abs);
        let around = known(self.run.temperature) + known(self.run.transmitted);
        self.range.covers(moves + around + input.abs() + load.abs(), dt)
    }

    /// The same as [`Self::step_or_stay`], whatever there is.
    #[cold]
    #[inline(never)]
    pub(crate) fn step_watched(&mut self, input: f64, load: f64, dt: f64) -> Result<()> {
        self.step_watched_within(input, load, dt, &mut Meter::of_a_sample())
    }

    /// The same where its work is counted with that of others.
    pub(crate) fn step_watched_within(
        &mut self,
        input: f64,
        load: f64,
        dt: f64,
        meter: &mut Meter,
    ) -> Result<()> {
        let before = self.standing();
        let done = self.step_within(input, load, dt, meter);
        if done.is_ok() && self.is_sound_throughout(&before) {
            return done;
        }
        let problem = self.ran_away(dt);
        self.return_to(before);
        done.and(Err(problem))
    }

    /// Whether all of the state is made of numbers, where it was so before.
    pub fn is_sound(&self, before: &Standing) -> bool {
        let run = &self.run;
        let moves = [run.position, run.velocity, run.friction, run.path, run.wound, run.relaxed];
        let second = [run.second_position, run.second_velocity, run.ambient()];
        let size: f64 = moves.into_iter().chain(second).map(f64::abs).sum();
        // What effects remember and what is on its way is of no size that the body shows.
        let alone = self.way.is_none() && !self.machine.effects.remembers();
        (alone && self.range.holds(size)) || self.is_sound_throughout(before)
    }

    #[cold]
    fn is_sound_throughout(&self, before: &Standing) -> bool {
        let friction = with_state!(&before.state, |state| state.entries());
        let effects = &self.machine.effects;
        let way = self.way.iter().flat_map(Way::entries);
        let own = way.chain(effects.remembers().then(|| effects.entry()));
        let numbers = |(_, entry): (&str, Entry)| match entry {
            Entry::Number(x) => x.is_finite(),
            Entry::Pairs(rows) => rows.as_flattened().iter().all(|x| x.is_finite()),
        };
        self.run.is_finite()
            && own.into_iter().all(numbers)
            && sound(&friction, &self.friction_entries())
    }

    /// What is no number any more after a sample or several that took so long.
    #[cold]
    pub fn ran_away(&self, duration: f64) -> Error {
        let Run { position, velocity, friction, .. } = self.run;
        let shown = [("position", position), ("velocity", velocity), ("friction", friction)];
        let gone = shown.into_iter().find(|(_, value)| !value.is_finite());
        let (what, value) = gone.unwrap_or(("a state beside position and velocity", f64::NAN));
        Error::RanAway { what, value, duration }
    }
}
