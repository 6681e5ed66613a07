//! A weight off the axis.

use super::{Effect, EffectFacts, Hook, Memory, Situation};
use crate::math::scalar::Scalar;
use crate::math::wave::Wave;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`GravityUnbalance`].
    pub struct GravityUnbalanceParameters {
        cosine: Effort, "amplitude of the cosine part",
            default Value(0.0), neutral Some(0.0), typical 0.02, bounds -1e9, 1e9;
        sine: Effort, "amplitude of the sine part",
            default Value(0.0), neutral Some(0.0), typical 0.02, bounds -1e9, 1e9;
    }
}

/// Effort a·cos(x) + b·sin(x): a mass off the axis, on a machine that was not told of it.
///
/// Where the plant states a gravity amplitude it has this already.
///
/// Neutral: a = b = 0.
/// Source: the pendulum; ISO 21940-11:2016 on what balancing leaves of it.
#[derive(Debug, Clone)]
pub struct GravityUnbalance<S>(Wave<S>);

impl<S: Scalar> Effect<S> for GravityUnbalance<S> {
    const PARAMETERS: &'static [ParameterSpec] = GravityUnbalanceParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::AddedEffort];
    const FACTS: EffectFacts = EffectFacts {
        summary: "effort that repeats once a turn, as of a weight off the axis",
        means: "the machine falls towards one angle and has to be held at all others: holding \
                 effort and slow motion depend on where it stands",
        remedy: "balance the moving part, or state the gravity in the plant and feed it forward; it \
                 turns with the mounting, which effort of the motor does not",
        class: "cogging",
        coordinate: "position once a turn, not odd in direction",
        channels: &[],
        look_alikes: &["cogging", "torque_bias"],
        experiment: "slow full turns both ways",
        plan: "turns",
        gains: &["cosine", "sine"],
        shapes: &[],
        second: &[],
        law_terms: &["body.gravity_amplitude"],
        rotary_only: true,
    };

    fn build(values: &[S]) -> Self {
        let GravityUnbalanceParameters { cosine, sine } =
            GravityUnbalanceParameters::from_values(values);
        Self(Wave::new([cosine, sine, S::constant(1.0)], [S::constant(0.0); 3]))
    }

    #[inline(always)]
    fn effort(&self, at: &Situation<S>, _memory: &Memory<S>) -> S {
        self.0.at(at.position)
    }

    fn effort_wave(&self) -> Option<Wave<S>> {
        Some(self.0)
    }

    fn stiffness(&self, _sliding: f64) -> f64 {
        self.0.steepest()
    }
}
