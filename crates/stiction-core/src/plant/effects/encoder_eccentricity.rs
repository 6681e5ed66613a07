//! A position sensor that errs once a turn.

use super::{Effect, EffectFacts, Hook, Reading};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`EncoderEccentricity`].
    pub struct EncoderEccentricityParameters {
        cosine: Position, "amplitude of the cosine part of the reading's error",
            default Value(0.0), neutral Some(0.0), typical 5e-3, bounds -0.3, 0.3;
        sine: Position, "amplitude of the sine part of the reading's error",
            default Value(0.0), neutral Some(0.0), typical 5e-3, bounds -0.3, 0.3;
    }
}

/// Reading x + a·(cos x − 1) + b·sin x: a disc whose centre is not that of the shaft.
///
/// The bounds keep the reading rising with the position. Neutral: a = b = 0.
/// Source: Ellin, Dolsak, The design and application of rotary encoders, Sensor Review 28 (2008).
#[derive(Debug, Clone)]
pub struct EncoderEccentricity<S>(EncoderEccentricityParameters<S>);

impl<S: Scalar> Effect<S> for EncoderEccentricity<S> {
    const PARAMETERS: &'static [ParameterSpec] = EncoderEccentricityParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::SensorMap];
    const FACTS: EffectFacts = EffectFacts {
        summary: "the position sensor errs once a turn",
        means: "what reads as even speed is not: the machine really speeds up and slows down each turn",
        remedy: "subtract the fitted error from the readings; look for a disc or ring that is mounted off \
                 centre, or read it by two heads opposite each other",
        class: "sensor",
        coordinate: "acceleration and squared speed over position, once a turn",
        channels: &[],
        look_alikes: &[],
        experiment: "fast constant speed over many turns, both ways",
        plan: "fast",
        gains: &["cosine", "sine"],
        shapes: &[],
        second: &[],
        law_terms: &[],
        rotary_only: true,
    };

    fn build(values: &[S]) -> Self {
        Self(EncoderEccentricityParameters::from_values(values))
    }

    #[inline(always)]
    fn sensor(&self, position: S) -> Reading<S> {
        let p = &self.0;
        let (sine, cosine) = position.sin_cos();
        Reading {
            error: p.cosine * (cosine - 1.0) + p.sine * sine,
            slope: p.sine * cosine - p.cosine * sine,
        }
    }
}
