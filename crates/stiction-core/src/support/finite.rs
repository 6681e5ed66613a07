//! Whether numbers are finite, looked up as fast as they can be read.

use stiction_dispatch::{Task, Width, fetch};

use crate::support::error::{Error, Result};

/// Refuses samples of which one is not finite, by the first of them.
pub fn check(name: &str, values: &[f64]) -> Result<()> {
    if Width::widest().run(Finite(values)) {
        return Ok(());
    }
    let bad = values.iter().position(|x| !x.is_finite()).unwrap_or_default();
    Err(Error::BadSample { name: name.to_owned(), place: bad, given: values[bad] })
}

/// Whether all numbers are finite.
struct Finite<'a>(&'a [f64]);

impl Task for Finite<'_> {
    type Output = bool;

    // By chunks without a choice in them, which become vectors; what lies a page ahead is asked for,
    // for a processor guesses no further than to the end of one.
    #[inline(always)]
    fn run(self) -> bool {
        let all = |some: &[f64]| some.iter().fold(true, |all, x| all & x.is_finite());
        let (chunks, rest) = self.0.as_chunks::<64>();
        for (k, chunk) in chunks.iter().enumerate() {
            for ahead in chunks.get(k + 8).map_or(&[][..], |ahead| ahead).chunks_exact(8) {
                fetch(&ahead[0]);
            }
            if !all(chunk) {
                return false;
            }
        }
        all(rest)
    }
}
