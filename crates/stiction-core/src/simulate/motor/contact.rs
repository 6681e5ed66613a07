//! The contact of a motor, alone: from a friction model, and as one.

use super::{EffectSpec, Motor, MotorSpec};
use crate::plant::Budget;
use crate::simulate::model::FrictionModel;
use crate::support::error::Result;

impl Motor {
    /// A motor with the law and the effects of a friction model before its own, which goes on from the state
    /// of that model, at rest where its contact is. Law and effects of `spec` are those beside it.
    pub fn with_contact(mut spec: MotorSpec, model: &FrictionModel) -> Result<Self> {
        spec.friction = model.spec().clone();
        spec.effects.splice(0..0, model.effects().iter().cloned());
        EffectSpec::refuse_twice(&spec.effects)?;
        let mut motor = Self::new(spec)?;
        motor.set_friction_state(model.state().clone());
        if let Some(effects) = model.surroundings() {
            let running = &mut motor.running;
            running.machine.effects.resume(effects.effects());
            let (run, from) = (&mut running.run, effects.run());
            let budget = run.budget;
            *run = running.machine.start(from.position, 0.0);
            (run.time, run.path, run.budget) = (from.time, from.path, budget);
            (run.friction, run.relaxed) = (from.friction, from.relaxed);
            if model.entries() != model.anew().entries() {
                running.run.budget = Budget::unknown();
            }
            let entries = model.entries();
            running.range.meet(entries.iter().map(|(_, entry)| entry));
        }
        Ok(motor)
    }

    /// The friction of this motor with those effects that a contact alone can have, in its present state;
    /// and the names of the effects that none can have.
    pub fn friction_model(&self) -> Result<(FrictionModel, Vec<&'static str>)> {
        let effects = self.spec.effects.iter().enumerate();
        let (kept, left): (Vec<_>, Vec<_>) = effects.partition(|(_, e)| e.record.at_contact());
        let specs = kept.iter().map(|(_, effect)| (*effect).clone()).collect();
        let mut model = FrictionModel::with_effects(self.spec.friction.clone(), specs)?;
        let places: Vec<usize> = kept.into_iter().map(|(place, _)| place).collect();
        let running = &self.running;
        model.take(running.state.clone(), &running.run, &running.machine.effects, &places);
        Ok((model, left.into_iter().map(|(_, effect)| effect.record.name).collect()))
    }
}
