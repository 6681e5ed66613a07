//! Effects: what a plant may do beside its friction law. The trait they fulfil and the one list.
//!
//! An effect is one file in this folder plus one line in [`effects!`] below. Every effect has a
//! neutral point at which it changes no bit, and hooks that say where it enters.

use elements::facts;
use elements::situation;

pub use elements::sorted::Effects;
pub(crate) use elements::sorted::never_driving;
pub use elements::spec::EffectSpec;
pub use facts::{EffectFacts, Hook, Scale, Shape};
pub use situation::{
    Coupling, LevelChange, MEMORY, Memory, Passage, Reading, Relaxation, SecondMass, Situation,
};

use crate::math::scalar::Scalar;
use crate::math::wave::Wave;
use crate::support::error::{Error, Result};
use crate::support::parameter::{Default as DefaultValue, ParameterSpec};

/// An effect: hooks that it does not use keep their neutral default.
///
/// What is asked in every sample is marked `#[inline(always)]`: only what is part of a loop is compiled
/// for the widest vectors, and rows of derivatives take three times as long without them.
pub trait Effect<S: Scalar>: Clone + std::fmt::Debug + Send + Sync {
    /// Parameters, in the order of [`Effect::build`]'s values. Gains default to 0.
    const PARAMETERS: &'static [ParameterSpec];
    /// Where it enters.
    const HOOKS: &'static [Hook];
    /// What diagnosis needs to know.
    const FACTS: EffectFacts;
    /// Whether it depends on what happened before.
    const REMEMBERS: bool = false;

    /// Whether its level goes by speed or efforts, and not by place, path, time and temperature alone.
    const ASKS_SPEED: bool = true;
    /// Whether its level changes while nothing moves: with time or efforts.
    const CHANGES_IN_TIME: bool = true;
    /// Whether what the input becomes goes by where the body is and how fast.
    const MAPS_BY_PLACE: bool = true;

    /// The effect with these values.
    fn build(values: &[S]) -> Self;

    /// Share added to the friction levels.
    #[inline(always)]
    fn level(&self, _at: &Situation<S>, _memory: &Memory<S>) -> LevelChange<S> {
        LevelChange { friction: S::constant(0.0), viscous: S::constant(0.0) }
    }
    /// What a contact remembers that was never moved.
    fn fresh(&self) -> Memory<S> {
        [S::constant(0.0); MEMORY]
    }
    /// Takes a sample into the memory.
    #[inline(always)]
    fn remember(&self, _memory: &mut Memory<S>, _passage: &Passage<S>) {}
    /// Effort added on the body, positive along +x.
    #[inline(always)]
    fn effort(&self, _at: &Situation<S>, _memory: &Memory<S>) -> S {
        S::constant(0.0)
    }
    /// The same where it is the same everywhere and always.
    fn even_effort(&self) -> Option<S> {
        None
    }
    /// The same where it is a wave over position: what loops ask for without a call.
    fn effort_wave(&self) -> Option<Wave<S>> {
        None
    }
    /// The share added to the level of dry friction where that is a wave over position and all there is.
    fn level_wave(&self) -> Option<Wave<S>> {
        None
    }
    /// What the input becomes.
    #[inline(always)]
    fn input(&self, input: S, _at: &Situation<S>) -> S {
        input
    }
    /// The share of the input that is added to it, where that is a wave over position.
    fn input_wave(&self) -> Option<Wave<S>> {
        None
    }
    /// How late the input arrives, in s. A delay that is there is followed even where it is 0, so
    /// that derivatives see it.
    fn delay(&self) -> Option<S> {
        None
    }
    /// Time that the input takes for one unit of a change, in s per unit: one over the greatest rate.
    /// One that is there is followed even where it is 0, so that derivatives see it.
    fn slowness(&self) -> Option<S> {
        None
    }
    /// Time constant with which the effort follows the input, in s. One that is there is followed
    /// even where it is 0, so that derivatives see it.
    fn lag(&self) -> Option<S> {
        None
    }
    /// What the sensor reads beyond the position.
    #[inline(always)]
    fn sensor(&self, _position: S) -> Reading<S> {
        Reading { error: S::constant(0.0), slope: S::constant(0.0) }
    }
    /// What it puts in series with the law.
    fn relaxation(&self) -> Option<Relaxation<S>> {
        None
    }
    /// The second mass that it adds.
    fn second_mass(&self) -> Option<SecondMass<S>> {
        None
    }
    /// Greatest stiffness that it adds to a contact with this friction of slow sliding.
    fn stiffness(&self, _sliding: f64) -> f64 {
        0.0
    }
    /// ∂effort/∂velocity that it adds at this velocity, where it calms the motion: no less at a speed than
    /// below it.
    fn damping(&self, _velocity: f64) -> f64 {
        0.0
    }
}

/// An effect as the catalogue knows it.
#[derive(Debug, Clone, Copy)]
pub struct EffectRecord {
    /// Canonical name.
    pub name: &'static str,
    /// Parameters.
    pub parameters: &'static [ParameterSpec],
    /// Where it enters.
    pub hooks: &'static [Hook],
    /// What diagnosis needs to know.
    pub facts: EffectFacts,
}

impl EffectRecord {
    /// Whether a contact alone can have it.
    pub fn at_contact(&self) -> bool {
        self.hooks.iter().all(|hook| hook.at_contact())
    }
}

macro_rules! effects {
    ($($module:ident => $effect:ident,)*) => {
        $(pub mod $module;)*

        /// Any effect of the catalogue.
        #[derive(Debug, Clone)]
        pub enum AnyEffect<S: Scalar> {
            $(#[doc = stringify!($module)] $effect($module::$effect<S>),)*
        }

        /// Every effect, in the order of the list.
        pub const EFFECTS: &[EffectRecord] = &[$(EffectRecord {
            name: stringify!($module),
            parameters: <$module::$effect<f64> as Effect<f64>>::PARAMETERS,
            hooks: <$module::$effect<f64> as Effect<f64>>::HOOKS,
            facts: <$module::$effect<f64> as Effect<f64>>::FACTS,
        },)*];

        impl<S: Scalar> AnyEffect<S> {
            /// The effect called `name` with these values.
            pub fn build(name: &str, values: &[S]) -> Result<Self> {
                match name {
                    $(stringify!($module) => Ok(Self::$effect($module::$effect::build(values))),)*
                    _ => Err(unknown_effect(name)),
                }
            }

            fn remembers(&self) -> bool {
                match self {
                    $(Self::$effect(_) => <$module::$effect<S> as Effect<S>>::REMEMBERS,)*
                }
            }

            fn asks_speed(&self) -> bool {
                match self {
                    $(Self::$effect(_) => <$module::$effect<S> as Effect<S>>::ASKS_SPEED,)*
                }
            }

            fn changes_in_time(&self) -> bool {
                match self {
                    $(Self::$effect(_) => <$module::$effect<S> as Effect<S>>::CHANGES_IN_TIME,)*
                }
            }

            fn maps_by_place(&self) -> bool {
                match self {
                    $(Self::$effect(_) => <$module::$effect<S> as Effect<S>>::MAPS_BY_PLACE,)*
                }
            }

            fn hooks(&self) -> &'static [Hook] {
                match self {
                    $(Self::$effect(_) => <$module::$effect<S> as Effect<S>>::HOOKS,)*
                }
            }
        }

        /// Runs an expression with the concrete effect.
        macro_rules! with_effect {
            ($any:expr, |$inner:ident| $body:expr) => {
                match $any { $(AnyEffect::$effect($inner) => $body,)* }
            };
        }
    };
}

effects! {
    back_emf => BackEmf,
    backlash => Backlash,
    cogging => Cogging,
    creep_hardening => CreepHardening,
    current_loop_lag => CurrentLoopLag,
    direction_asymmetry => DirectionAsymmetry,
    drive_deadband => DriveDeadband,
    drive_saturation => DriveSaturation,
    dwell_strengthening => DwellStrengthening,
    effort_dependent_friction => EffortDependentFriction,
    encoder_eccentricity => EncoderEccentricity,
    frictional_lag => FrictionalLag,
    goal_rate_limit => GoalRateLimit,
    gravity_unbalance => GravityUnbalance,
    input_delay => InputDelay,
    load_dependent_friction => LoadDependentFriction,
    position_dependent_friction => PositionDependentFriction,
    rate_dependent_breakaway => RateDependentBreakaway,
    relaxation => SteadyRelaxation,
    reverse_point_memory => ReversePointMemory,
    run_in => RunIn,
    shaft_compliance => ShaftCompliance,
    stribeck => Stribeck,
    temperature_dependent_friction => TemperatureDependentFriction,
    torque_bias => TorqueBias,
    torque_constant_ripple => TorqueConstantRipple,
    torque_constant_saturation => TorqueConstantSaturation,
    viscous_quadratic => ViscousQuadratic,
    voltage_limit => VoltageLimit,
    warm_up => WarmUp,
}

// After the list: it runs expressions with any effect.
mod elements;

/// The record of the effect called `name`.
pub fn effect_record(name: &str) -> Result<&'static EffectRecord> {
    EFFECTS.iter().find(|effect| effect.name == name).ok_or_else(|| unknown_effect(name))
}

fn unknown_effect(name: &str) -> Error {
    Error::unknown("effect", name, EFFECTS.iter().map(|effect| effect.name))
}

/// The values at which an effect changes nothing: gains 0, the rest at their typical values.
pub fn neutral_values(record: &EffectRecord) -> Vec<f64> {
    record
        .parameters
        .iter()
        .map(|spec| match (spec.neutral, spec.default) {
            (Some(neutral), _) => neutral,
            (None, DefaultValue::Value(value)) => value,
            (None, DefaultValue::Ratio { otherwise, .. }) => otherwise,
        })
        .collect()
}
