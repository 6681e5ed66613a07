//! Parameters: declared once, with name, meaning, unit, neutral and typical value and bounds.

use crate::support::error::{Error, Result};

/// Whether a machine turns or translates; decides which unit a quantity is printed in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MotionKind {
    /// Angles in radians, effort is torque.
    #[default]
    Rotary,
    /// Positions in metres, effort is force.
    Linear,
}

/// What a parameter measures. Efforts are torques or forces, positions angles or lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // the names are what there is to say
pub enum Quantity {
    One,
    Effort,
    EffortRate,
    Position,
    Velocity,
    Stiffness,
    Damping,
    QuadraticDamping,
    Inertia,
    Time,
    Rate,
    Compliance,
    PerEffort,
    PerPosition,
    PerPositionTime,
    PerVelocity,
    Voltage,
    Resistance,
    Current,
    PerKelvin,
    Temperature,
    /// Whatever the input of the drive is measured in.
    Input,
    /// Radians (metres) of hardening per effort to the power of the hardening exponent.
    Hardening,
    /// Cycles per radian (metre).
    Order,
}

impl Quantity {
    /// The SI unit for this kind of motion.
    pub const fn unit(self, motion: MotionKind) -> &'static str {
        let (rotary, linear) = match self {
            Self::One => ("1", "1"),
            Self::Effort => ("N·m", "N"),
            Self::EffortRate => ("N·m/s", "N/s"),
            Self::Position => ("rad", "m"),
            Self::Velocity => ("rad/s", "m/s"),
            Self::Stiffness => ("N·m/rad", "N/m"),
            Self::Damping => ("N·m·s/rad", "N·s/m"),
            Self::QuadraticDamping => ("N·m·s²/rad²", "N·s²/m²"),
            Self::Inertia => ("kg·m²", "kg"),
            Self::Time => ("s", "s"),
            Self::Rate => ("1/s", "1/s"),
            Self::Compliance => ("rad/(N·m)", "m/N"),
            Self::PerEffort => ("1/(N·m)", "1/N"),
            Self::PerPosition => ("1/rad", "1/m"),
            Self::PerPositionTime => ("1/(rad·s)", "1/(m·s)"),
            Self::Voltage => ("V", "V"),
            Self::Resistance => ("Ω", "Ω"),
            Self::Current => ("A", "A"),
            Self::PerVelocity => ("s/rad", "s/m"),
            Self::PerKelvin => ("1/K", "1/K"),
            Self::Temperature => ("degC", "degC"),
            Self::Input => ("input", "input"),
            Self::Hardening => ("rad/(N·m)^n", "m/N^n"),
            Self::Order => ("1/rad", "1/m"),
        };
        match motion {
            MotionKind::Rotary => rotary,
            MotionKind::Linear => linear,
        }
    }
}

/// What a parameter is when the user does not state it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Default {
    /// This value.
    Value(f64),
    /// `factor` times another parameter where that one is stated, else `otherwise`.
    Ratio {
        /// Name of the other parameter.
        of: &'static str,
        /// Multiplier.
        factor: f64,
        /// Value where neither is stated.
        otherwise: f64,
    },
}

/// One parameter of a law or an effect.
#[derive(Debug, Clone, Copy)]
pub struct ParameterSpec {
    /// The field's word for it.
    pub name: &'static str,
    /// What it means, one clause.
    pub meaning: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// Its value when unstated.
    pub default: Default,
    /// The value at which it does nothing, where there is one.
    pub neutral: Option<f64>,
    /// A value seen on real machines.
    pub typical: f64,
    /// Least and greatest allowed value, both allowed.
    pub bounds: (f64, f64),
}

impl ParameterSpec {
    /// Refuses a value outside the bounds.
    pub fn check(&self, value: f64) -> Result<()> {
        let (lower, upper) = self.bounds;
        if value.is_nan() {
            return Err(Error::NotFinite { name: self.name.to_owned(), given: value });
        }
        if value < lower || value > upper {
            return Err(Error::OutOfBounds {
                name: self.name.to_owned(),
                given: value,
                lower,
                upper,
                unit: match self.quantity {
                    Quantity::One => String::new(),
                    q => {
                        format!(" {} ({})", q.unit(MotionKind::Rotary), q.unit(MotionKind::Linear))
                    }
                },
            });
        }
        Ok(())
    }
}

/// A choice between named behaviours of a law; the first choice is the default.
#[derive(Debug, Clone, Copy)]
pub struct OptionSpec {
    /// Keyword.
    pub name: &'static str,
    /// What is being chosen.
    pub meaning: &'static str,
    /// The words allowed and what each does.
    pub choices: &'static [(&'static str, &'static str)],
}

/// Fills in what the user left out and checks every bound.
pub fn resolve(kind: &str, specs: &[ParameterSpec], stated: &[(String, f64)]) -> Result<Vec<f64>> {
    for (name, value) in stated {
        match specs.iter().find(|spec| spec.name == name) {
            // Before what follows from it: a level that nobody stated must not be told as wrong.
            Some(spec) => spec.check(*value)?,
            None => {
                return Err(Error::unknown(
                    format!("parameter of {kind}"),
                    name,
                    specs.iter().map(|spec| spec.name),
                ));
            }
        }
    }
    let given = |name: &str| stated.iter().find(|(n, _)| n == name).map(|(_, v)| *v);
    specs
        .iter()
        .map(|spec| {
            let value = given(spec.name).unwrap_or_else(|| match spec.default {
                Default::Value(value) => value,
                Default::Ratio { of, factor, otherwise } => {
                    given(of).map_or(otherwise, |other| factor * other)
                }
            });
            spec.check(value)?;
            Ok(value)
        })
        .collect()
}

/// Declares the parameters of a law or an effect once: a struct of scalars, its specifications in
/// the same order, and the way from a slice of values to the struct.
#[macro_export]
macro_rules! parameters {
    (
        $(#[$outer:meta])*
        $visibility:vis struct $name:ident {
            $(
                $field:ident: $quantity:ident, $meaning:literal,
                default $default:expr, neutral $neutral:expr, typical $typical:expr,
                bounds $lower:expr, $upper:expr;
            )*
        }
    ) => {
        $(#[$outer])*
        #[derive(Debug, Clone, Copy)]
        $visibility struct $name<S> {
            $(#[doc = $meaning] pub $field: S,)*
        }

        impl<S: $crate::math::scalar::Scalar> $name<S> {
            /// Specifications in the order of the values.
            pub const SPECS: &'static [$crate::support::parameter::ParameterSpec] = {
                #[allow(unused_imports)] // few laws have both
                use $crate::support::parameter::Default::{Ratio, Value};
                &[$(
                    $crate::support::parameter::ParameterSpec {
                        name: stringify!($field),
                        meaning: $meaning,
                        quantity: $crate::support::parameter::Quantity::$quantity,
                        default: $default,
                        neutral: $neutral,
                        typical: $typical,
                        bounds: ($lower, $upper),
                    },
                )*]
            };

            /// Takes the values in the order of the specifications.
            pub fn from_values(values: &[S]) -> Self {
                let mut values = values.iter().copied();
                let mut next = || values.next().unwrap_or(S::constant(f64::NAN));
                Self { $($field: next(),)* }
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPECS: &[ParameterSpec] = &[ParameterSpec {
        name: "coulomb",
        meaning: "level",
        quantity: Quantity::Effort,
        default: Default::Value(1.0),
        neutral: None,
        typical: 1.0,
        bounds: (0.0, 10.0),
    }];

    #[test]
    fn bad_parameters_are_refused_with_their_name_and_value() {
        let stated = |v: f64| vec![("coulomb".to_owned(), v)];
        assert_eq!(resolve("x", SPECS, &stated(2.0)), Ok(vec![2.0]));
        let sentence = resolve("x", SPECS, &stated(-1.0)).unwrap_err().to_string();
        assert!(sentence.contains("coulomb = -1") && sentence.contains("0 to 10"), "{sentence}");
        assert!(resolve("x", SPECS, &stated(f64::NAN)).is_err());
        let follows = ParameterSpec {
            name: "sliding",
            default: Default::Ratio { of: "coulomb", factor: 0.7, otherwise: 1.0 },
            ..SPECS[0]
        };
        let given = resolve("x", &[follows, SPECS[0]], &stated(-1.0)).unwrap_err().to_string();
        assert!(given.contains("coulomb = -1"), "{given}");
        let unknown = resolve("x", SPECS, &[("columb".to_owned(), 1.0)]).unwrap_err().to_string();
        assert!(unknown.contains("did you mean 'coulomb'"), "{unknown}");
    }
}
