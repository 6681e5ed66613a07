//! The Leuven model: bristles whose force is a hysteresis that remembers its reverse points.

use super::elements::approach::{approach, approach_evenly, way_evenly_to, way_to};
use super::elements::bristle::{self, Bent, Bristle, Slip};
use super::elements::reachable::reachable;
use super::elements::slides::Slides;
use super::elements::spring::{SpringState, Walk};
use super::elements::stribeck::{SlidingLevel, check_levels};
use super::elements::yield_curve::{GROUPS, YieldCurve};
use super::{
    Channels, Entry, EntryReader, FrictionLaw, LawState, Motion, Outcome, Rest, Statistics,
};
use crate::math::scalar::{Scalar, logarithmic_mean, sign};
use crate::parameters;
use crate::support::error::Result;
use crate::support::parameter::ParameterSpec;

/// Share of g by which it is moved for the slope of a held velocity.
const NUDGE: f64 = 1e-6;
/// Shares of a branch beyond which none is followed: no force gets there but a restored one.
const ENDS: f64 = 1.0 - 1e-12;
/// 1 − (1 − r)ⁿ is taken from its series below this r.
const SMALL: f64 = 1e-4;

parameters! {
    /// Parameters of [`Leuven`].
    pub struct LeuvenParameters {
        coulomb: Effort, "friction while sliding fast, F_c",
            default Ratio { of: "breakaway", factor: 0.7, otherwise: 0.35 }, neutral None,
            typical 0.35, bounds 1e-12, 1e9;
        breakaway: Effort, "friction of very slow sliding, F_s; equal to coulomb where that alone is stated",
            default Ratio { of: "coulomb", factor: 1.0, otherwise: 0.5 }, neutral None,
            typical 0.5, bounds 1e-12, 1e9;
        stribeck_velocity: Velocity, "speed scale of the fall from F_s to F_c, v_s",
            default Value(0.1), neutral None, typical 0.1, bounds 1e-9, 1e6;
        stribeck_exponent: One, "shape of the fall, δ",
            default Value(2.0), neutral None, typical 2.0, bounds 0.3, 5.0;
        initial_stiffness: Stiffness, "slope of the hysteresis right after a reversal, k_0",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        saturation: One, "force that the hysteresis approaches, as a multiple of F_s, λ",
            default Value(1.5), neutral None, typical 1.5, bounds 1.02, 1e3;
        exponent: One, "how late the deflection begins to slip, n",
            default Value(1.0), neutral None, typical 1.5, bounds 1.0, 10.0;
        damping: Damping, "damping of the deflection, σ_1",
            default Value(1.0), neutral Some(0.0), typical 1.0, bounds 0.0, 1e9;
        damping_velocity: Velocity, "speed at which that damping has fallen to 1/e, v_d; inf: no fall",
            default Value(f64::INFINITY), neutral Some(f64::INFINITY), typical 0.1,
            bounds 1e-9, f64::INFINITY;
        viscous: Damping, "friction per speed, σ_2",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

parameters! {
    /// What a contact of [`Leuven`] may bring along.
    pub struct LeuvenStart {
        force: Effort, "force of the hysteresis at the start, on its first loading curve; levels off from 98 % of F_s on, below F_s",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1e9, 1e9;
        turned: One, "where the contact turned round before, on the first loading curve, as a share of F_s; 0 where it never did, and forgotten where the force is beyond it",
            default Value(0.0), neutral Some(0.0), typical 0.5, bounds -0.999, 0.999;
        turned_again: One, "where it turned round after that, as a share of F_s; 0 where it did not; forgotten where the force is beyond it, and the first turn where this one is beyond that",
            default Value(0.0), neutral Some(0.0), typical 0.3, bounds -0.999, 0.999;
    }
}

/// LuGre's dynamics of a deflection, whose force is a hysteresis with closing loops.
///
/// z' = v·(1 − sgn(F_h(z)/s(v))·|F_h(z)/s(v)|ⁿ);  s(v) = sgn(v)·(F_c + (F_s − F_c)·exp(−|v/v_s|^δ))
/// F = L·(F_h(z) + σ₁·exp(−(v/v_d)²)·z') + σ₂·v
/// F_h: first loading F_∞·(1 − exp(−k_0·z/F_∞)), F_∞ = λ·F_s, branches by Masing's rule
///
/// At v = 0 the deflection stays as it is: no creep, no true stick. It slips a little at any force,
/// the less the greater n is. Memory: reverse points of z. Passive only where
/// [`bristle::passive_with`] says so. Neutral: v_d = ∞, F_s = F_c.
/// Source: Swevers, Al-Bender, Ganseman, Prajogo, IEEE Trans. Autom. Control 45 (2000), with z' of
/// Lampaert, Swevers, Al-Bender, IEEE Trans. Autom. Control 47 (2002); F_h is one curve of ours.
#[derive(Debug, Clone)]
pub struct Leuven<S> {
    bristle: Bristle<S>,
    exponent: S,
    /// F_∞.
    saturation: S,
    curve: YieldCurve<S>,
}

/// State of [`Leuven`]; forces are those at level 1.
#[derive(Debug, Clone)]
pub struct LeuvenState<S> {
    spring: SpringState<S>,
    slides: Slides,
    /// Of the memory alone.
    loops: Statistics,
}

/// A step of [`Leuven`].
#[derive(Debug, Clone, Copy)]
pub struct LeuvenTrial<S> {
    walk: Walk<S>,
    slides: Slides,
    outcome: Outcome<S>,
}

/// What the entry of a count of slides is called beside those of the spring.
fn apart(name: &str) -> &str {
    match name {
        "direction" => "moved",
        "moved" => "direction",
        other => other,
    }
}

const COUNTED: [&str; 5] = ["mode", "moved", "reversals", "breakaways", "sticks"];

impl<S: Scalar> LeuvenState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> LeuvenState<T> {
        LeuvenState { spring: self.spring.map(convert), slides: self.slides, loops: self.loops }
    }
}

impl<S: Scalar> LawState<S> for LeuvenState<S> {
    const OUTPUTS: &'static [&'static str] = &["spring", "spring_force", "mode"];

    fn output(&self, index: usize) -> S {
        match index {
            0 => self.spring.position,
            1 => self.spring.force,
            _ => S::constant(self.slides.mode),
        }
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        let mut entries = self.spring.entries();
        let count = |n: u64| Entry::Number(n as f64);
        entries.extend([
            ("closings", count(self.loops.closings)),
            ("memory_peak", count(self.loops.memory_peak)),
        ]);
        entries.extend(self.slides.entries().into_iter().map(|(name, entry)| (apart(name), entry)));
        entries
    }

    fn statistics(&self) -> Statistics {
        Statistics {
            closings: self.loops.closings,
            memory_peak: self.loops.memory_peak,
            memory_growths: self.spring.memory.growths(),
            memory_merged: self.spring.memory.merged(),
            ..self.slides.statistics()
        }
    }

    fn make_room(&mut self, steps: usize) {
        self.spring.memory.make_room(steps);
    }
}

/// h(r)/r, h = |1 − sgn(a)·|a|ⁿ| the share of a path that bends, where a = 1 − r (`rising`) or 1 + r.
#[inline]
fn bends<S: Scalar>(r: S, n: S, rising: bool) -> S {
    let m = if rising { 1.0 } else { -1.0 };
    if r.re() < SMALL {
        let once = (n - 1.0) * (0.5 * m);
        return n * -(r * (once - r * (n - 1.0) * (n - 2.0) / 6.0) - 1.0);
    }
    let a = -(r * m - 1.0);
    let power = a.power_of_magnitude(n) * sign(a.re());
    (power - 1.0) * -m / r
}

impl<S: Scalar> Leuven<S> {
    /// t = sgn(F_h·v)·|F_h/s|ⁿ.
    fn slip(&self, force: S, velocity: S) -> Slip<S> {
        let (level, steepness) = self.bristle.level.at(velocity);
        let a = force * sign(velocity.re()) / level;
        let size = a.power_of_magnitude(self.exponent);
        let share = size * sign(a.re());
        let by_a = if a.re() == 0.0 {
            S::constant(if self.exponent.re() == 1.0 { 1.0 } else { 0.0 })
        } else {
            self.exponent * size / a.abs()
        };
        let by_speed = -(self.exponent * share * steepness / level);
        Slip { share, by_force: by_a / level, by_speed }
    }

    /// Where z is after a path in the direction s at this g, and which way it went there.
    ///
    /// Along a branch from F_r the slope is k_0·(1 − |F_h − F_r|/(2·F_∞)), a function of the force:
    /// so is the rate at which F_h nears g, and the branches of a path are followed one by one.
    fn bent(&self, spring: &SpringState<S>, s: f64, path: S, level: S) -> (S, f64) {
        let rising = (spring.force.re() * s) <= level.re();
        // From here on along the way of z: its force, and where that leads.
        let way = if rising { s } else { -s };
        let goal = if rising { level } else { -level };
        let (stiffness, n) = (self.bristle.stiffness, self.exponent);
        let points = spring.memory.points();
        let reversed = spring.direction != way && spring.direction != 0.0;
        let mut kept = points.len();
        let mut new = reversed.then_some((spring.position * way, spring.force * way));
        let mut force = spring.force * way;
        let mut left = path;
        loop {
            let anchor = match new {
                Some(point) => Some(point),
                None => points[..kept].last().map(|p| (p.position * way, p.force * way)),
            };
            let (from, span) = match anchor {
                Some((_, from)) => (from, self.saturation * 2.0),
                None => (S::constant(0.0), self.saturation),
            };
            let distance = span / stiffness;
            // (slope of the branch)/g times what bends, per r.
            let gap = (from + span - goal) / level;
            let rate = |r: S| (r + gap) / distance * bends(r, n, rising);
            // All of a path bends that may with n = 1, and a formula leads along.
            let even = n.re() == 1.0 && !n.derivative_is_nonzero();
            let r = (goal - force) / level;
            // Force at which this branch closes its loop, and how many points that forgets.
            let closing = match (new, &points[..kept]) {
                (Some((_, from)), []) => Some((-from, 0)),
                (Some(_), [.., older]) => Some((older.force * way, 1)),
                (None, []) => None,
                (None, [only]) => Some((-(only.force * way), 1)),
                (None, [.., older, _]) => Some((older.force * way, 2)),
            };
            let closing = closing.filter(|(target, _)| target.re() < goal.re());
            // Where the force changes sign the rate is not smooth.
            let crosses = rising && r.re() > 1.0 && closing.is_none_or(|(at, _)| at.re() > 0.0);
            let stop = if crosses { Some((S::constant(0.0), 0)) } else { closing };
            if let Some((target, wiped)) = stop {
                let short = target.re() - force.re();
                // No path leads further than all of it at the slope of a reversal, bending most.
                let size = (force.re().abs() / level.re()).max(1.0).powf(n.re());
                let quick = stiffness.re() * left.re() * (1.0 + size);
                if short <= quick {
                    let there = (goal - target) / level;
                    let needed = if short <= 0.0 {
                        S::constant(0.0)
                    } else if even {
                        way_evenly_to(r, there, gap, distance)
                    } else {
                        way_to(r, there, rate)
                    };
                    if needed.re() <= left.re() {
                        left -= needed;
                        force = target;
                        if !crosses {
                            kept -= wiped;
                            new = None;
                        }
                        continue;
                    }
                }
            }
            if r.re() > 0.0 {
                let r = if even {
                    approach_evenly(r, left, gap, distance)
                } else {
                    approach(r, left, rate)
                };
                force = goal - r * level;
            }
            let share = (force - from) / span;
            let share = if share.re() < ENDS { share } else { S::constant(ENDS) };
            let along = distance * share * logarithmic_mean(share);
            let position = anchor.map_or(along, |(at, _)| at + along);
            // Never behind its start, not by round-off either.
            let ahead = position.re() > spring.position.re() * way;
            return (if ahead { position * way } else { spring.position }, way);
        }
    }

    #[inline]
    fn walked(&self, spring: &SpringState<S>, s: f64, path: S, level: S) -> Walk<S> {
        let (position, way) = self.bent(spring, s, path, level);
        spring.walk_to(&self.curve, position, way)
    }
}

impl<S: Scalar> FrictionLaw<S> for Leuven<S> {
    type State = LeuvenState<S>;
    type Trial = LeuvenTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = LeuvenParameters::<f64>::SPECS;
    const OPTIONAL: &'static [&'static str] =
        &["breakaway", "stribeck_velocity", "stribeck_exponent", "damping_velocity"];
    const START: &'static [ParameterSpec] = LeuvenStart::<f64>::SPECS;
    const SUMMARY: &'static str = "LuGre's dynamics on a hysteresis with reverse points: lag, Stribeck fall, loops within loops";
    const SOURCE: &'static str = "Swevers, Al-Bender, Ganseman, Prajogo (2000), as modified by Lampaert, Swevers, Al-Bender (2002)";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let p = LeuvenParameters::from_values(values);
        let level =
            SlidingLevel::new(p.coulomb, p.breakaway, p.stribeck_velocity, p.stribeck_exponent);
        let saturation = p.saturation * p.breakaway;
        let even = [S::constant(1.0); GROUPS];
        let bristle = Bristle {
            stiffness: p.initial_stiffness,
            level,
            damping: p.damping,
            damping_velocity: p.damping_velocity,
            viscous: p.viscous,
        };
        let curve = YieldCurve::new(saturation, p.initial_stiffness, S::constant(0.0), even);
        Self { bristle, exponent: p.exponent, saturation, curve }
    }

    fn check(values: &[f64]) -> Result<()> {
        let p = LeuvenParameters::from_values(values);
        check_levels(p.coulomb, p.breakaway)
    }

    fn passive(values: &[f64]) -> bool {
        let law = Leuven::build(values, &[]);
        bristle::passive_with(&law.bristle, law.exponent)
    }

    fn initial(&self) -> LeuvenState<S> {
        LeuvenState {
            spring: SpringState::relaxed(&self.curve),
            slides: Slides::default(),
            loops: Statistics::default(),
        }
    }

    fn primed(&self, values: &[S]) -> LeuvenState<S> {
        let greatest = self.bristle.level.greatest();
        let start = LeuvenStart::from_values(values);
        let turns = [start.turned, start.turned_again].map(|share| share * greatest);
        let force = reachable(start.force, greatest);
        let mut state = self.initial();
        let inverse = |force| self.curve.virgin_inverse(force);
        state.spring.come_back(&self.curve, inverse, turns, force);
        state
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<LeuvenState<S>> {
        let (counted, own): (Vec<_>, Vec<_>) =
            entries.iter().cloned().partition(|(name, _)| COUNTED.contains(&name.as_str()));
        let counted: Vec<(String, Entry)> =
            counted.into_iter().map(|(name, entry)| (apart(&name).to_owned(), entry)).collect();
        let mut state = self.initial();
        let mut read = EntryReader::new(&own);
        state.spring.restore(&mut read)?;
        state.loops.closings = read.count("closings")?;
        state.loops.memory_peak = read.count("memory_peak")?;
        read.finish()?;
        let mut read = EntryReader::new(&counted);
        state.slides = Slides::restore(&mut read)?;
        read.finish()?;
        Ok(state)
    }

    fn sliding_force(&self) -> S {
        self.bristle.level.greatest()
    }

    fn greatest_stiffness(&self) -> f64 {
        // Right after a reversal of steady sliding, as of LuGre.
        2.0 * self.bristle.stiffness.re()
    }

    fn greatest_damping(&self) -> f64 {
        self.bristle.damping.re() + self.bristle.viscous.re()
    }

    fn steepest_fall(&self) -> f64 {
        self.bristle.level.steepest_fall()
    }

    #[inline]
    fn force(&self, state: &LeuvenState<S>, velocity: S, channels: &Channels<S>) -> S {
        let slip = self.slip(state.spring.force, velocity);
        self.bristle.friction(state.spring.force, &slip, velocity, channels)
    }

    fn advance(
        &self,
        state: &LeuvenState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> LeuvenTrial<S> {
        let (spring, bristle) = (&state.spring, &self.bristle);
        let s = sign(motion.displacement.re());
        let by_end = S::constant(0.0);
        let (walk, by_velocity);
        if s == 0.0 {
            walk = spring.walk_to(&self.curve, spring.position, 0.0);
            by_velocity = bristle.stiffness * motion.duration;
        } else {
            let path = motion.displacement * s;
            let (to, steepness) = bristle.level.at(motion.velocity);
            let held = motion.start_velocity.re() == motion.velocity.re();
            let level =
                if held { to } else { (to + bristle.level.at(motion.start_velocity).0) * 0.5 };
            walk = self.walked(spring, s, path, level);
            let slip = self.slip(walk.end.force, motion.velocity);
            let mut slope = walk.end.slope * motion.duration * -(slip.share - 1.0);
            if held && steepness.re() != 0.0 {
                // A slope that only solvers of a host's own ask for.
                let step = level.re() * NUDGE;
                let at = |step: f64| self.walked(spring, s, path, level + step).end.force;
                slope += (at(step) - at(-step)) * steepness * s / (2.0 * step);
            }
            by_velocity = slope;
        }
        let bent = Bent { force: walk.end.force, by_velocity, by_end };
        let slip = self.slip(bent.force, motion.velocity);
        let outcome = bristle.outcome(&bent, &slip, motion.velocity, channels);
        let coulomb = bristle.level.coulomb.re();
        let slides = state.slides.after(motion.velocity.re(), bent.force.re(), coulomb);
        LeuvenTrial { walk, slides, outcome }
    }

    #[inline]
    fn outcome(&self, trial: &LeuvenTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    // Where the body stays, so does the force.
    fn rest(
        &self,
        state: &LeuvenState<S>,
        channels: &Channels<S>,
        duration: S,
    ) -> Option<Rest<S, LeuvenTrial<S>>> {
        Some(Rest::still(self, state, channels, duration))
    }

    #[inline]
    fn commit(&self, state: &mut LeuvenState<S>, trial: &LeuvenTrial<S>) {
        state.spring.accept(&trial.walk);
        state.spring.count(&trial.walk, &mut state.loops);
        state.slides = trial.slides;
    }
}
