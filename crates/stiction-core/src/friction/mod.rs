//! The catalogue of friction laws.
//!
//! A law is one file in this folder plus one line in [`laws!`] below. From that line it appears in
//! simulation, binding, command line, documentation and the generic tests.

pub mod elements;

pub use elements::contact::{Arrival, Channels, Event, Motion, Outcome, Push, Rest, Statistics};
pub use elements::entry::{Entry, EntryReader};
pub use elements::law::{FrictionLaw, INTERNAL, LawState};
pub use elements::plain_steps::PlainSteps;
pub use elements::spec::LawSpec;

use elements::abreast::Asked;

use crate::math::scalar::Scalar;
use crate::support::error::{Error, Result};
use crate::support::parameter::{OptionSpec, ParameterSpec};

/// A law as the catalogue knows it.
#[derive(Debug, Clone, Copy)]
pub struct LawRecord {
    /// Canonical name.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Parameters.
    pub parameters: &'static [ParameterSpec],
    /// Parameters that a fit leaves alone unless they are stated.
    pub optional: &'static [&'static str],
    /// What a contact may bring along from before a recording.
    pub start: &'static [ParameterSpec],
    /// Whether it remembers where it turned round.
    pub remembers: bool,
    /// Whether a body without viscous friction on it makes much of little.
    pub sensitive: bool,
    /// Options.
    pub options: &'static [OptionSpec],
    /// States that a trajectory can show.
    pub outputs: &'static [&'static str],
}

/// A law as one of the catalogue.
pub trait Catalogued<S: Scalar>: FrictionLaw<S> {
    /// This law and its state, where any law and its state are.
    fn among<'a>(
        law: &'a Law<S>,
        state: &'a mut AnyState<S>,
    ) -> Option<(&'a Self, &'a mut Self::State)>;
    /// A step of this law, as one of any.
    fn any(trial: Self::Trial) -> AnyTrial<S>;
}

macro_rules! laws {
    ($($module:ident => $law:ident,)*) => {
        $(pub mod $module;)*

        /// Any law of the catalogue.
        #[derive(Debug, Clone)]
        pub enum Law<S: Scalar> {
            $(#[doc = stringify!($module)] $law($module::$law<S>),)*
        }

        /// The state of any law of the catalogue.
        #[derive(Debug, Clone)]
        pub enum AnyState<S: Scalar> {
            $(#[doc = stringify!($module)] $law(<$module::$law<S> as FrictionLaw<S>>::State),)*
        }

        /// A step of any law of the catalogue, evaluated and not yet accepted.
        #[derive(Debug, Clone, Copy)]
        pub enum AnyTrial<S: Scalar> {
            $(#[doc = stringify!($module)] $law(<$module::$law<S> as FrictionLaw<S>>::Trial),)*
        }

        /// Every law, in the order of the list.
        pub const LAWS: &[LawRecord] = &[$(LawRecord {
            name: stringify!($module),
            summary: <$module::$law<f64> as FrictionLaw<f64>>::SUMMARY,
            source: <$module::$law<f64> as FrictionLaw<f64>>::SOURCE,
            parameters: <$module::$law<f64> as FrictionLaw<f64>>::PARAMETERS,
            optional: <$module::$law<f64> as FrictionLaw<f64>>::OPTIONAL,
            start: <$module::$law<f64> as FrictionLaw<f64>>::START,
            remembers: <$module::$law<f64> as FrictionLaw<f64>>::REMEMBERS,
            sensitive: <$module::$law<f64> as FrictionLaw<f64>>::SENSITIVE,
            options: <$module::$law<f64> as FrictionLaw<f64>>::OPTIONS,
            outputs: <<$module::$law<f64> as FrictionLaw<f64>>::State as LawState<f64>>::OUTPUTS,
        },)*];

        impl<S: Scalar> Law<S> {
            /// The law called `name` with these values and choices.
            pub fn build(name: &str, values: &[S], choices: &[usize]) -> Result<Self> {
                match name {
                    $(stringify!($module) => {
                        Ok(Self::$law($module::$law::build(values, choices)))
                    })*
                    _ => Err(unknown_law(name)),
                }
            }

            /// Refuses values that single bounds cannot exclude.
            pub fn check(name: &str, values: &[f64]) -> Result<()> {
                match name {
                    $(stringify!($module) => {
                        <$module::$law<f64> as FrictionLaw<f64>>::check(values)
                    })*
                    _ => Err(unknown_law(name)),
                }
            }
        }

        impl Law<f64> {
            /// Whether a contact with these values never gives back more than it took.
            pub fn passive(name: &str, values: &[f64]) -> Result<bool> {
                match name {
                    $(stringify!($module) => {
                        Ok(<$module::$law<f64> as FrictionLaw<f64>>::passive(values))
                    })*
                    _ => Err(unknown_law(name)),
                }
            }
        }

        impl Law<f64> {
            /// Whether motors with contacts like this one go through their samples side by side.
            pub fn goes_abreast(&self) -> bool {
                match self { $(Self::$law(law) => law.abreast(Asked).is_some(),)* }
            }
        }

        $(impl<S: Scalar> Catalogued<S> for $module::$law<S> {
            fn among<'a>(
                law: &'a Law<S>,
                state: &'a mut AnyState<S>,
            ) -> Option<(&'a Self, &'a mut Self::State)> {
                match (law, state) {
                    (Law::$law(law), AnyState::$law(state)) => Some((law, state)),
                    #[allow(unreachable_patterns)] // a catalogue of one law has no other
                    _ => None,
                }
            }

            fn any(trial: Self::Trial) -> AnyTrial<S> {
                AnyTrial::$law(trial)
            }
        })*

        impl<S: Scalar> AnyState<S> {
            /// The same state over another number type, with no parameter dependence.
            pub fn lift<T: Scalar>(&self) -> AnyState<T> {
                match self {
                    $(Self::$law(state) => AnyState::$law(state.map(|x| T::constant(x.re()))),)*
                }
            }
        }

        /// Runs an expression with the concrete law.
        macro_rules! with_law {
            ($any:expr, |$inner:ident| $body:expr) => {
                match $any { $($crate::friction::Law::$law($inner) => $body,)* }
            };
        }

        /// Runs an expression with the concrete state.
        macro_rules! with_state {
            ($any:expr, |$inner:ident| $body:expr) => {
                match $any { $($crate::friction::AnyState::$law($inner) => $body,)* }
            };
        }

        /// Runs an expression with the concrete law and its state.
        macro_rules! with_law_and_state {
            ($any:expr, $state:expr, |$inner:ident, $held:ident| $body:expr) => {
                match ($any, $state) {
                    $(($crate::friction::Law::$law($inner),
                       $crate::friction::AnyState::$law($held)) => $body,)*
                    #[allow(unreachable_patterns)] // a catalogue of one law has no other
                    _ => unreachable!("a state is only ever made by its own law"),
                }
            };
        }

        impl<S: Scalar> Law<S> {
            /// Accepts a step of this law.
            pub fn commit(&self, state: &mut AnyState<S>, trial: &AnyTrial<S>) {
                match (self, state, trial) {
                    $((Self::$law(law), AnyState::$law(state), AnyTrial::$law(trial)) => {
                        state.make_room(1);
                        law.commit(state, trial);
                    })*
                    #[allow(unreachable_patterns)] // a catalogue of one law has no other
                    _ => unreachable!("a trial is only ever made by its own law"),
                }
            }

            /// Force at level 1 beyond which a contact that is loaded slowly slides; infinite where it never does.
            pub fn sliding_force(&self) -> S {
                match self { $(Self::$law(law) => law.sliding_force(),)* }
            }

            /// The state of a contact that was never moved.
            pub fn initial(&self) -> AnyState<S> {
                match self { $(Self::$law(law) => AnyState::$law(law.initial()),)* }
            }

            /// The state of a contact that brings these start values along.
            pub fn primed(&self, values: &[S]) -> AnyState<S> {
                match self { $(Self::$law(law) => AnyState::$law(law.primed(values)),)* }
            }

            /// Rebuilds a state from its entries.
            pub fn restore(&self, entries: &[(String, Entry)]) -> Result<AnyState<S>> {
                match self { $(Self::$law(law) => law.restore(entries).map(AnyState::$law),)* }
            }
        }
    };
}

laws! {
    bouc_wen => BoucWen,
    bristle => Bristle,
    coulomb => Coulomb,
    dahl => Dahl,
    dahl_with_memory => DahlWithMemory,
    elastic_perfectly_plastic => ElasticPerfectlyPlastic,
    elasto_plastic => ElastoPlastic,
    futami => Futami,
    gms => Gms,
    hsieh_pan => HsiehPan,
    leuven => Leuven,
    load_dependent => LoadDependent,
    lugre => LuGre,
    maxwell_slip => MaxwellSlip,
    parallel_elements => ParallelElements,
    prandtl_ishlinskii => PrandtlIshlinskii,
    preisach => Preisach,
    rate_and_state => RateAndState,
    reset_integrator => ResetIntegrator,
    rigid_perfectly_plastic => RigidPerfectlyPlastic,
    ro_hubbel => RoHubbel,
}

/// The record of the law called `name`.
pub fn law_record(name: &str) -> Result<&'static LawRecord> {
    LAWS.iter().find(|law| law.name == name).ok_or_else(|| unknown_law(name))
}

fn unknown_law(name: &str) -> Error {
    Error::unknown("law", name, LAWS.iter().map(|law| law.name))
}
