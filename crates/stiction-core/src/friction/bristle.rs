//! Randomly placed bristles that bond, stretch and break: Haessig and Friedland's first model.

use super::{
    Channels, Entry, EntryReader, Event, FrictionLaw, INTERNAL, LawState, Motion, Outcome, Rest,
    Statistics,
};
use crate::math::scalar::{Scalar, sign};
use crate::parameters;
use crate::support::error::{Error, Result};
use crate::support::parameter::ParameterSpec;
use crate::support::work;

/// Bristles of [`Bristle`].
pub const BRISTLES: usize = 20;
const SHARE: f64 = 1.0 / BRISTLES as f64;
/// Sites of one bristle in a step that are summed one by one; of more their mean is taken. Twenty bristles
/// pass so many more that what scatters about the mean is a hundredth of the force in that step, and of
/// either sign.
const MOST_SITES: f64 = 8.0;
/// Sites of which the sum takes as long as a step in a row, see [`crate::support::work`].
const SITES_OF_A_STEP: f64 = 6.0;
/// Breaks are counted as far as a float is a whole number.
const MOST_BREAKS: f64 = 1e15;
/// How near its limit a bristle is that breaks where a break was located, in limits.
const REACHED: f64 = 1e-9;

parameters! {
    /// Parameters of [`Bristle`].
    pub struct BristleParameters {
        coulomb: Effort, "mean force of a long slide, F_c",
            default Value(0.35), neutral None, typical 0.35, bounds 1e-12, 1e9;
        initial_stiffness: Stiffness, "stiffness of all bristles together, k_0",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        scatter: One, "how far the bonding sites scatter about even spacing, in spacings, s",
            default Value(0.8), neutral None, typical 0.6, bounds 0.0, 0.95;
        seed: One, "which sites: the nearest whole number begins the sequence of random numbers",
            default Value(1.0), neutral None, typical 1.0, bounds 0.0, 1e9;
        viscous: Damping, "friction per speed, F_v",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

/// Twenty linear bristles that break at a stretch δ and bond again at the next site.
///
/// F = L·(k_0/20)·Σ_i (x − p_i) + F_v·v,  |x − p_i| ≤ δ,  p_i = δ·(n_i + o_i + s·u(i, n_i))
///
/// n_i counts the sites of bristle i, o_i = (2i + 1)/40 − 1/2, u is evenly distributed over
/// (−1/2, 1/2), u(i, 0) = 0; δ = F_c/(k_0·(1/2 − s²/12)), by which a long slide has the mean F_c.
///
/// At v = 0 the force stays where it is. Memory: the position and the site of each bristle; sites
/// are places, so that the same way back meets the same ones. Passive but for what is stretched
/// at the start.
/// Source: Haessig, Friedland, J. Dyn. Syst. Meas. Control 113 (1991) 354-362, from memory: there a
/// new bond is drawn when one breaks; sites that are drawn once make it repeatable at any step.
#[derive(Debug, Clone)]
pub struct Bristle<S> {
    parameters: BristleParameters<S>,
    /// Stretch at which a bristle breaks, δ.
    limit: S,
    seed: u64,
}

/// Which site a bristle holds on to.
#[derive(Debug, Clone, Copy)]
struct Bond {
    site: f64,
    /// u of the site.
    off: f64,
}

/// What follows from all bonds together; places in limits.
#[derive(Debug, Clone, Copy)]
struct Grip {
    /// Means of n and of u: that of o is 0, which a sum of its parts would miss by a digit, and at the highest
    /// levels that is a force.
    site: f64,
    off: f64,
    /// Where the first of them breaks, to either side.
    behind: f64,
    ahead: f64,
}

/// State of [`Bristle`].
#[derive(Debug, Clone, Copy)]
pub struct BristleState<S> {
    position: S,
    /// Of the last step: how fast bristles break, for the reference integrator.
    velocity: f64,
    bonds: [Bond; BRISTLES],
    grip: Grip,
    /// At level 1, without its viscous part.
    dry: S,
    breaks: f64,
}

/// A step of [`Bristle`].
#[derive(Debug, Clone, Copy)]
pub struct BristleTrial<S> {
    position: S,
    velocity: f64,
    dry: S,
    breaks: f64,
    /// Whether the breaks in it are to be located one by one.
    located: bool,
    outcome: Outcome<S>,
    /// Friction that gives, with that at the start, twice the mean over the way.
    balance: S,
}

impl<S: Scalar> BristleState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> BristleState<T> {
        BristleState {
            position: convert(self.position),
            velocity: self.velocity,
            bonds: self.bonds,
            grip: self.grip,
            dry: convert(self.dry),
            breaks: self.breaks,
        }
    }
}

impl<S: Scalar> LawState<S> for BristleState<S> {
    const OUTPUTS: &'static [&'static str] = &["dry_friction"];

    fn output(&self, _index: usize) -> S {
        self.dry
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        let rows = self.bonds.iter().enumerate().map(|(i, bond)| [i as f64, bond.site]).collect();
        vec![
            ("position", Entry::Number(self.position.re())),
            ("velocity", Entry::Number(self.velocity)),
            ("sites", Entry::Pairs(rows)),
            ("dry_friction", Entry::Number(self.dry.re())),
            ("breakaways", Entry::Number(self.breaks)),
        ]
    }

    // A bristle that breaks holds again at once.
    fn statistics(&self) -> Statistics {
        let breaks = self.breaks as u64;
        Statistics { breakaways: breaks, sticks: breaks, ..Statistics::default() }
    }
}

/// Where the sites of a bristle begin, in limits; the sum over all is 0.
#[inline]
fn offset(bristle: usize) -> f64 {
    (bristle as f64 + 0.5) * SHARE - 0.5
}

/// Evenly distributed over (−1/2, 1/2): splitmix64 of seed, bristle and site.
#[inline]
fn scattered(seed: u64, bristle: usize, site: f64) -> f64 {
    if site == 0.0 {
        return 0.0;
    }
    let mut z = seed
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .wrapping_add((bristle as u64 + 1).wrapping_mul(0xBF58_476D_1CE4_E5B9))
        .wrapping_add((site as i64 as u64).wrapping_mul(0x94D0_49BB_1331_11EB));
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^= z >> 31;
    (z >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
}

impl<S: Scalar> Bristle<S> {
    #[inline]
    fn bond(&self, bristle: usize, site: f64) -> Bond {
        Bond { site, off: scattered(self.seed, bristle, site) }
    }

    /// Place of a bond in limits.
    #[inline]
    fn place(&self, bristle: usize, bond: Bond) -> S {
        self.parameters.scatter * bond.off + (bond.site + offset(bristle))
    }

    /// The bond of a bristle at a position in limits: the first site in reach, on the way there.
    #[inline]
    fn bonded(&self, bristle: usize, bond: Bond, at: f64) -> Bond {
        let stretch = |bond: Bond| at - self.place(bristle, bond).re();
        let held = stretch(bond);
        if held.abs() <= 1.0 {
            return bond;
        }
        let side = sign(held);
        // Sites lie within half a scatter of even spacing: one of two is the first.
        let reached = side * (at - offset(bristle)) - 1.0;
        let first = (reached - 0.5 * self.parameters.scatter.re()).ceil();
        let next = self.bond(bristle, side * first.max(side * bond.site + 1.0));
        if stretch(next) * side <= 1.0 { next } else { self.bond(bristle, next.site + side) }
    }

    /// What follows from these bonds.
    fn grip(&self, bonds: &[Bond; BRISTLES]) -> Grip {
        let mut grip =
            Grip { site: 0.0, off: 0.0, behind: f64::NEG_INFINITY, ahead: f64::INFINITY };
        for (bristle, bond) in bonds.iter().enumerate() {
            let place = self.place(bristle, *bond).re();
            grip.site += bond.site;
            grip.off += SHARE * bond.off;
            grip.behind = grip.behind.max(place - 1.0);
            grip.ahead = grip.ahead.min(place + 1.0);
        }
        grip.site *= SHARE;
        grip
    }

    /// Force of all bristles whose sites have these means.
    #[inline]
    fn pull(&self, position: S, site: f64, off: f64) -> S {
        let p = &self.parameters;
        p.initial_stiffness * (position - self.limit * (p.scatter * off + site))
    }

    /// ∫ t dt along the way of a bristle, t its stretch in limits in the direction of motion, from
    /// `start` to `end`; `breaks` times in between it goes up to 1 and falls by the gap to the next
    /// site.
    fn effort(&self, bristle: usize, (bond, breaks): (Bond, f64), side: f64, ends: (S, S)) -> S {
        let (start, end) = ends;
        let mut sum = (end - start) * (end + start) * 0.5;
        if breaks > 0.0 {
            let (mut held, mut uneven) = (bond, 0.0);
            for _ in 0..breaks.min(MOST_SITES) as u32 {
                let next = self.bond(bristle, held.site + side);
                uneven += (next.off - held.off).powi(2);
                held = next;
            }
            // Two sites differ by s·(u − u'), whose square has the mean s²/6.
            uneven += (breaks - MOST_SITES).max(0.0) / 6.0;
            let scatter = self.parameters.scatter;
            // (1 − (1 − g)²)/2 of every gap g.
            sum += -(scatter * scatter * uneven - breaks) * 0.5;
        }
        sum
    }

    /// Force at the end of a way on which bristles break, its mean over the way, and how many break.
    #[cold]
    #[inline(never)]
    fn passed(&self, state: &BristleState<S>, position: S, displacement: S) -> (S, S, f64) {
        let (from, to) = (state.position / self.limit, position / self.limit);
        let way = displacement.abs() / self.limit;
        let side = sign(displacement.re());
        let (mut site, mut off, mut all) = (0.0, 0.0, 0.0);
        let (mut sum, mut sites) = (S::constant(0.0), 0.0);
        for (bristle, bond) in state.bonds.iter().enumerate() {
            let next = self.bonded(bristle, *bond, to.re());
            let breaks = (next.site - bond.site).abs();
            let start = (from - self.place(bristle, *bond)) * side;
            let end = (to - self.place(bristle, next)) * side;
            sum += self.effort(bristle, (*bond, breaks), side, (start, end));
            sites += breaks.min(MOST_SITES);
            site += next.site;
            off += SHARE * next.off;
            all += breaks;
        }
        work::spend((sites / SITES_OF_A_STEP) as u64);
        let force = self.pull(position, SHARE * site, off);
        if side == 0.0 {
            return (force, force, all);
        }
        let strongest = self.parameters.initial_stiffness * self.limit;
        let mut mean = strongest * (sum / way * (side * SHARE));
        // Far from the start a way may be shorter than the digits of the places it ends at.
        if mean.re().is_nan() || mean.re().abs() > strongest.re() {
            mean = strongest * sign(mean.re());
        }
        (force, mean, all)
    }
}

impl<S: Scalar> FrictionLaw<S> for Bristle<S> {
    type State = BristleState<S>;
    type Trial = BristleTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = BristleParameters::<f64>::SPECS;
    const OPTIONAL: &'static [&'static str] = &["scatter", "seed"];
    const SENSITIVE: bool = true;
    const SUMMARY: &'static str = "twenty bristles that bond at random places, stretch and break";
    const SOURCE: &'static str = "Haessig, Friedland (1991), from memory; sites drawn once ours";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let p = BristleParameters::from_values(values);
        let mean = -(p.scatter * p.scatter / 12.0 - 0.5);
        let limit = p.coulomb / (p.initial_stiffness * mean);
        Self { parameters: p, limit, seed: p.seed.re().round() as u64 }
    }

    fn initial(&self) -> BristleState<S> {
        let bonds = [Bond { site: 0.0, off: 0.0 }; BRISTLES];
        let zero = S::constant(0.0);
        let grip = self.grip(&bonds);
        BristleState { position: zero, velocity: 0.0, bonds, grip, dry: zero, breaks: 0.0 }
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<BristleState<S>> {
        let mut read = EntryReader::new(entries);
        let mut state = self.initial();
        state.position = S::constant(read.number("position", false)?);
        state.velocity = read.number("velocity", false)?;
        let rows = read.pairs("sites")?;
        let good = |(i, row): (usize, &[f64; 2])| row[0] == i as f64 && row[1].fract() == 0.0;
        if rows.len() != BRISTLES || !rows.iter().enumerate().all(good) {
            return Err(Error::State {
                name: "sites".to_owned(),
                problem: format!(
                    "does not hold {BRISTLES} rows of a bristle from 0 on and a whole number"
                ),
            });
        }
        for (bristle, row) in rows.iter().enumerate() {
            state.bonds[bristle] = self.bond(bristle, row[1]);
        }
        state.grip = self.grip(&state.bonds);
        state.dry = S::constant(read.number("dry_friction", false)?);
        state.breaks = read.count("breakaways")? as f64;
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

    // One of twenty breaks in a way of δ/20: the reference integrator locates every break.
    fn fastest_rate(&self, state: &BristleState<S>) -> f64 {
        state.velocity.abs() / (SHARE * self.limit.re())
    }

    #[inline]
    fn force(&self, state: &BristleState<S>, velocity: S, channels: &Channels<S>) -> S {
        state.dry * channels.level + self.parameters.viscous * channels.viscous_level * velocity
    }

    #[inline]
    fn advance(
        &self,
        state: &BristleState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> BristleTrial<S> {
        let position = state.position + motion.displacement;
        let at = position.re() / self.limit.re();
        let grip = &state.grip;
        let (dry, balance, breaks) = if grip.behind <= at && at <= grip.ahead {
            let dry = self.pull(position, grip.site, grip.off);
            (dry, dry, 0.0)
        } else {
            let (dry, mean, breaks) = self.passed(state, position, motion.displacement);
            (dry, mean * 2.0 - state.dry, breaks)
        };
        let damping = self.parameters.viscous * channels.viscous_level;
        let stiffness = self.parameters.initial_stiffness * channels.level;
        BristleTrial {
            position,
            velocity: motion.velocity.re(),
            dry,
            breaks,
            located: false,
            outcome: Outcome {
                force: dry * channels.level + damping * motion.velocity,
                slope: stiffness * motion.duration + damping,
                damping,
            },
            balance: balance * channels.level,
        }
    }

    #[inline]
    fn outcome(&self, trial: &BristleTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    // A body that passes many breaks in a step feels their mean: the work along the way is exact.
    #[inline]
    fn undamped(&self, trial: &BristleTrial<S>, _velocity: S) -> S {
        trial.balance
    }

    // Where the body stays, so does the force.
    fn rest(
        &self,
        state: &BristleState<S>,
        channels: &Channels<S>,
        duration: S,
    ) -> Option<Rest<S, BristleTrial<S>>> {
        Some(Rest::still(self, state, channels, duration))
    }

    #[inline]
    fn commit(&self, state: &mut BristleState<S>, trial: &BristleTrial<S>) {
        state.position = trial.position;
        state.velocity = trial.velocity;
        state.dry = trial.dry;
        if trial.breaks > 0.0 {
            let at = trial.position.re() / self.limit.re();
            for (bristle, bond) in state.bonds.iter_mut().enumerate() {
                *bond = self.bonded(bristle, *bond, at);
            }
            state.grip = self.grip(&state.bonds);
            state.breaks = (state.breaks + trial.breaks).min(MOST_BREAKS);
        }
    }

    // Runge-Kutta's stages see a jump of the force or miss it: its steps end where bristles break.
    fn settle(
        &self,
        state: &BristleState<S>,
        motion: &Motion<S>,
        _internal: &[S; INTERNAL],
        channels: &Channels<S>,
    ) -> BristleTrial<S> {
        BristleTrial { located: true, ..self.advance(state, motion, channels) }
    }

    #[inline]
    fn event(
        &self,
        _state: &BristleState<S>,
        trial: &BristleTrial<S>,
        _motion: &Motion<S>,
    ) -> Option<Event> {
        (trial.located && trial.breaks > 0.0).then_some(Event::BreakAway)
    }

    fn margin(
        &self,
        state: &BristleState<S>,
        _trial: &BristleTrial<S>,
        motion: &Motion<S>,
        _event: Event,
    ) -> S {
        let at = (state.position + motion.displacement) / self.limit;
        let left =
            |(bristle, bond): (usize, &Bond)| -((at - self.place(bristle, *bond)).abs() - 1.0);
        let margins = state.bonds.iter().enumerate().map(left);
        margins.reduce(|a, b| if b.re() < a.re() { b } else { a }).unwrap_or(S::constant(0.0))
    }

    fn switch(&self, state: &mut BristleState<S>, _event: Event) {
        let at = state.position.re() / self.limit.re();
        for (bristle, bond) in state.bonds.iter_mut().enumerate() {
            let stretch = at - self.place(bristle, *bond).re();
            if stretch.abs() >= 1.0 - REACHED {
                *bond = self.bond(bristle, bond.site + sign(stretch));
                state.breaks = (state.breaks + 1.0).min(MOST_BREAKS);
            }
        }
        state.grip = self.grip(&state.bonds);
        state.dry = self.pull(state.position, state.grip.site, state.grip.off);
    }
}
