//! What changes from sample to sample, and what acts on a motor beside its input.

use crate::support::error::{Error, Result};

/// What acts on a machine beside its input.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a> {
    /// External effort, positive along +x.
    pub load: PerSample<'a>,
    /// What the gear transmits, where that is known and is not the load: friction sees it.
    pub transmitted: Option<PerSample<'a>>,
    /// Temperature in °C, where it is known.
    pub temperature: Option<PerSample<'a>>,
    /// Whether the drive is on, 0 where it is not; always on without it.
    pub enabled: Option<PerSample<'a>>,
}

impl Surroundings<'_> {
    /// No load, a temperature that nobody knows, and a drive that is on.
    pub const NONE: Self =
        Self { load: PerSample::Same(0.0), transmitted: None, temperature: None, enabled: None };

    /// Whether the drive is on in a sample.
    #[inline]
    pub fn enabled_at(&self, k: usize) -> bool {
        self.enabled.is_none_or(|each| each.at(k) != 0.0)
    }

    /// Whether the drive is always on, and temperature and transmitted effort are always the same.
    pub(crate) fn is_steady(&self) -> bool {
        let changes = |each| matches!(each, Some(PerSample::Each(_)));
        self.enabled.is_none() && !changes(self.temperature) && !changes(self.transmitted)
    }

    /// The temperature at a sample.
    #[inline]
    pub fn temperature_at(&self, k: usize) -> Option<f64> {
        self.temperature.map(|each| each.at(k))
    }

    /// The transmitted effort at a sample.
    #[inline]
    pub fn transmitted_at(&self, k: usize) -> Option<f64> {
        self.transmitted.map(|each| each.at(k))
    }

    /// Those from one sample to before another.
    pub fn between(&self, from: usize, to: usize) -> Self {
        Self {
            load: self.load.between(from, to),
            transmitted: self.transmitted.map(|each| each.between(from, to)),
            temperature: self.temperature.map(|each| each.between(from, to)),
            enabled: self.enabled.map(|each| each.between(from, to)),
        }
    }

    /// Refuses numbers that are not as many as the samples.
    pub fn check(&self, wanted: usize) -> Result<()> {
        self.load.check("load", wanted)?;
        let others = [
            ("transmitted", self.transmitted),
            ("temperature", self.temperature),
            ("enabled", self.enabled),
        ];
        for (name, each) in others {
            each.map_or(Ok(()), |each| each.check(name, wanted))?;
        }
        Ok(())
    }
}

impl<'a> From<PerSample<'a>> for Surroundings<'a> {
    fn from(load: PerSample<'a>) -> Self {
        Self { load, ..Surroundings::NONE }
    }
}

/// A number for every sample, or one for all.
#[derive(Debug, Clone, Copy)]
pub enum PerSample<'a> {
    /// The same for all.
    Same(f64),
    /// One each.
    Each(&'a [f64]),
}

impl PerSample<'_> {
    /// The number at a sample.
    #[inline]
    pub fn at(&self, k: usize) -> f64 {
        match self {
            Self::Same(value) => *value,
            Self::Each(values) => values[k],
        }
    }

    /// The greatest of them, at least 0.
    pub fn greatest(&self) -> f64 {
        match self {
            Self::Same(value) => value.max(0.0),
            Self::Each(values) => values.iter().copied().fold(0.0, f64::max),
        }
    }

    /// Refuses numbers that are not as many as the samples.
    pub fn check(&self, name: &str, wanted: usize) -> Result<()> {
        match self {
            Self::Each(values) if values.len() != wanted => {
                Err(Error::Length { name: name.to_owned(), given: values.len(), wanted })
            }
            Self::Same(_) | Self::Each(_) => Ok(()),
        }
    }

    /// The sample from which on the number is another one, at most `end`.
    pub(crate) fn same_until(&self, from: usize, end: usize) -> usize {
        match self {
            Self::Same(_) => end,
            Self::Each(values) => {
                let now = values[from];
                let other = values[from..end].iter().position(|value| *value != now);
                other.map_or(end, |after| from + after)
            }
        }
    }

    /// The numbers from one sample to before another.
    pub fn between(&self, from: usize, to: usize) -> Self {
        match self {
            Self::Same(value) => Self::Same(*value),
            Self::Each(values) => Self::Each(&values[from..to]),
        }
    }
}
