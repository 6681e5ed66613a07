//! States as flat arrays of doubles, and single numbers by name.

use stiction_core::friction::Entry;

use crate::boundary::Problem;

/// How many doubles the entries take: one a number; a count and two a row for a list.
pub(crate) fn length(entries: &[(impl AsRef<str>, Entry)]) -> usize {
    let each = entries.iter().map(|(_, entry)| match entry {
        Entry::Number(_) => 1,
        Entry::Pairs(rows) => 1 + 2 * rows.len(),
    });
    each.sum()
}

/// Copies the entries into an array with room for `room` doubles.
///
/// # Safety
/// `values` is NULL or has that room.
pub(crate) unsafe fn copy(
    entries: &[(impl AsRef<str>, Entry)],
    values: *mut f64,
    room: usize,
) -> Result<(), Problem> {
    let needed = length(entries);
    if values.is_null() {
        return Err(Problem::Null("values"));
    }
    if room < needed {
        let problem = format!("room = {room} is less than the {needed} doubles of the state");
        return Err(Problem::Refused(problem));
    }
    let mut at = values;
    write(entries, |value| {
        // SAFETY: `needed` doubles are written, and there is room for as many.
        unsafe {
            at.write(value);
            at = at.add(1);
        }
    });
    Ok(())
}

fn write(entries: &[(impl AsRef<str>, Entry)], mut target: impl FnMut(f64)) {
    for (_, entry) in entries {
        match entry {
            Entry::Number(x) => target(*x),
            Entry::Pairs(rows) => {
                target(rows.len() as f64);
                rows.as_flattened().iter().copied().for_each(&mut target);
            }
        }
    }
}

/// Entries of the names and kinds of `like` with the values of an array.
pub(crate) fn read(
    like: &[(impl AsRef<str>, Entry)],
    values: &[f64],
) -> Result<Vec<(String, Entry)>, Problem> {
    let mut left = values.iter().copied();
    let short = || Problem::Refused("the state is too short for this law".to_owned());
    let mut entries = Vec::with_capacity(like.len());
    for (name, kind) in like {
        let name = name.as_ref();
        let first = left.next().ok_or_else(short)?;
        let entry = match kind {
            Entry::Number(_) => Entry::Number(first),
            Entry::Pairs(_) => {
                if first < 0.0 || first.fract() != 0.0 || first > values.len() as f64 {
                    return Err(Problem::Refused(format!("the state has {first} rows of {name}")));
                }
                let rows = (0..first as usize)
                    .map(|_| Ok([left.next().ok_or_else(short)?, left.next().ok_or_else(short)?]));
                Entry::Pairs(rows.collect::<Result<_, Problem>>()?)
            }
        };
        entries.push((name.to_owned(), entry));
    }
    if left.next().is_some() {
        return Err(Problem::Refused("the state is too long for this law".to_owned()));
    }
    Ok(entries)
}

/// A number by its name.
pub(crate) fn number(entries: &[(impl AsRef<str>, Entry)], name: &str) -> Result<f64, Problem> {
    let found = entries.iter().find_map(|(known, entry)| match entry {
        Entry::Number(x) if known.as_ref() == name => Some(*x),
        Entry::Number(_) | Entry::Pairs(_) => None,
    });
    found.ok_or_else(|| {
        let numbers = entries.iter().filter(|(_, entry)| matches!(entry, Entry::Number(_)));
        let known: Vec<&str> = numbers.map(|(known, _)| known.as_ref()).collect();
        Problem::Refused(format!("state '{name}' is unknown; known: {}", known.join(", ")))
    })
}
