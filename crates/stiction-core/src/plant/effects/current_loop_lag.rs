//! Effort that follows the input gradually.

use super::{Effect, EffectFacts, Hook};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`CurrentLoopLag`].
    pub struct CurrentLoopLagParameters {
        time: Time, "time constant with which the effort follows the input, T",
            default Value(0.0), neutral Some(0.0), typical 0.002, bounds 0.0, 10.0;
    }
}

/// Effort of a filtered input, i' = (u − i)/T: a current loop, a coil, a filter on the command.
///
/// The input is held over each sample; what acts over a sample is the mean of i over it, in closed
/// form. At T = 0 the derivative is (i − u)/dt. Before the first sample the input was 0. The lag comes
/// after a delay and before whatever else changes the input.
///
/// Neutral: T = 0.
/// Source: Leonhard, Control of Electrical Drives (2001), ch. 7: the closed current loop as a first-order
/// lag.
#[derive(Debug, Clone)]
pub struct CurrentLoopLag<S>(CurrentLoopLagParameters<S>);

impl<S: Scalar> Effect<S> for CurrentLoopLag<S> {
    const PARAMETERS: &'static [ParameterSpec] = CurrentLoopLagParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::InputLag];
    const FACTS: EffectFacts = EffectFacts {
        summary: "effort follows the input with a lag",
        means: "the controller acts on a machine that answers later than it thinks, the more so the \
                 faster it asks: less phase margin",
        remedy: "put the lag into the controller's model, or make the current loop faster; look for \
                 a filter on the command",
        class: "lag",
        coordinate: "rate of the input",
        channels: &[],
        look_alikes: &["input_delay"],
        experiment: "chirp of the input above 1/(10 times the lag)",
        plan: "chirp",
        gains: &["time"],
        shapes: &[],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(CurrentLoopLagParameters::from_values(values))
    }

    fn lag(&self) -> Option<S> {
        Some(self.0.time)
    }
}
