//! Effort that follows the input late.

use super::{Effect, EffectFacts, Hook};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`InputDelay`].
    pub struct InputDelayParameters {
        delay: Time, "how much later than the input the effort comes, τ",
            default Value(0.0), neutral Some(0.0), typical 0.002, bounds 0.0, 0.5;
    }
}

/// Effort of the input τ earlier: a bus, a controller's own cycle, a current loop of high order.
///
/// The input is held over each sample. What acts over a sample is the mean of the delayed input
/// over it, (U(t₁−τ) − U(t₀−τ))/dt with U the integral of the input: no impulse is lost, no sample
/// is divided, and it is piecewise linear in τ. At a kink the derivative by τ is that towards
/// longer delays, at τ = 0 (u₋₁ − u)/dt. Before the first sample the input was 0. The delay comes
/// before whatever else changes the input, the drive's limit included.
///
/// Neutral: τ = 0.
/// Source: Åström, Wittenmark, Computer-Controlled Systems (1997), ch. 2, sampling with a delay.
#[derive(Debug, Clone)]
pub struct InputDelay<S>(InputDelayParameters<S>);

impl<S: Scalar> Effect<S> for InputDelay<S> {
    const PARAMETERS: &'static [ParameterSpec] = InputDelayParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::InputDelay];
    const FACTS: EffectFacts = EffectFacts {
        summary: "effort follows the input late",
        means: "the controller acts on a machine that answers later than it thinks: less phase margin",
        remedy: "put the delay into the controller's model, or look for a slow bus, a filter on the \
                 command or stamps from another clock",
        class: "lag",
        coordinate: "rate of the input",
        channels: &[],
        look_alikes: &["current_loop_lag"],
        experiment: "chirp of the input above 1/(10 times the delay)",
        plan: "chirp",
        gains: &["delay"],
        shapes: &[],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(InputDelayParameters::from_values(values))
    }

    fn delay(&self) -> Option<S> {
        Some(self.0.delay)
    }
}
