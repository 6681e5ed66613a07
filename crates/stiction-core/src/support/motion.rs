//! A motion that is given.

use super::error::Result;
use super::samples::{PerSample, Surroundings};

/// A motion that was measured or prescribed, and what acted meanwhile.
#[derive(Debug, Clone, Copy)]
pub struct MeasuredMotion<'a> {
    /// Positions, one more than there are samples.
    pub positions: &'a [f64],
    /// Inputs.
    pub inputs: PerSample<'a>,
    /// What acts beside them.
    pub around: Surroundings<'a>,
    /// Durations.
    pub dt: PerSample<'a>,
    /// Whether friction of a rigid contact is its mean about each stamp (see `Running::follow_about`),
    /// not its value there, and whether a contact that yields goes through where the motion turns
    /// between two stamps.
    pub averaged: bool,
}

impl MeasuredMotion<'_> {
    /// Samples between the positions.
    pub fn samples(&self) -> usize {
        self.positions.len().saturating_sub(1)
    }

    /// Checks that there is a value for every sample.
    pub fn check(&self) -> Result<()> {
        let wanted = self.samples();
        self.inputs.check("input", wanted)?;
        self.around.check(wanted)?;
        self.dt.check("dt", wanted)
    }
}
