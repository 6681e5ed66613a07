//! The state of a motor as named entries.

use std::borrow::Cow;

use super::Running;
use crate::friction::{Entry, EntryReader, LawState};
use crate::plant::Budget;
use crate::plant::drive::Way;
use crate::plant::naming::{BODY, BUDGET, blamed, parted, qualified};
use crate::support::error::Result;

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

    /// The friction state alone, as a [`crate::simulate::model::FrictionModel`] has it.
    pub fn friction_entries(&self) -> Vec<(&'static str, Entry)> {
        with_state!(&self.state, |state| state.entries())
    }

    /// Sets the state from named entries; where one of them is wrong, nothing changes.
    pub fn restore(&mut self, entries: &[(String, Entry)]) -> Result<()> {
        let [own, law] = parted(entries);
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
        let state = self.law.restore(&law).map_err(blamed)?;
        (self.state, self.run, self.way) = (state, run, way);
        self.machine.effects = effects;
        self.range.forget();
        self.range.meet(entries.iter().map(|(_, entry)| entry));
        Ok(())
    }
}
