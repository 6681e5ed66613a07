//! Friction that grows with the square of speed.

use super::{Effect, EffectFacts, Hook, Memory, Situation};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`ViscousQuadratic`].
    pub struct ViscousQuadraticParameters {
        quadratic: QuadraticDamping, "friction per speed squared",
            default Value(0.0), neutral Some(0.0), typical 0.01, bounds 0.0, 1e9;
    }
}

/// Effort −q·v·|v|: windage, churning of grease; below 0 it is viscous friction that saturates.
///
/// Neutral: q = 0.
/// Source: Swevers et al., IEEE Trans. Robot. Autom. 13 (1997), the quadratic term of drives.
#[derive(Debug, Clone)]
pub struct ViscousQuadratic<S>(ViscousQuadraticParameters<S>);

impl<S: Scalar> Effect<S> for ViscousQuadratic<S> {
    const PARAMETERS: &'static [ParameterSpec] = ViscousQuadraticParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::AddedEffort];
    const FACTS: EffectFacts = EffectFacts {
        summary: "friction that grows with the square of speed",
        means: "drag at high speed is more than proportional to it",
        remedy: "add the fitted term to the feed-forward; look for churned grease, a fan, eddy currents",
        class: "viscous_quadratic",
        coordinate: "high speed, odd in direction",
        channels: &[],
        look_alikes: &[],
        experiment: "top speed at least three times the normal one",
        plan: "fast",
        gains: &["quadratic"],
        shapes: &[],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(ViscousQuadraticParameters::from_values(values))
    }

    #[inline(always)]
    fn effort(&self, at: &Situation<S>, _memory: &Memory<S>) -> S {
        -(self.0.quadratic * at.velocity * at.velocity.abs())
    }

    fn damping(&self, velocity: f64) -> f64 {
        2.0 * self.0.quadratic.re() * velocity.abs()
    }
}
