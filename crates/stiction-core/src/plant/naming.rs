//! What the entries of a state are called where a law is not alone.
//!
//! A law names its states as it likes, and so may a body: where both have one of a name, that of the law
//! is called `friction.name` beside a body. No name of either has a dot of its own, so that no two entries
//! can ever be called alike.

use std::borrow::Cow;

use super::drive::Way;
use super::effects::Effects;
use super::run::Run;
use crate::friction::Entry;
use crate::support::error::Error;

/// Before the name of a law's state that is also one of a motor's own.
pub(crate) const QUALIFIED: &str = "friction.";

/// Names of the columns of a trajectory that are no states of a law.
pub(crate) const COLUMNS: [&str; 4] = ["position", "velocity", "friction", "measured"];

/// A number that a body carries from sample to sample.
pub(crate) type Place = fn(&mut Run<f64>) -> &mut f64;

/// All of them, by name.
pub(crate) const BODY: [(&str, Place); 10] = [
    ("position", |run| &mut run.position),
    ("velocity", |run| &mut run.velocity),
    ("time", |run| &mut run.time),
    ("path", |run| &mut run.path),
    ("friction", |run| &mut run.friction),
    ("second_position", |run| &mut run.second_position),
    ("second_velocity", |run| &mut run.second_velocity),
    ("relaxed", |run| &mut run.relaxed),
    ("wound", |run| &mut run.wound),
    // As it was, not recomputed: it belongs to the end of the last step, to the bit.
    ("ambient", Run::ambient_mut),
];

/// What a contact beside effects has taken in, and the greatest kinetic energy so far.
pub(crate) const BUDGET: [&str; 2] = ["contact_work", "kinetic_peak"];

/// Whether a motor of any law, with any effects, calls something of its own so.
pub(crate) fn is_own(name: &str) -> bool {
    COLUMNS.contains(&name)
        || BODY.iter().any(|(own, _)| *own == name)
        || BUDGET.contains(&name)
        || Way::<f64>::NAMES.contains(&name)
        || name == Effects::<f64>::ENTRY
}

/// What a state of a law is called beside a body.
pub(crate) fn qualified(name: &'static str) -> Cow<'static, str> {
    if is_own(name) { Cow::Owned(format!("{QUALIFIED}{name}")) } else { Cow::Borrowed(name) }
}

/// What the law calls what is called so beside a body; none where that is the body's own.
pub(crate) fn of_the_law(name: &str) -> Option<&str> {
    match name.strip_prefix(QUALIFIED) {
        Some(bare) if is_own(bare) => Some(bare),
        _ => (!is_own(name)).then_some(name),
    }
}

/// Entries of the body, and those of the law as the law calls them.
pub(crate) fn parted(entries: &[(String, Entry)]) -> [Vec<(String, Entry)>; 2] {
    let (mut own, mut law) = (Vec::new(), Vec::new());
    for (name, entry) in entries {
        match of_the_law(name) {
            None => own.push((name.clone(), entry.clone())),
            Some(bare) => law.push((bare.to_owned(), entry.clone())),
        }
    }
    [own, law]
}

/// An error about a state of a law, which is called as it is beside a body.
pub(crate) fn blamed(error: Error) -> Error {
    match error {
        Error::State { name, problem } if is_own(&name) => {
            Error::State { name: format!("{QUALIFIED}{name}"), problem }
        }
        other => other,
    }
}
