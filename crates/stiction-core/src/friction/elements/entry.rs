//! Entries of a law's state, and how they are read back.

use crate::support::error::{Error, Result};

/// One entry of a law's state, as users read and write it.
#[derive(Debug, Clone, PartialEq)]
pub enum Entry {
    /// A number.
    Number(f64),
    /// Rows of two numbers.
    Pairs(Vec<[f64; 2]>),
}

impl std::fmt::Display for Entry {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(x) => write!(formatter, "{x}"),
            Self::Pairs(rows) => write!(formatter, "an array of shape ({}, 2)", rows.len()),
        }
    }
}

/// Takes the entries of a state one by one and complains about missing or surplus ones.
#[derive(Debug)]
pub struct EntryReader<'a> {
    entries: &'a [(String, Entry)],
    used: Vec<bool>,
}

impl<'a> EntryReader<'a> {
    /// Reads from these entries.
    pub fn new(entries: &'a [(String, Entry)]) -> Self {
        Self { entries, used: vec![false; entries.len()] }
    }

    fn take(&mut self, name: &str) -> Result<&'a Entry> {
        let found = self.entries.iter().position(|(n, _)| n == name);
        found.map_or_else(
            || Err(Error::State { name: name.to_owned(), problem: "is missing".to_owned() }),
            |index| {
                self.used[index] = true;
                Ok(&self.entries[index].1)
            },
        )
    }

    /// A finite number (or an infinite one where `infinite` allows it).
    pub fn number(&mut self, name: &str, infinite: bool) -> Result<f64> {
        match self.take(name)? {
            Entry::Number(x) if x.is_finite() || (infinite && !x.is_nan()) => Ok(*x),
            other => Err(Error::State {
                name: name.to_owned(),
                problem: format!("is {other}, not a finite number"),
            }),
        }
    }

    /// A finite number from 0 on.
    pub fn at_least_zero(&mut self, name: &str) -> Result<f64> {
        let x = self.number(name, false)?;
        if x < 0.0 {
            return Err(Error::State {
                name: name.to_owned(),
                problem: format!("is {x}, not a number from 0"),
            });
        }
        Ok(x)
    }

    /// A count.
    pub fn count(&mut self, name: &str) -> Result<u64> {
        let x = self.number(name, false)?;
        // Counters fit the integers that a float holds exactly.
        if x < 0.0 || x.fract() != 0.0 || x > 9.007e15 {
            return Err(Error::State {
                name: name.to_owned(),
                problem: format!("is {x}, not a whole number from 0"),
            });
        }
        Ok(x as u64)
    }

    /// A number out of a few allowed ones.
    pub fn choice(&mut self, name: &str, allowed: &[f64]) -> Result<f64> {
        let x = self.number(name, false)?;
        if !allowed.contains(&x) {
            return Err(Error::State {
                name: name.to_owned(),
                problem: format!("is {x}, allowed are {allowed:?}"),
            });
        }
        Ok(x)
    }

    /// Rows of two finite numbers.
    pub fn pairs(&mut self, name: &str) -> Result<&'a [[f64; 2]]> {
        match self.take(name)? {
            Entry::Pairs(rows) if rows.iter().flatten().all(|x| x.is_finite()) => Ok(rows),
            _ => Err(Error::State {
                name: name.to_owned(),
                problem: "is not an array of shape (n, 2) of finite numbers".to_owned(),
            }),
        }
    }

    /// Refuses entries that nobody asked for.
    pub fn finish(self) -> Result<()> {
        match self.used.iter().position(|used| !used) {
            Some(index) => Err(Error::State {
                name: self.entries[index].0.clone(),
                problem: "is not part of this law's state".to_owned(),
            }),
            None => Ok(()),
        }
    }
}
