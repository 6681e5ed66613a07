//! Relays on a bounded Preisach plane, their density in closed form.

use super::elements::loading::{Loading, Response, virgin_inverse};
use super::elements::reachable::reachable;
use super::elements::spring::{SpringState, Walk};
use super::{
    Channels, Entry, EntryReader, FrictionLaw, LawState, Motion, Outcome, Rest, Statistics,
};
use crate::math::scalar::{Scalar, sign};
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`Preisach`].
    pub struct PreisachParameters {
        coulomb: Effort, "friction once the contact slides, F_c",
            default Value(0.35), neutral None, typical 0.35, bounds 1e-12, 1e9;
        initial_stiffness: Stiffness, "slope right after a reversal, k_0",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        edge_density: One, "how much denser the relays are at the edge of the plane than in its middle, q: 1 + q times",
            default Value(2.0), neutral Some(0.0), typical 1.5, bounds 0.0, 3.5;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

parameters! {
    /// What a contact of [`Preisach`] may bring along.
    pub struct PreisachStart {
        force: Effort, "force of the contact at the start, on the first loading curve; levels off from 98 % of F_c on, below F_c",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1e9, 1e9;
        turned: One, "where the contact turned round before, on the first loading curve, as a share of F_c; 0 where it never did, and forgotten where the force is beyond it",
            default Value(0.0), neutral Some(0.0), typical 0.5, bounds -0.999, 0.999;
        turned_again: One, "where it turned round after that, as a share of F_c; 0 where it did not; forgotten where the force is beyond it, and the first turn where this one is beyond that",
            default Value(0.0), neutral Some(0.0), typical 0.3, bounds -0.999, 0.999;
    }
}

/// Relays over the elongation of a contact, denser where it is nearly torn off.
///
/// ζ = z/Z, z the elongation: z' = v, but never beyond ±Z, where the contact slides at ±F_c
///
/// σ/F_c = r·ζ − ∫∫ μ(α, β)·γ_αβ[ζ] dα dβ over −1 ≤ β ≤ α ≤ 1;  μ = a + b·((α + β)/2)²
///
/// a = 1/(2 + q), b = q·a, r = 4·a + 4·b/3, Z = r·F_c/k_0;  F = L·σ + F_v·v. γ_αβ is +1 from α up and
/// −1 from β down. A friction loop runs clockwise and a relay's the other way: hence the minus,
/// and a spring r on the diagonal that it is taken from.
///
/// At v = 0 the force stays where it is. Memory: reverse points of z, wiped out by every slide.
/// Passive. Neutral: q = 0 is an even density, and `maxwell_slip` with κ = 1/2.
/// Source: Mayergoyz, Mathematical Models of Hysteresis (1991); from memory. The bounded plane that
/// slides along and the density are ours.
#[derive(Debug, Clone)]
pub struct Preisach<S> {
    parameters: PreisachParameters<S>,
    plane: Plane<S>,
}

/// Branches of the relays, from the integral of their density over triangles (Everett).
#[derive(Debug, Clone, Copy)]
struct Plane<S> {
    coulomb: S,
    stiffness: S,
    /// Greatest elongation Z.
    half: S,
    a: S,
    b: S,
    r: S,
}

impl<S: Scalar> Plane<S> {
    fn new(p: &PreisachParameters<S>) -> Self {
        let a = S::constant(1.0) / (p.edge_density + 2.0);
        let b = p.edge_density * a;
        let r = a * 4.0 + b * (4.0 / 3.0);
        let half = r * p.coulomb / p.initial_stiffness;
        Self { coulomb: p.coulomb, stiffness: p.initial_stiffness, half, a, b, r }
    }

    /// Force from a reverse point over the way 2·h with its middle at m, both along the way, and
    /// the slope at its end.
    fn risen(&self, m: S, h: S) -> Response<S> {
        let (mm, hh) = (m * m, h * h);
        let force =
            self.r * h * 2.0 - self.a * hh * 4.0 - self.b * hh * (mm * 4.0 + hh * (2.0 / 3.0));
        let bend = h * (mm * 3.0 + m * h * 3.0 + hh);
        let slope = self.r - self.a * h * 4.0 - self.b * bend * (4.0 / 3.0);
        Response { force: self.coulomb * force, slope: self.coulomb / self.half * slope }
    }
}

impl<S: Scalar> Loading<S> for Plane<S> {
    #[inline]
    fn initial_stiffness(&self) -> S {
        self.stiffness
    }

    // About the middle of the plane; elsewhere `branch_from` tells.
    #[inline]
    fn branch(&self, d: S) -> Response<S> {
        self.risen(S::constant(0.0), d / self.half * 0.5)
    }

    #[inline]
    fn branch_from(&self, anchor: S, direction: f64, d: S) -> Response<S> {
        debug_assert!(d.re() >= 0.0, "branch evaluated behind its reverse point: {d:?}");
        let h = d / self.half * 0.5;
        self.risen(anchor * direction / self.half + h, h)
    }

    #[inline]
    fn virgin(&self, x: S) -> Response<S> {
        // Half of the branch that comes from the mirror of x.
        let s = if x.re() < 0.0 { -1.0 } else { 1.0 };
        let whole = self.risen(S::constant(0.0), x * s / self.half);
        Response { force: whole.force * (0.5 * s), slope: whole.slope }
    }

    #[inline]
    fn closes_at_mirror(&self) -> bool {
        true
    }
}

/// State of [`Preisach`]; forces are those at level 1.
#[derive(Debug, Clone)]
pub struct PreisachState<S> {
    spring: SpringState<S>,
    statistics: Statistics,
}

/// A step of [`Preisach`].
#[derive(Debug, Clone, Copy)]
pub struct PreisachTrial<S> {
    walk: Walk<S>,
    outcome: Outcome<S>,
}

impl<S: Scalar> PreisachState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> PreisachState<T> {
        PreisachState { spring: self.spring.map(convert), statistics: self.statistics }
    }
}

impl<S: Scalar> LawState<S> for PreisachState<S> {
    const OUTPUTS: &'static [&'static str] = &["spring", "spring_force"];

    fn output(&self, index: usize) -> S {
        if index == 0 { self.spring.position } else { self.spring.force }
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        let count = |n: u64| Entry::Number(n as f64);
        let mut entries = self.spring.entries();
        entries.extend([
            ("reversals", count(self.statistics.reversals)),
            ("closings", count(self.statistics.closings)),
            ("memory_peak", count(self.statistics.memory_peak)),
            ("breakaways", count(self.statistics.breakaways)),
            ("sticks", count(self.statistics.sticks)),
        ]);
        entries
    }

    fn statistics(&self) -> Statistics {
        Statistics {
            memory_growths: self.spring.memory.growths(),
            memory_merged: self.spring.memory.merged(),
            ..self.statistics
        }
    }

    fn make_room(&mut self, steps: usize) {
        self.spring.memory.make_room(steps);
    }
}

impl<S: Scalar> Preisach<S> {
    #[inline]
    fn moved(
        &self,
        state: &PreisachState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> PreisachTrial<S> {
        let (spring, half) = (&state.spring, self.plane.half);
        let pulled = spring.position + motion.displacement;
        let slides = pulled.re().abs() >= half.re();
        // To the edge itself, so that a slide neither turns round nor creeps by round-off.
        let to = if slides { half * sign(pulled.re()) } else { pulled };
        let moving = sign(to.re() - spring.position.re());
        let walk = spring.walk_to(&self.plane, to, moving);
        let stiffness = if slides { S::constant(0.0) } else { walk.end.slope };
        let damping = self.parameters.viscous * channels.viscous_level;
        let force = walk.end.force * channels.level + damping * motion.velocity;
        let slope = stiffness * channels.level * motion.duration + damping;
        PreisachTrial { walk, outcome: Outcome { force, slope, damping } }
    }

    #[inline]
    fn slides(&self, state: &PreisachState<S>) -> bool {
        state.spring.position.re().abs() >= self.plane.half.re()
    }
}

impl<S: Scalar> FrictionLaw<S> for Preisach<S> {
    type State = PreisachState<S>;
    type Trial = PreisachTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = PreisachParameters::<f64>::SPECS;
    const START: &'static [ParameterSpec] = PreisachStart::<f64>::SPECS;
    const REMEMBERS: bool = true;
    const SUMMARY: &'static str =
        "relays on a Preisach plane: hysteresis whose small loops depend on where they lie";
    const SOURCE: &'static str = "Mayergoyz (1991), from memory; bounded plane and density ours";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let parameters = PreisachParameters::from_values(values);
        Self { parameters, plane: Plane::new(&parameters) }
    }

    fn initial(&self) -> PreisachState<S> {
        PreisachState {
            spring: SpringState::relaxed(&self.plane),
            statistics: Statistics::default(),
        }
    }

    fn primed(&self, values: &[S]) -> PreisachState<S> {
        let (start, greatest) = (PreisachStart::from_values(values), self.parameters.coulomb);
        let turns = [start.turned, start.turned_again].map(|share| share * greatest);
        let force = reachable(start.force, greatest);
        let mut state = self.initial();
        let inverse = |force| virgin_inverse(&self.plane, force);
        state.spring.come_back(&self.plane, inverse, turns, force);
        state
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<PreisachState<S>> {
        let mut read = EntryReader::new(entries);
        let mut state = self.initial();
        state.spring.restore(&mut read)?;
        state.statistics = Statistics {
            reversals: read.count("reversals")?,
            closings: read.count("closings")?,
            memory_peak: read.count("memory_peak")?,
            breakaways: read.count("breakaways")?,
            sticks: read.count("sticks")?,
            ..Statistics::default()
        };
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
    fn force(&self, state: &PreisachState<S>, velocity: S, channels: &Channels<S>) -> S {
        state.spring.force * channels.level
            + self.parameters.viscous * channels.viscous_level * velocity
    }

    fn advance(
        &self,
        state: &PreisachState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> PreisachTrial<S> {
        self.moved(state, motion, channels)
    }

    #[inline]
    fn outcome(&self, trial: &PreisachTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    // Where the body stays, so does the force.
    fn rest(
        &self,
        state: &PreisachState<S>,
        channels: &Channels<S>,
        duration: S,
    ) -> Option<Rest<S, PreisachTrial<S>>> {
        Some(Rest::still(self, state, channels, duration))
    }

    #[inline]
    fn commit(&self, state: &mut PreisachState<S>, trial: &PreisachTrial<S>) {
        let before = self.slides(state);
        state.spring.accept(&trial.walk);
        let after = self.slides(state);
        state.statistics.breakaways += u64::from(after && !before);
        state.statistics.sticks += u64::from(before && !after);
        state.spring.count(&trial.walk, &mut state.statistics);
    }
}
