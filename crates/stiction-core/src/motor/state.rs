//! The state of a motor as named entries.
//!
//! A law names its states as it likes, and so may a body: where both have one of a name, that of the law
//! is called `friction.name` in a motor. No name of either has a dot of its own, so that no two entries
//! of a motor can ever be called alike.

use std::borrow::Cow;

use super::Running;
use crate::drive::Way;
use crate::effects::Effects;
use crate::error::{Error, Result};
use crate::friction::{Entry, EntryReader, LawState};
use crate::integrate::{Budget, Run};

/// Before the name of a law's state that is also one of a motor's own.
const QUALIFIED: &str = "friction.";

/// Names of the columns of a trajectory that are no states of a law.
pub(super) const COLUMNS: [&str; 4] = ["position", "velocity", "friction", "measured"];

/// A number that a body carries from sample to sample.
type Place = fn(&mut Run<f64>) -> &mut f64;

/// All of them, by name.
const BODY: [(&str, Place); 10] = [
    ("position", |run| &mut run.position),
    ("velocity", |run| &mut run.velocity),
    ("time", |run| &mut run.time),
    ("path", |run| &mut run.path),
    ("friction", |run| &mut run.friction),
    ("second_position", |run| &mut run.second_position),
    ("second_velocity", |run| &mut run.second_velocity),
    ("relaxed", |run| &mut run.relaxed),
    ("wound", |run| &mut run.wound),
    // As it was, not recomputed: it belongs to the end of the last step, to the bit.
    ("ambient", Run::ambient_mut),
];

/// What a contact beside effects has taken in, and the greatest kinetic energy so far.
const BUDGET: [&str; 2] = ["contact_work", "kinetic_peak"];

/// Whether a motor of any law, with any effects, calls something of its own so.
fn is_own(name: &str) -> bool {
    COLUMNS.contains(&name)
        || BODY.iter().any(|(own, _)| *own == name)
        || BUDGET.contains(&name)
        || Way::<f64>::NAMES.contains(&name)
        || name == Effects::<f64>::ENTRY
}

/// What a motor calls a state of its law.
pub(super) fn qualified(name: &'static str) -> Cow<'static, str> {
    if is_own(name) { Cow::Owned(format!("{QUALIFIED}{name}")) } else { Cow::Borrowed(name) }
}

/// What the law calls what a motor calls so; none where that is the motor's own.
pub(super) fn of_the_law(name: &str) -> Option<&str> {
    match name.strip_prefix(QUALIFIED) {
        Some(bare) if is_own(bare) => Some(bare),
        _ => (!is_own(name)).then_some(name),
    }
}

impl Running<f64> {
    /// State of body, drive, effects and friction as named entries.
    pub fn entries(&self) -> Vec<(Cow<'static, str>, Entry)> {
        let mut run = self.run;
        let body = BODY.map(|(name, place)| (name, Entry::Number(*place(&mut run))));
        let effects = &self.machine.effects;
        let remembered = effects.remembers().then(|| effects.entry());
        let way = self.way.iter().flat_map(Way::entries);
        let numbers = [self.run.budget.taken, self.run.budget.swing].map(Entry::Number);
        let counted = effects.any().then(|| BUDGET.into_iter().zip(numbers));
        let own =
            body.into_iter().chain(way).chain(remembered).chain(counted.into_iter().flatten());
        let law = self.friction_entries().into_iter().map(|(name, entry)| (qualified(name), entry));
        own.map(|(name, entry)| (Cow::Borrowed(name), entry)).chain(law).collect()
    }

    /// The friction state alone, as a [`crate::model::FrictionModel`] has it.
    pub fn friction_entries(&self) -> Vec<(&'static str, Entry)> {
        with_state!(&self.state, |state| state.entries())
    }

    /// Sets the state from named entries; where one of them is wrong, nothing changes.
    pub fn restore(&mut self, entries: &[(String, Entry)]) -> Result<()> {
        let (mut own, mut law) = (Vec::new(), Vec::new());
        for (name, entry) in entries {
            match of_the_law(name) {
                None => own.push((name.clone(), entry.clone())),
                Some(bare) => law.push((bare.to_owned(), entry.clone())),
            }
        }
        let mut run = self.run;
        let mut way = self.way.clone();
        let mut effects = self.machine.effects.clone();
        let mut read = EntryReader::new(&own);
        for (name, place) in BODY {
            *place(&mut run) = read.number(name, false)?;
        }
        if let Some(way) = &mut way {
            way.restore(&mut read)?;
        }
        if effects.remembers() {
            effects.restore(&mut read)?;
        }
        if effects.any() {
            // A state that was put together by hand may say nothing of it.
            run.budget = Budget::unknown();
            if own.iter().any(|(name, _)| BUDGET.contains(&name.as_str())) {
                run.budget.taken = read.number(BUDGET[0], true)?;
                run.budget.swing = read.at_least_zero(BUDGET[1])?;
            }
        }
        read.finish()?;
        let state = self.law.restore(&law).map_err(|error| match error {
            Error::State { name, problem } if is_own(&name) => {
                Error::State { name: format!("{QUALIFIED}{name}"), problem }
            }
            other => other,
        })?;
        (self.state, self.run, self.way) = (state, run, way);
        self.machine.effects = effects;
        self.range.forget();
        self.range.meet(entries.iter().map(|(_, entry)| entry));
        Ok(())
    }
}
