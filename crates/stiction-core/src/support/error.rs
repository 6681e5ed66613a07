//! Every way in which a request can be wrong, each as one sentence: what was given, what is
//! allowed, where, what to do.

use std::fmt;

use thiserror::Error;

/// A number in a sentence: as a decimal, or with an exponent where that would fill a line.
pub struct Shown(pub f64);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plain = self.0.to_string();
        if plain.len() <= LONGEST_DECIMAL { f.write_str(&plain) } else { write!(f, "{:e}", self.0) }
    }
}

const LONGEST_DECIMAL: usize = 20;

/// A request that cannot be carried out.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Error {
    /// A name that is in no list.
    #[error("{kind} '{given}' is unknown{near}; known: {known}")]
    UnknownName {
        /// What was being named: "law", "effect", "parameter of hsieh_pan" …
        kind: String,
        /// The name as given.
        given: String,
        /// "; did you mean 'x'?" or empty.
        near: String,
        /// The allowed names, separated by commas.
        known: String,
    },
    /// A word where a number belongs, or the other way round.
    #[error("{name} is {given}; allowed is {allowed}")]
    WrongKind {
        /// What was being set.
        name: String,
        /// What was given.
        given: String,
        /// What is allowed.
        allowed: String,
    },
    /// A number outside its bounds.
    #[error(
        "{name} = {} is out of bounds: allowed is {} to {}{unit}; change {name}",
        Shown(*given), Shown(*lower), Shown(*upper)
    )]
    OutOfBounds {
        /// Path of the parameter, `friction.coulomb`.
        name: String,
        /// The value as given.
        given: f64,
        /// Least allowed value.
        lower: f64,
        /// Greatest allowed value.
        upper: f64,
        /// Unit with a leading space, or empty.
        unit: String,
    },
    /// A number that must be finite.
    #[error("{name} = {given} is not a finite number; give a finite one")]
    NotFinite {
        /// What the number is.
        name: String,
        /// The value as given.
        given: f64,
    },
    /// A sample that must be finite.
    #[error("{name}[{place}] = {given} is not a finite number; repair or drop the sample")]
    BadSample {
        /// What the samples are.
        name: String,
        /// Which one it is, one row after the other.
        place: usize,
        /// The value as given.
        given: f64,
    },
    /// Two parameters in the wrong order.
    #[error(
        "{lesser} = {} must {relation} {greater} = {}; change one of them",
        Shown(*lesser_value), Shown(*greater_value)
    )]
    Order {
        /// Name of the parameter that must be the lesser.
        lesser: String,
        /// Its value.
        lesser_value: f64,
        /// "stay below" or "not exceed".
        relation: &'static str,
        /// Name of the other parameter.
        greater: String,
        /// Its value.
        greater_value: f64,
    },
    /// A step that is far too long for the machine.
    #[error(
        "dt = {} s is too long for this machine; give at most {longest:.2e} s, or check the \
         units of inertia and stiffness",
        Shown(*given)
    )]
    TooLong {
        /// The step as given.
        given: f64,
        /// The longest allowed.
        longest: f64,
    },
    /// A motion that is none any more.
    #[error(
        "the motion ran away: {what} = {value} after {duration} s; give a smaller input, load or dt, or \
         check units and inertia; the motor is left as it was",
        duration = Shown(*.duration)
    )]
    RanAway {
        /// Which number is none.
        what: &'static str,
        /// What it is.
        value: f64,
        /// How long it took.
        duration: f64,
    },
    /// The same in what nobody asked for.
    #[error(
        "the motion ran away, which the outputs asked for do not show; ask for position too, give smaller \
         inputs or dt, or check units and inertia; the motor is left as it was"
    )]
    RanUnseen,
    /// A place where efforts are none.
    #[error(
        "at position = {} the effort on the body is no number; give a position nearer to those of this \
         motor",
        Shown(*position)
    )]
    Nowhere {
        /// The place as given.
        position: f64,
    },
    /// Friction that is no number although everything given was.
    #[error(
        "friction of '{law}' left the range of floats: its parameters lie too far apart for this motion; \
         give values nearer to the typical ones that `stiction laws {law}` shows, or a shorter dt"
    )]
    OutOfRange {
        /// Name of the law.
        law: &'static str,
    },
    /// Whoever called wants no answer any more.
    #[error("the call was interrupted; the machine is as it was before it")]
    Interrupted,
    /// More work than a call of so many samples may make.
    #[error(
        "the run takes more work than {most:.2e} inner steps, which are allowed for a call of that \
         many samples: {why}; give {remedy}a shorter dt, or fewer samples a call"
    )]
    TooMuchWork {
        /// How many a call may take.
        most: f64,
        /// What takes them.
        why: &'static str,
        /// What to change, with a comma behind it; empty where nobody looked.
        remedy: String,
    },
    /// The same of segments.
    #[error(
        "segments take more work than {most:.2e} inner steps until {} s: {why}; ask for more rows with \
         times, which allow some more, give {remedy}a larger tolerance, or run shorter segments",
        Shown(*time)
    )]
    TooManySteps {
        /// How many a call may take.
        most: f64,
        /// What takes them.
        why: &'static str,
        /// Until when it would have taken more.
        time: f64,
        /// What to change, with a comma behind it; empty where nobody looked.
        remedy: String,
    },
    /// A state that does not fit the law.
    #[error("state entry '{name}' {problem}; give a state that the same law returned")]
    State {
        /// Entry of the state.
        name: String,
        /// What is wrong with it.
        problem: String,
    },
    /// A gain stated where every gain is 0.
    #[error(
        "{gain} = {} of effect {effect} is a gain, and signatures are taken at the gain 0; \
         allowed is {shapes}; leave {gain} out",
        Shown(*given)
    )]
    Gain {
        /// The effect.
        effect: String,
        /// Name of its gain.
        gain: String,
        /// The value as given.
        given: f64,
        /// Its parameters that are no gains.
        shapes: String,
    },
    /// An effect of a machine where a contact alone is asked for.
    #[error(
        "effect {effect} enters at the {place} of a machine, which a friction model alone has not; leave \
         it out here, or give it to a motor"
    )]
    NotAtContact {
        /// The effect.
        effect: &'static str,
        /// Where it enters.
        place: &'static str,
    },
    /// An effect stated twice.
    #[error("effect {effect} is stated twice; state it once, with the parameters of both")]
    Twice {
        /// The effect.
        effect: &'static str,
    },
    /// A derivative by a start value where the start is not given.
    #[error("parameter path '{path}' needs a start; give start, for instance {{'force': 0.0}}")]
    NoStart {
        /// The path as given.
        path: String,
    },
    /// A kernel whose parts do not belong together.
    #[error(
        "weights do not fit; give an odd number of them, two more for the second \
         derivative, and a spacing of 1 or more"
    )]
    Kernel,
    /// One of many machines that cannot be run.
    #[error("member {member}: {problem}")]
    Member {
        /// Its number, from 0.
        member: usize,
        /// What the matter is, as a sentence.
        problem: String,
    },
    /// Array lengths that do not fit.
    #[error("{name} has {given} values where {wanted} are needed; give one value a sample")]
    Length {
        /// The array.
        name: String,
        /// Its length.
        given: usize,
        /// The needed length.
        wanted: usize,
    },
}

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// Where this is too much work for a part of a call: for all of it, as much as is allowed.
    pub(crate) fn of_all(mut self, allowed: f64) -> Self {
        if let Self::TooMuchWork { most, .. } = &mut self {
            *most = allowed;
        }
        self
    }

    /// Where this is too much work: of segments, by that time.
    pub(crate) fn until(self, time: f64) -> Self {
        match self {
            Self::TooMuchWork { most, why, remedy } => {
                Self::TooManySteps { most, why, time, remedy }
            }
            other => other,
        }
    }

    /// An unknown name with the nearest known one suggested.
    pub fn unknown<'a>(
        kind: impl Into<String>,
        given: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let known: Vec<&str> = known.into_iter().collect();
        let near = known
            .iter()
            .map(|name| (edit_distance(given, name), *name))
            .filter(|(distance, name)| *distance <= 1 + name.len() / 4)
            .min()
            .map_or(String::new(), |(_, name)| format!(" (did you mean '{name}'?)"));
        Self::UnknownName {
            kind: kind.into(),
            given: given.to_owned(),
            near,
            known: if known.is_empty() { "none".to_owned() } else { known.join(", ") },
        }
    }
}

fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let substitute = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = substitute.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_never_fills_a_line() {
        for (number, shown) in [(0.25, "0.25"), (-1e300, "-1e300"), (3.5e-200, "3.5e-200")] {
            assert_eq!(Shown(number).to_string(), shown);
        }
        let third = Shown(1.0 / 3.0).to_string();
        assert_eq!(third.parse::<f64>().unwrap(), 1.0 / 3.0);
        assert_eq!(Shown(f64::NAN).to_string(), "NaN");
    }

    #[test]
    fn a_near_miss_is_suggested() {
        let error = Error::unknown("law", "hseih_pan", ["coulomb", "hsieh_pan"]);
        assert!(error.to_string().contains("did you mean 'hsieh_pan'"), "{error}");
        let error = Error::unknown("law", "zzz", ["coulomb", "hsieh_pan"]);
        assert!(!error.to_string().contains("did you mean"), "{error}");
    }
}
