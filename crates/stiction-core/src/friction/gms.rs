//! The generalized Maxwell-slip model: elements that stick, and slide at a level that speed changes.

use super::elements::lag::{Followed, follow};
use super::elements::reachable::reachable;
use super::elements::slides::Slides;
use super::elements::stribeck::{SlidingLevel, check_levels};
use super::{
    Channels, Entry, EntryReader, FrictionLaw, LawState, Motion, Outcome, Rest, Statistics,
};
use crate::math::scalar::{Scalar, sign};
use crate::parameters;
use crate::support::error::{Error, Result};
use crate::support::parameter::ParameterSpec;

/// Elements of [`Gms`].
pub const ELEMENTS: usize = 8;

parameters! {
    /// Parameters of [`Gms`].
    pub struct GmsParameters {
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
        initial_stiffness: Stiffness, "slope right after a reversal, all elements sticking, k_0",
            default Value(3000.0), neutral None, typical 3000.0, bounds 1e-9, 1e15;
        yield_shape: One, "spread of the yield points: 1/2 even, 0 exponential, below 0 with a long tail, near 1 all at once, κ",
            default Value(0.0), neutral None, typical 0.2, bounds -2.0, 0.9;
        attraction: EffortRate, "rate at which sliding elements are drawn to their level, C",
            default Value(10.0), neutral None, typical 10.0, bounds 1e-9, 1e15;
        viscous: Damping, "friction per speed, σ",
            default Value(0.0), neutral Some(0.0), typical 0.05, bounds 0.0, 1e9;
    }
}

parameters! {
    /// What a contact of [`Gms`] may bring along.
    pub struct GmsStart {
        force: Effort, "force of the elements at the start, on the first loading curve; levels off from 98 % of F_s on, below F_s",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds -1e9, 1e9;
    }
}

/// Eight elements in parallel, each a spring until it reaches its share of the sliding level.
///
/// sticks: F_i' = k_i·v until |F_i| = α_i·s(v);  slips, until the motion turns round:
/// F_i' = sgn(v)·min(C·(α_i − |F_i|/s(v)), k_i·|v|);  s(v) = F_c + (F_s − F_c)·exp(−|v/v_s|^δ)
/// F = L·Σ_i F_i + σ·v;  k_i = k_0/8, α_i in proportion to y_i, v'(y_i) = 1 − (i − 1/2)/8 with
/// [`super::maxwell_slip::MaxwellSlip`]'s plain curve v' = (1 − κ·y)^(1/κ − 1)
///
/// At v = 0 every force stays where it is. Memory: the forces and which elements slip. Passive: the
/// source lets a slipping element gain force at C even where nothing moves; here it gains no faster
/// than its spring. Neutral: F_s = F_c, the Maxwell-slip model, whatever C is.
/// Source: Al-Bender, Lampaert, Swevers, IEEE Trans. Autom. Control 50 (2005); the bound by the
/// spring and the spread of the elements are ours.
#[derive(Debug, Clone)]
pub struct Gms<S> {
    parameters: GmsParameters<S>,
    level: SlidingLevel<S>,
    /// k_i.
    stiffness: S,
    /// α_i, the first to slip first.
    shares: [S; ELEMENTS],
}

/// One element; its force at level 1.
#[derive(Debug, Clone, Copy)]
pub struct GmsElement<S> {
    force: S,
    /// ±1 slips in that direction, 0 sticks.
    mode: f64,
}

/// State of [`Gms`].
#[derive(Debug, Clone, Copy)]
pub struct GmsState<S> {
    elements: [GmsElement<S>; ELEMENTS],
    slides: Slides,
}

/// A step of [`Gms`].
#[derive(Debug, Clone, Copy)]
pub struct GmsTrial<S> {
    after: GmsState<S>,
    outcome: Outcome<S>,
}

impl<S: Scalar> GmsState<S> {
    /// The same state over another number type.
    pub fn map<T: Scalar>(&self, convert: impl Fn(S) -> T) -> GmsState<T> {
        let elements = self
            .elements
            .map(|element| GmsElement { force: convert(element.force), mode: element.mode });
        GmsState { elements, slides: self.slides }
    }

    fn dry(&self) -> S {
        self.elements.iter().fold(S::constant(0.0), |sum, element| sum + element.force)
    }
}

impl<S: Scalar> LawState<S> for GmsState<S> {
    const OUTPUTS: &'static [&'static str] = &["dry_friction", "mode"];

    fn output(&self, index: usize) -> S {
        if index == 0 { self.dry() } else { S::constant(self.slides.mode) }
    }

    fn entries(&self) -> Vec<(&'static str, Entry)> {
        let rows = self.elements.iter().map(|e| [e.force.re(), e.mode]).collect();
        let mut entries = vec![("elements", Entry::Pairs(rows))];
        entries.extend(self.slides.entries());
        entries
    }

    fn statistics(&self) -> Statistics {
        self.slides.statistics()
    }
}

/// (e^x − 1)/x.
#[inline]
fn mean_growth<S: Scalar>(x: S) -> S {
    if x.re().abs() < 1e-4 {
        // The next term is below 1e-13 here.
        return (x / 3.0 + 1.0) * x * 0.5 + 1.0;
    }
    x.exp_m1() / x
}

/// A step seen along its motion, the same for all elements.
struct Course<S> {
    /// k_i·|Δx|.
    reach: S,
    duration: S,
    /// s at the start and at the end of the step.
    from: S,
    to: S,
    /// ∂s/∂|v| at a held velocity.
    steepness: S,
    /// C/s.
    rate: S,
    /// k_i·|v|·s/C: how far below its level an element gains as fast as its spring.
    short: S,
    /// ∂ of that by |v| at a held velocity.
    short_by_speed: S,
    /// 0 followed to 1 all the step long.
    whole: Followed<S>,
}

/// Where an element leaves its spring and follows its level.
struct Departure<S> {
    /// Share of the step that is over by then, and the force.
    gone: S,
    force: S,
    /// Their derivatives by |v| at a held velocity.
    gone_by_speed: S,
    force_by_speed: S,
}

impl<S: Scalar> Gms<S> {
    #[inline]
    fn course(&self, motion: &Motion<S>, distance: S) -> Course<S> {
        let (to, steepness) = self.level.at(motion.velocity);
        let held = motion.start_velocity.re() == motion.velocity.re();
        let from = if held { to } else { self.level.at(motion.start_velocity).0 };
        let middle = (from + to) * 0.5;
        let rate = self.parameters.attraction / middle;
        let pace = self.stiffness * distance / motion.duration;
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        Course {
            reach: self.stiffness * distance,
            duration: motion.duration,
            from,
            to,
            steepness,
            rate,
            short: pace / rate,
            short_by_speed: self.stiffness / rate + pace * steepness / self.parameters.attraction,
            whole: follow(zero, zero, one, rate * motion.duration),
        }
    }

    /// Where an element with this force along the motion starts to follow its level, if it does.
    #[inline]
    fn departure(
        &self,
        along: S,
        slips: bool,
        share: S,
        course: &Course<S>,
    ) -> Option<Departure<S>> {
        let risen = share * course.steepness;
        let zero = S::constant(0.0);
        if slips {
            let force = share * (course.from + course.to) * 0.5 - course.short;
            let room = force - along;
            if room.re() > 0.0 {
                let gone = room / course.reach;
                let force_by_speed = risen - course.short_by_speed;
                let spring = self.stiffness * course.duration;
                let gone_by_speed = (force_by_speed - spring * gone) / course.reach;
                let found = Departure { gone, force, gone_by_speed, force_by_speed };
                return (gone.re() < 1.0).then_some(found);
            }
        } else {
            let room = share * course.from - along;
            if room.re() > 0.0 {
                // Both the force and its level move on at an even pace.
                let gone = room / (course.reach + share * (course.from - course.to));
                let force = along + course.reach * gone;
                let found = Departure { gone, force, gone_by_speed: zero, force_by_speed: risen };
                return (gone.re() > 0.0 && gone.re() <= 1.0).then_some(found);
            }
        }
        Some(Departure { gone: zero, force: along, gone_by_speed: zero, force_by_speed: zero })
    }

    /// Force along the motion, its derivative by |v| at a held velocity, and whether it slips. A call
    /// for each element: all of them as one function over rows of derivatives are more than compilers
    /// stand.
    #[inline(never)]
    fn moved(&self, along: S, slips: bool, share: S, course: &Course<S>) -> (S, S, bool) {
        let most = along + course.reach;
        let spring = self.stiffness * course.duration;
        let Some(left) = self.departure(along, slips, share, course) else {
            return (most, spring, slips);
        };
        let (start, target) = (share * course.from, share * course.to);
        let begun = start + (target - start) * left.gone;
        let rest = -(left.gone - 1.0);
        let way = course.duration * course.rate * rest;
        let followed = if left.gone.re() == 0.0 {
            course.whole
        } else {
            follow(S::constant(0.0), S::constant(0.0), S::constant(1.0), way)
        };
        let apart = left.force - begun;
        let value = begun + (target - begun) * followed.end_share + apart * followed.remainder;
        if value.re() > most.re() {
            return (most, spring, true);
        }
        let risen = share * course.steepness;
        let way_by_speed = -(course.duration * course.rate * left.gone_by_speed)
            - way * course.steepness / course.to;
        let by_speed =
            risen + (left.force_by_speed - risen - apart * way_by_speed) * followed.remainder;
        (value, by_speed, true)
    }
}

impl<S: Scalar> FrictionLaw<S> for Gms<S> {
    type State = GmsState<S>;
    type Trial = GmsTrial<S>;

    const PARAMETERS: &'static [ParameterSpec] = GmsParameters::<f64>::SPECS;
    const OPTIONAL: &'static [&'static str] =
        &["breakaway", "stribeck_velocity", "stribeck_exponent", "attraction"];
    const START: &'static [ParameterSpec] = GmsStart::<f64>::SPECS;
    const REMEMBERS: bool = true;
    const SUMMARY: &'static str = "elasto-slide elements whose level falls with speed: closing loops, frictional lag, Stribeck";
    const SOURCE: &'static str = "Al-Bender, Lampaert, Swevers, IEEE Trans. Autom. Control 50 (2005); passive by a bound of ours";

    fn build(values: &[S], _choices: &[usize]) -> Self {
        let p = GmsParameters::from_values(values);
        let level =
            SlidingLevel::new(p.coulomb, p.breakaway, p.stribeck_velocity, p.stribeck_exponent);
        // v' = u at y = (1 − u^(κ/(1 − κ)))/κ.
        let yields: [S; ELEMENTS] = std::array::from_fn(|i| {
            let sticking = 1.0 - (i as f64 + 0.5) / ELEMENTS as f64;
            let w = S::constant(-sticking.ln()) / -(p.yield_shape - 1.0);
            w * mean_growth(-(p.yield_shape * w))
        });
        let all = yields.iter().fold(S::constant(0.0), |sum, y| sum + *y);
        let shares = yields.map(|y| y / all);
        Self { parameters: p, level, stiffness: p.initial_stiffness / ELEMENTS as f64, shares }
    }

    fn check(values: &[f64]) -> Result<()> {
        let p = GmsParameters::from_values(values);
        check_levels(p.coulomb, p.breakaway)
    }

    fn initial(&self) -> GmsState<S> {
        let stuck = GmsElement { force: S::constant(0.0), mode: 0.0 };
        GmsState { elements: [stuck; ELEMENTS], slides: Slides::default() }
    }

    fn primed(&self, values: &[S]) -> GmsState<S> {
        let greatest = self.level.greatest();
        let force = reachable(GmsStart::from_values(values).force, greatest);
        let s = if force.re() < 0.0 { -1.0 } else { 1.0 };
        let mut left = force * s;
        let mut state = self.initial();
        for (i, element) in state.elements.iter_mut().enumerate() {
            // Those that have not yielded share what is left evenly.
            let even = left / (ELEMENTS - i) as f64;
            let most = greatest * self.shares[i];
            let borne = if even.re() < most.re() { even } else { most };
            element.force = borne * s;
            left -= borne;
        }
        state
    }

    fn restore(&self, entries: &[(String, Entry)]) -> Result<GmsState<S>> {
        let mut read = EntryReader::new(entries);
        let rows = read.pairs("elements")?;
        if rows.len() != ELEMENTS || !rows.iter().all(|row| [-1.0, 0.0, 1.0].contains(&row[1])) {
            return Err(Error::State {
                name: "elements".to_owned(),
                problem: "does not hold eight rows of a force and -1, 0 or 1".to_owned(),
            });
        }
        let mut state = self.initial();
        for (element, row) in state.elements.iter_mut().zip(rows) {
            *element = GmsElement { force: S::constant(row[0]), mode: row[1] };
        }
        state.slides = Slides::restore(&mut read)?;
        read.finish()?;
        Ok(state)
    }

    fn sliding_force(&self) -> S {
        self.level.greatest()
    }

    fn greatest_stiffness(&self) -> f64 {
        self.parameters.initial_stiffness.re()
    }

    fn greatest_damping(&self) -> f64 {
        self.parameters.viscous.re()
    }

    fn steepest_fall(&self) -> f64 {
        self.level.steepest_fall()
    }

    #[inline]
    fn force(&self, state: &GmsState<S>, velocity: S, channels: &Channels<S>) -> S {
        state.dry() * channels.level + self.parameters.viscous * channels.viscous_level * velocity
    }

    fn advance(
        &self,
        state: &GmsState<S>,
        motion: &Motion<S>,
        channels: &Channels<S>,
    ) -> GmsTrial<S> {
        let mut after = *state;
        let s = sign(motion.displacement.re());
        let (mut dry, mut by_speed) = (S::constant(0.0), S::constant(0.0));
        if s == 0.0 {
            // At the onset every element below its level is a spring.
            dry = state.dry();
            by_speed = self.parameters.initial_stiffness * motion.duration;
        } else {
            let course = self.course(motion, motion.displacement * s);
            for (element, share) in after.elements.iter_mut().zip(&self.shares) {
                let (along, slope, slips) =
                    self.moved(element.force * s, element.mode == s, *share, &course);
                *element = GmsElement { force: along * s, mode: if slips { s } else { 0.0 } };
                dry += element.force;
                by_speed += slope;
            }
        }
        let damping = self.parameters.viscous * channels.viscous_level;
        let coulomb = self.parameters.coulomb.re();
        after.slides = state.slides.after(motion.velocity.re(), dry.re(), coulomb);
        let outcome = Outcome {
            force: dry * channels.level + damping * motion.velocity,
            slope: by_speed * channels.level + damping,
            // The level falls with speed, and is left explicit.
            damping,
        };
        GmsTrial { after, outcome }
    }

    #[inline]
    fn outcome(&self, trial: &GmsTrial<S>) -> Outcome<S> {
        trial.outcome
    }

    // Where the body stays, so does the force.
    fn rest(
        &self,
        state: &GmsState<S>,
        channels: &Channels<S>,
        duration: S,
    ) -> Option<Rest<S, GmsTrial<S>>> {
        Some(Rest::still(self, state, channels, duration))
    }

    #[inline]
    fn commit(&self, state: &mut GmsState<S>, trial: &GmsTrial<S>) {
        *state = trial.after;
    }
}
