//! What a trajectory shows.

use std::borrow::Cow;
use std::ops::Range;

use crate::friction::{LawSpec, LawState};
use crate::integrate::{Places, Seen};
use crate::math::scalar::Scalar;
use crate::plant::naming::{COLUMNS, of_the_law, qualified};
use crate::plant::{Machine, Run};
use crate::support::error::{Error, Result};

/// What a trajectory can show beside the law's own states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Column {
    /// Position.
    Position,
    /// Velocity.
    Velocity,
    /// Friction.
    Friction,
    /// What the sensor reads.
    Measured,
    /// A state of the law, by its index.
    Law(usize),
}

impl Column {
    /// Those that are no states of the law, in the order of their names.
    const OWN: [Self; COLUMNS.len()] =
        [Self::Position, Self::Velocity, Self::Friction, Self::Measured];

    /// Names of the columns of a motor with this law, in the order of a trajectory.
    pub fn names(law: &LawSpec) -> Vec<Cow<'static, str>> {
        let law = law.record.outputs.iter().copied().map(qualified);
        COLUMNS.into_iter().map(Cow::Borrowed).chain(law).collect()
    }

    /// The column called `name`.
    pub fn named(law: &LawSpec, name: &str) -> Result<Self> {
        let own = COLUMNS.iter().position(|own| *own == name).map(|index| Self::OWN[index]);
        let index = || {
            let bare = of_the_law(name)?;
            law.record.outputs.iter().position(|known| *known == bare).map(Self::Law)
        };
        own.or_else(index).ok_or_else(|| {
            let names = Self::names(law);
            Error::unknown("output", name, names.iter().map(|known| &**known))
        })
    }

    /// What it shows of a motor after a sample.
    #[inline]
    pub fn read(
        self,
        run: &Run<f64>,
        machine: &Machine<f64>,
        output: &dyn Fn(usize) -> f64,
    ) -> f64 {
        match self {
            Self::Position => run.position,
            Self::Velocity => run.velocity,
            Self::Friction => run.friction,
            Self::Measured => machine.measured(run.position),
            Self::Law(index) => output(index),
        }
    }
}

/// Who sees body, machine and states of the law after each sample.
pub(crate) trait Rows<S: Scalar> {
    /// Whether states of the law are looked at.
    fn looks(&self) -> bool;
    /// Sees samples during which nothing changes but friction, where it can see them at once.
    fn still(
        &mut self,
        _samples: Range<usize>,
        _run: &Run<S>,
        _friction: impl Fn(usize) -> S,
    ) -> bool {
        false
    }
    /// The places of these samples, where position and velocity are all that is looked at.
    fn places(&mut self, _samples: Range<usize>) -> Option<Places<'_, S>> {
        None
    }
    /// Sees a sample.
    fn see(
        &mut self,
        sample: usize,
        run: &Run<S>,
        machine: &Machine<S>,
        output: impl Fn(usize) -> S,
    );
}

/// Who knows the machine that a row of plain steps is of.
pub(super) trait OfMachine<S: Scalar> {
    fn machine(&self) -> &Machine<S>;
}

/// A function that is told.
pub(super) struct Told<F>(pub(super) F);

impl<S: Scalar, F> Rows<S> for Told<F>
where
    F: FnMut(usize, &Run<S>, &Machine<S>, &dyn Fn(usize) -> S),
{
    #[inline(always)]
    fn looks(&self) -> bool {
        true
    }

    #[inline(always)]
    fn see(
        &mut self,
        sample: usize,
        run: &Run<S>,
        machine: &Machine<S>,
        output: impl Fn(usize) -> S,
    ) {
        (self.0)(sample, run, machine, &output);
    }
}

/// The columns that a trajectory shows; empty where one is not wanted.
pub(super) struct Columns<'a, 'b> {
    position: &'a mut [f64],
    velocity: &'a mut [f64],
    friction: &'a mut [f64],
    measured: &'a mut [f64],
    others: &'a mut [(Column, &'b mut [f64])],
}

impl<'a, 'b> Columns<'a, 'b> {
    /// These columns, those of the body first, so that they need no looking up.
    pub(super) fn new(columns: &'a mut [(Column, &'b mut [f64])]) -> Self {
        let rank = |column: Column| match column {
            Column::Position => 0,
            Column::Velocity => 1,
            Column::Friction => 2,
            Column::Measured => 3,
            Column::Law(_) => 4,
        };
        columns.sort_unstable_by_key(|(column, _)| rank(*column));
        let (position, columns) = taken(columns, Column::Position);
        let (velocity, columns) = taken(columns, Column::Velocity);
        let (friction, columns) = taken(columns, Column::Friction);
        let (measured, others) = taken(columns, Column::Measured);
        Self { position, velocity, friction, measured, others }
    }
}

/// The first column where it is this one, else nothing, and the rest.
fn taken<'a, 'b>(
    columns: &'a mut [(Column, &'b mut [f64])],
    wanted: Column,
) -> (&'a mut [f64], &'a mut [(Column, &'b mut [f64])]) {
    if columns.first().is_none_or(|(column, _)| *column != wanted) {
        return (&mut [], columns);
    }
    let (first, rest) = columns.split_at_mut(1);
    (&mut *first[0].1, rest)
}

impl Rows<f64> for Columns<'_, '_> {
    #[inline(always)]
    fn looks(&self) -> bool {
        self.others.iter().any(|(column, _)| matches!(column, Column::Law(_)))
    }

    #[inline(always)]
    fn still(
        &mut self,
        samples: Range<usize>,
        run: &Run<f64>,
        friction: impl Fn(usize) -> f64,
    ) -> bool {
        if !self.others.is_empty() || !self.measured.is_empty() {
            return false;
        }
        if let Some(values) = self.position.get_mut(samples.clone()) {
            values.fill(run.position);
        }
        if let Some(values) = self.velocity.get_mut(samples.clone()) {
            values.fill(run.velocity);
        }
        if let Some(values) = self.friction.get_mut(samples.clone()) {
            values.iter_mut().zip(samples).for_each(|(value, k)| *value = friction(k));
        }
        true
    }

    #[inline(always)]
    fn places(&mut self, samples: Range<usize>) -> Option<Places<'_, f64>> {
        let others = !self.others.is_empty() || !self.measured.is_empty();
        if others || !self.friction.is_empty() {
            return None;
        }
        let first = samples.start;
        let position = self.position.get_mut(samples.clone())?;
        Some(Places { first, position, velocity: self.velocity.get_mut(samples)? })
    }

    #[inline(always)] // where it is called, the motion is in registers
    fn see(
        &mut self,
        sample: usize,
        run: &Run<f64>,
        machine: &Machine<f64>,
        output: impl Fn(usize) -> f64,
    ) {
        if let Some(place) = self.position.get_mut(sample) {
            *place = run.position;
        }
        if let Some(place) = self.velocity.get_mut(sample) {
            *place = run.velocity;
        }
        if let Some(place) = self.friction.get_mut(sample) {
            *place = run.friction;
        }
        if let Some(place) = self.measured.get_mut(sample) {
            *place = read(machine, run.position);
        }
        for (column, values) in self.others.iter_mut() {
            values[sample] = match column {
                Column::Law(index) => output(*index),
                // Asked for twice.
                Column::Position => run.position,
                Column::Velocity => run.velocity,
                Column::Friction => run.friction,
                Column::Measured => read(machine, run.position),
            };
        }
    }
}

/// What the sensor reads. A cold call, for the sine of an eccentric encoder would take the registers of
/// the loop that asks.
#[cold]
#[inline(never)]
fn read(machine: &Machine<f64>, position: f64) -> f64 {
    machine.measured(position)
}

/// Shows the samples of a glide.
pub(super) struct Showing<'a, R>(pub(super) &'a mut R);

impl<S, T, E, R> Seen<S, T, E> for Showing<'_, R>
where
    S: Scalar,
    T: LawState<S>,
    E: OfMachine<S>,
    R: Rows<S>,
{
    #[inline(always)]
    fn looks(&self) -> bool {
        self.0.looks()
    }

    #[inline(always)]
    fn still(
        &mut self,
        samples: Range<usize>,
        run: &Run<S>,
        friction: impl Fn(usize) -> S,
    ) -> bool {
        self.0.still(samples, run, friction)
    }

    #[inline(always)]
    fn see(&mut self, sample: usize, run: &Run<S>, contact: &T, efforts: &E) {
        self.0.see(sample, run, efforts.machine(), |column| contact.output(column));
    }
}
