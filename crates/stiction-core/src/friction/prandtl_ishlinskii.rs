//! Stops in parallel whose thresholds and weights follow a density: Prandtl and Ishlinskii.

use super::elements::stop::Stop;
use super::{
    Channels, Entry, EntryReader, Event, FrictionLaw, LawState, Motion, Outcome, Rest, Statistics,
};
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::error::{Error, Result};
use crate::support::parameter::ParameterSpec;

/// Operators of [`PrandtlIshlinskii`].
pub const OPERATORS: usize = 10;

parameters! {
    /// Parameters of [`PrandtlIshlinskii`].
    pub struct PrandtlIshlinskiiParameters {
        coulomb: Effort, "friction once every operator is at its threshold, F_c",
            default Value(0.35), neutral None, typical 0.35, bounds 1e-12, 1e9;
        initial_stiffness: Stiffness, "slope right after a reversal, k_0",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        density_decay: One, "how fast the density falls towards the greatest threshold, τ: e^(−τ) of its first value is left there",
            default Value(3.0), neutral None, typical 3.0, bounds -10.0, 30.0;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

/// Ten stops of evenly spaced thresholds, weighted by an exponential density.
///
/// F = L·Σ_j w_j·E_{r_j}[x] + F_v·v,  E_r[x] = x − P_r[x], P_r the play of half-width r
///
/// r_j = R·(j + 1/2)/10, j = 0 … 9;  w_j ∝ e^(−τ·(j + 1/2)/10);  Σ w_j = k_0, Σ w_j·r_j = F_c
///
/// At v = 0 the force stays where it is. Memory: the stretches, which hold reverse points as far as
/// ten numbers can. Passive. Piecewise linear: its kinks are those of the thresholds.
/// Source: Krasnosel'skii, Pokrovskii, Systems with Hysteresis (1989); Brokate, Sprekels, Hysteresis
/// and Phase Transitions (1996); exponential density: Al Janaideh, Rakheja, Su (2009). From memory.
#[derive(Debug, Clone)]
pub struct PrandtlIshlinskii<S> {
    parameters: PrandtlIshlinskiiParameters<S>,
    thresholds: [S; OPERATORS],
    weights: [S; OPERATORS],
}

/// State of [`PrandtlIshlinskii`].
#[derive(Debug, Clone, Copy)]
pub struct PrandtlIshlinskiiState<S> {
    stops: [Stop<S>; OPERATORS],
    /// At level 1, without its viscous part.
    dry: S,
    statistics: Statistics,
}

/// A step of [`PrandtlIshlinskii`].
#[derive(Debug, Clone, Copy)]
pub struct PrandtlIshlinskiiTrial<S> {
    stops: [Stop<S>; OPERATORS],
    dry: S,
    outcome: Outcome<S>,
}

impl<S: Scalar> PrandtlIshlinskiiState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> PrandtlIshlinskiiState<T> {
        PrandtlIshlinskiiState {
            stops: self.stops.map(|stop| stop.map(&convert)),
            dry: convert(self.dry),
            statistics: self.statistics,
        }
    }
}

impl<S: Scalar> LawState<S> for PrandtlIshlinskiiState<S> {
    const OUTPUTS: &'static [&'static str] = &["dry_friction"];

    fn output(&self, _index: usize) -> S {
        self.dry
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        let rows = self.stops.iter().map(|stop| [stop.stretch.re(), stop.mode]).collect();
        vec![
            ("stops", Entry::Pairs(rows)),
            ("dry_friction", Entry::Number(self.dry.re())),
            ("breakaways", Entry::Number(self.statistics.breakaways as f64)),
            ("sticks", Entry::Number(self.statistics.sticks as f64)),
        ]
    }

    fn statistics(&self) -> Statistics {
        self.statistics
    }
}

impl<S: Scalar> PrandtlIshlinskii<S> {
    /// Counts the slides that begin and end between two sets of stops.
    #[inline]
    fn count(before: &PrandtlIshlinskiiState<S>, after: &[Stop<S>; OPERATORS]) -> Statistics {
        let mut statistics = before.statistics;
        for (old, new) in before.stops.iter().zip(after) {
            if old.mode != new.mode {
                statistics.sticks += u64::from(old.mode != 0.0);
                statistics.breakaways += u64::from(new.mode != 0.0);
            }
        }
        statistics
    }
}

impl<S: Scalar> FrictionLaw<S> for PrandtlIshlinskii<S> {
    type State = PrandtlIshlinskiiState<S>;
    type Trial = PrandtlIshlinskiiTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = PrandtlIshlinskiiParameters::<f64>::SPECS;
    const REMEMBERS: bool = true;
    const SUMMARY: &'static str =
        "ten stops in parallel, weighted by a density of their thresholds";
    const SOURCE: &'static str =
        "Krasnosel'skii, Pokrovskii (1989); Al Janaideh, Rakheja, Su (2009); from memory";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let p = PrandtlIshlinskiiParameters::from_values(values);
        let place = |j: usize| (j as f64 + 0.5) / OPERATORS as f64;
        let density: [S; OPERATORS] =
            std::array::from_fn(|j| (-(p.density_decay * place(j))).exp());
        let (mut sum, mut moment) = (S::constant(0.0), S::constant(0.0));
        for (j, share) in density.iter().enumerate() {
            sum += *share;
            moment += *share * place(j);
        }
        let widest = p.coulomb / p.initial_stiffness * sum / moment;
        Self {
            parameters: p,
            thresholds: std::array::from_fn(|j| widest * place(j)),
            weights: std::array::from_fn(|j| p.initial_stiffness * density[j] / sum),
        }
    }

    fn initial(&self) -> PrandtlIshlinskiiState<S> {
        PrandtlIshlinskiiState {
            stops: [Stop::relaxed(); OPERATORS],
            dry: S::constant(0.0),
            statistics: Statistics::default(),
        }
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<PrandtlIshlinskiiState<S>> {
        let mut read = EntryReader::new(entries);
        let rows = read.pairs("stops")?;
        let mut state = self.initial();
        let good = |row: &[f64; 2], limit: &S| {
            row[0].abs() <= limit.re() && [-1.0, 0.0, 1.0].contains(&row[1])
        };
        if rows.len() != OPERATORS
            || !rows.iter().zip(&self.thresholds).all(|(row, limit)| good(row, limit))
        {
            return Err(Error::State {
                name: "stops".to_owned(),
                problem: "does not hold ten rows of a stretch within its threshold and -1, 0 or 1"
                    .to_owned(),
            });
        }
        for (stop, row) in state.stops.iter_mut().zip(rows) {
            *stop = Stop { stretch: S::constant(row[0]), mode: row[1] };
        }
        state.dry = S::constant(read.number("dry_friction", false)?);
        state.statistics.breakaways = read.count("breakaways")?;
        state.statistics.sticks = read.count("sticks")?;
        read.finish()?;
        Ok(state)
    }

    fn sliding_force(&self) -> S {
        self.parameters.coulomb
    }

    fn greatest_stiffness(&self) -> f64 {
        self.parameters.initial_stiffness.re()
    }

    fn greatest_damping(&self) -> f64 {
        self.parameters.viscous.re()
    }

    #[inline]
    fn force(&self, state: &PrandtlIshlinskiiState<S>, velocity: S, channels: &Channels<S>) -> S {
        state.dry * channels.level + self.parameters.viscous * channels.viscous_level * velocity
    }

    #[inline]
    fn advance(
        &self,
        state: &PrandtlIshlinskiiState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> PrandtlIshlinskiiTrial<S> {
        let (mut dry, mut stiffness) = (S::constant(0.0), S::constant(0.0));
        let mut stops = state.stops;
        for ((stop, limit), weight) in stops.iter_mut().zip(&self.thresholds).zip(&self.weights) {
            let (moved, follows) = stop.moved(*limit, motion.displacement);
            *stop = moved;
            dry += *weight * moved.stretch;
            if follows {
                stiffness += *weight;
            }
        }
        let damping = self.parameters.viscous * channels.viscous_level;
        let outcome = Outcome {
            force: dry * channels.level + damping * motion.velocity,
            slope: stiffness * channels.level * motion.duration + damping,
            damping,
        };
        PrandtlIshlinskiiTrial { stops, dry, outcome }
    }

    #[inline]
    fn outcome(&self, trial: &PrandtlIshlinskiiTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    // Where the body stays, so does the force.
    fn rest(
        &self,
        state: &PrandtlIshlinskiiState<S>,
        channels: &Channels<S>,
        duration: S,
    ) -> Option<Rest<S, PrandtlIshlinskiiTrial<S>>> {
        Some(Rest::still(self, state, channels, duration))
    }

    #[inline]
    fn commit(&self, state: &mut PrandtlIshlinskiiState<S>, trial: &PrandtlIshlinskiiTrial<S>) {
        state.statistics = Self::count(state, &trial.stops);
        state.stops = trial.stops;
        state.dry = trial.dry;
    }

    // Each threshold is a kink of the force at full speed.
    #[inline]
    fn event(
        &self,
        state: &PrandtlIshlinskiiState<S>,
        trial: &PrandtlIshlinskiiTrial<S>,
        _motion: &Motion<S>,
    ) -> Option<Event> {
        let begins = |(old, new): (&Stop<S>, &Stop<S>)| new.mode != 0.0 && new.mode != old.mode;
        state.stops.iter().zip(&trial.stops).any(begins).then_some(Event::BreakAway)
    }

    #[inline]
    fn margin(
        &self,
        state: &PrandtlIshlinskiiState<S>,
        _trial: &PrandtlIshlinskiiTrial<S>,
        motion: &Motion<S>,
        _event: Event,
    ) -> S {
        let margins = state
            .stops
            .iter()
            .zip(&self.thresholds)
            .map(|(stop, limit)| stop.margin(*limit, motion.displacement));
        margins.reduce(|a, b| if b.re() < a.re() { b } else { a }).unwrap_or(S::constant(0.0))
    }

    fn switch(&self, state: &mut PrandtlIshlinskiiState<S>, _event: Event) {
        let before = *state;
        for (stop, limit) in state.stops.iter_mut().zip(&self.thresholds) {
            if stop.due(*limit) {
                stop.slide();
            }
        }
        state.statistics = Self::count(&before, &state.stops);
    }
}
