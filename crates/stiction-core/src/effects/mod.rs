//! Effects: what a plant may do beside its friction law. The trait they fulfil and the one list.
//!
//! An effect is one file in this folder plus one line in [`effects!`] below. Every effect has a
//! neutral point at which it changes no bit, and hooks that say where it enters.

use crate::error::{Error, Result};
use crate::friction::{Entry, EntryReader};
use crate::parameter::{Default as DefaultValue, ParameterSpec};
use crate::scalar::Scalar;

/// Where an effect enters the plant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hook {
    /// Multiplies the friction level.
    FrictionLevel,
    /// Adds effort on the body.
    AddedEffort,
    /// Changes the way from input to effort.
    InputMap,
    /// Lets the input arrive late.
    InputDelay,
    /// Changes what the position sensor reads.
    SensorMap,
    /// Lets the friction state relax: a plastic module in series with the law.
    StateRelaxation,
    /// Splits the inertia in two with a shaft between.
    SecondMass,
}

impl Hook {
    /// The word used in the catalogue.
    pub const fn word(self) -> &'static str {
        match self {
            Self::FrictionLevel => "friction level",
            Self::AddedEffort => "added effort",
            Self::InputMap => "input map",
            Self::InputDelay => "input delay",
            Self::SensorMap => "sensor map",
            Self::StateRelaxation => "state relaxation",
            Self::SecondMass => "second mass",
        }
    }
}

/// Where the plant is when an effect is asked.
#[derive(Debug, Clone, Copy)]
pub struct Situation<S> {
    /// Position.
    pub position: S,
    /// Velocity.
    pub velocity: S,
    /// Time on the session clock.
    pub time: S,
    /// Path travelled since the session began.
    pub path: S,
}

/// Numbers that an effect carries from sample to sample.
pub const MEMORY: usize = 4;
/// What an effect remembers; which number means what is its own affair.
pub type Memory<S> = [S; MEMORY];

/// A sample that a contact went through, as an effect remembers it.
#[derive(Debug, Clone, Copy)]
pub struct Passage<S> {
    /// Displacement of the body.
    pub displacement: S,
    /// Friction before, at the end of the sample before.
    pub friction: S,
    /// Duration.
    pub span: S,
}

/// Change of the friction level: multipliers are 1 plus the sum of these.
#[derive(Debug, Clone, Copy)]
pub struct LevelChange<S> {
    /// Share added to the friction level.
    pub friction: S,
    /// Share added to viscous friction.
    pub viscous: S,
}

/// A plastic module in series with the friction law: it creeps under force until it has hardened,
/// and a slide renews it. See [`crate::friction::elements::plastic::Plastic`].
#[derive(Debug, Clone, Copy)]
pub struct Relaxation<S> {
    /// Creep under the force of slow sliding once it has ended; 0 is neutral.
    pub creep: S,
    /// Exponent by which it falls at lower forces.
    pub exponent: S,
    /// Rate.
    pub rate: S,
}

/// A second mass behind a shaft: it carries `share` of the inertia.
#[derive(Debug, Clone, Copy)]
pub struct SecondMass<S> {
    /// Compliance of the shaft; 0 is rigid and neutral.
    pub compliance: S,
    /// Share of the inertia beyond the shaft.
    pub share: S,
    /// Damping of the two masses swinging against each other, as a share of the critical one.
    pub damping_ratio: S,
}

/// A reading of the position sensor and its slope by the position, less 1.
#[derive(Debug, Clone, Copy)]
pub struct Reading<S> {
    /// What the sensor reads beyond the position.
    pub error: S,
    /// Slope of that by the position.
    pub slope: S,
}

/// What the values on the grid of a shape parameter are measured in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Themselves.
    One,
    /// Way from the lowest usual speed of the session (0) to the highest (1), logarithmically.
    Speed,
    /// Periods over position: the grid is that which the range of motion can show.
    Order,
    /// Pre-sliding length of the contact: its friction over its initial stiffness.
    Presliding,
    /// Friction of the contact per second.
    Loading,
    /// Length of the session, pauses included.
    Session,
    /// Path travelled in the session.
    Path,
}

impl Scale {
    /// The word used in the catalogue.
    pub const fn word(self) -> &'static str {
        match self {
            Self::One => "one",
            Self::Speed => "speed",
            Self::Order => "order",
            Self::Presliding => "presliding",
            Self::Loading => "loading",
            Self::Session => "session",
            Self::Path => "path",
        }
    }
}

/// A parameter in which an effect is not linear, with the values at which it is looked for.
#[derive(Debug, Clone, Copy)]
pub struct Shape {
    /// Which parameter.
    pub parameter: &'static str,
    /// What the grid is measured in.
    pub scale: Scale,
    /// Values tried; empty where the scale brings its own.
    pub grid: &'static [f64],
    /// Whether a refit varies it.
    pub fitted: bool,
}

/// What diagnosis needs to know of an effect.
#[derive(Debug, Clone, Copy)]
pub struct EffectFacts {
    /// One sentence: what it is.
    pub summary: &'static str,
    /// What follows for who runs the machine.
    pub means: &'static str,
    /// What to do about it, and where to look for its source.
    pub remedy: &'static str,
    /// Family of effects that look alike on ordinary data.
    pub class: &'static str,
    /// Coordinate in which the residual shows it.
    pub coordinate: &'static str,
    /// Channels that a recording must have, beyond input and position.
    pub channels: &'static [&'static str],
    /// Effects that imitate it.
    pub look_alikes: &'static [&'static str],
    /// Experiment that separates it from them.
    pub experiment: &'static str,
    /// Which of the experiments that `stiction plan` writes that is.
    pub plan: &'static str,
    /// Its parameters in which it is linear and which are 0 at the neutral point.
    pub gains: &'static [&'static str],
    /// Its other parameters, each with a grid.
    pub shapes: &'static [Shape],
    /// Parameters of a second wave, in the order of gains and shapes; empty where it has none.
    pub second: &'static [&'static str],
    /// Parameters of laws that are this effect: where a plant states one, the law has it already.
    pub law_terms: &'static [&'static str],
}

/// An effect: hooks that it does not use keep their neutral default.
pub trait Effect<S: Scalar>: Clone + std::fmt::Debug + Send + Sync {
    /// Parameters, in the order of [`Effect::build`]'s values. Gains default to 0.
    const PARAMETERS: &'static [ParameterSpec];
    /// Where it enters.
    const HOOKS: &'static [Hook];
    /// What diagnosis needs to know.
    const FACTS: EffectFacts;
    /// Whether the friction level depends on what happened before.
    const REMEMBERS: bool = false;

    /// The effect with these values.
    fn build(values: &[S]) -> Self;

    /// Share added to the friction levels.
    #[inline]
    fn level(&self, _at: &Situation<S>, _memory: &Memory<S>) -> LevelChange<S> {
        LevelChange { friction: S::constant(0.0), viscous: S::constant(0.0) }
    }
    /// What a contact remembers that was never moved.
    fn fresh(&self) -> Memory<S> {
        [S::constant(0.0); MEMORY]
    }
    /// Takes a sample into the memory.
    #[inline]
    fn remember(&self, _memory: &mut Memory<S>, _passage: &Passage<S>) {}
    /// Effort added on the body, positive along +x.
    #[inline]
    fn effort(&self, _at: &Situation<S>) -> S {
        S::constant(0.0)
    }
    /// What the input becomes.
    #[inline]
    fn input(&self, input: S, _at: &Situation<S>) -> S {
        input
    }
    /// How late the input arrives, in s. A delay that is there is followed even where it is 0, so
    /// that derivatives see it.
    fn delay(&self) -> Option<S> {
        None
    }
    /// What the sensor reads beyond the position.
    #[inline]
    fn sensor(&self, _position: S) -> Reading<S> {
        Reading { error: S::constant(0.0), slope: S::constant(0.0) }
    }
    /// The plastic module that it puts in series with the law.
    fn relaxation(&self) -> Option<Relaxation<S>> {
        None
    }
    /// The second mass that it adds.
    fn second_mass(&self) -> Option<SecondMass<S>> {
        None
    }
}

/// An effect as the catalogue knows it.
#[derive(Debug, Clone, Copy)]
pub struct EffectRecord {
    /// Canonical name.
    pub name: &'static str,
    /// Parameters.
    pub parameters: &'static [ParameterSpec],
    /// Where it enters.
    pub hooks: &'static [Hook],
    /// What diagnosis needs to know.
    pub facts: EffectFacts,
}

macro_rules! effects {
    ($($module:ident => $effect:ident,)*) => {
        $(pub mod $module;)*

        /// Any effect of the catalogue.
        #[derive(Debug, Clone)]
        pub enum AnyEffect<S: Scalar> {
            $(#[doc = stringify!($module)] $effect($module::$effect<S>),)*
        }

        /// Every effect, in the order of the list.
        pub const EFFECTS: &[EffectRecord] = &[$(EffectRecord {
            name: stringify!($module),
            parameters: <$module::$effect<f64> as Effect<f64>>::PARAMETERS,
            hooks: <$module::$effect<f64> as Effect<f64>>::HOOKS,
            facts: <$module::$effect<f64> as Effect<f64>>::FACTS,
        },)*];

        impl<S: Scalar> AnyEffect<S> {
            /// The effect called `name` with these values.
            pub fn build(name: &str, values: &[S]) -> Result<Self> {
                match name {
                    $(stringify!($module) => Ok(Self::$effect($module::$effect::build(values))),)*
                    _ => Err(unknown_effect(name)),
                }
            }

            fn remembers(&self) -> bool {
                match self {
                    $(Self::$effect(_) => <$module::$effect<S> as Effect<S>>::REMEMBERS,)*
                }
            }

            fn hooks(&self) -> &'static [Hook] {
                match self {
                    $(Self::$effect(_) => <$module::$effect<S> as Effect<S>>::HOOKS,)*
                }
            }
        }

        /// Runs an expression with the concrete effect.
        macro_rules! with_effect {
            ($any:expr, |$inner:ident| $body:expr) => {
                match $any { $(AnyEffect::$effect($inner) => $body,)* }
            };
        }
    };
}

effects! {
    cogging => Cogging,
    creep_hardening => CreepHardening,
    direction_asymmetry => DirectionAsymmetry,
    drive_deadband => DriveDeadband,
    dwell_strengthening => DwellStrengthening,
    encoder_eccentricity => EncoderEccentricity,
    input_delay => InputDelay,
    position_dependent_friction => PositionDependentFriction,
    rate_dependent_breakaway => RateDependentBreakaway,
    run_in => RunIn,
    shaft_compliance => ShaftCompliance,
    stribeck => Stribeck,
    torque_bias => TorqueBias,
    torque_constant_ripple => TorqueConstantRipple,
    viscous_quadratic => ViscousQuadratic,
    warm_up => WarmUp,
}

/// The record of the effect called `name`.
pub fn effect_record(name: &str) -> Result<&'static EffectRecord> {
    EFFECTS.iter().find(|effect| effect.name == name).ok_or_else(|| unknown_effect(name))
}

fn unknown_effect(name: &str) -> Error {
    Error::unknown("effect", name, EFFECTS.iter().map(|effect| effect.name))
}

/// The values at which an effect changes nothing: gains 0, the rest at their typical values.
pub fn neutral_values(record: &EffectRecord) -> Vec<f64> {
    record
        .parameters
        .iter()
        .map(|spec| match (spec.neutral, spec.default) {
            (Some(neutral), _) => neutral,
            (None, DefaultValue::Value(value)) => value,
            (None, DefaultValue::Ratio { otherwise, .. }) => otherwise,
        })
        .collect()
}

/// An effect on the friction level, with what it remembers.
#[derive(Debug, Clone)]
struct Level<S: Scalar> {
    effect: AnyEffect<S>,
    memory: Memory<S>,
}

/// The effects of a plant, sorted once by where they enter.
#[derive(Debug, Clone)]
pub struct Effects<S: Scalar> {
    levels: Vec<Level<S>>,
    efforts: Vec<AnyEffect<S>>,
    inputs: Vec<AnyEffect<S>>,
    sensors: Vec<AnyEffect<S>>,
    delay: Option<S>,
    relaxation: Option<Relaxation<S>>,
    second_mass: Option<SecondMass<S>>,
    remembers: bool,
    /// Levels without any effect: 1, and seeded where derivatives by a level are wanted.
    unit: (S, S),
}

impl<S: Scalar> Effects<S> {
    /// Name of what effects remember, as an entry of a state.
    pub const ENTRY: &'static str = "effect_memory";

    /// Sorts effects by hook. Delays add up; of several relaxations or second masses the last one
    /// counts.
    pub fn new(effects: impl IntoIterator<Item = AnyEffect<S>>) -> Self {
        let mut sorted = Self {
            levels: Vec::new(),
            efforts: Vec::new(),
            inputs: Vec::new(),
            sensors: Vec::new(),
            delay: None,
            relaxation: None,
            second_mass: None,
            remembers: false,
            unit: (S::constant(1.0), S::constant(1.0)),
        };
        for effect in effects {
            sorted.remembers |= effect.remembers();
            for hook in effect.hooks() {
                match hook {
                    Hook::FrictionLevel => {
                        let memory = with_effect!(&effect, |e| e.fresh());
                        sorted.levels.push(Level { effect: effect.clone(), memory });
                    }
                    Hook::AddedEffort => sorted.efforts.push(effect.clone()),
                    Hook::InputMap => sorted.inputs.push(effect.clone()),
                    Hook::InputDelay => {
                        let added = with_effect!(&effect, |e| e.delay());
                        let sum = |delay| sorted.delay.map_or(delay, |other| other + delay);
                        sorted.delay = added.map(sum).or(sorted.delay);
                    }
                    Hook::SensorMap => sorted.sensors.push(effect.clone()),
                    Hook::StateRelaxation => {
                        sorted.relaxation =
                            with_effect!(&effect, |e| e.relaxation()).or(sorted.relaxation);
                    }
                    Hook::SecondMass => {
                        sorted.second_mass =
                            with_effect!(&effect, |e| e.second_mass()).or(sorted.second_mass);
                    }
                }
            }
        }
        sorted
    }

    /// Multipliers of friction and of viscous friction.
    #[inline]
    pub fn levels(&self, at: &Situation<S>) -> (S, S) {
        let (mut friction, mut viscous) = self.unit;
        for level in &self.levels {
            let change = with_effect!(&level.effect, |e| e.level(at, &level.memory));
            friction += change.friction;
            viscous += change.viscous;
        }
        (friction, viscous)
    }

    /// Seeds the levels of dry and viscous friction, to differentiate by them.
    pub fn seed_levels(&mut self, friction: S, viscous: S) {
        self.unit = (friction, viscous);
    }

    /// Whether any effect remembers what happened before.
    #[inline]
    pub fn remembers(&self) -> bool {
        self.remembers
    }

    /// Takes a sample into all memories.
    #[inline]
    pub fn remember(&mut self, passage: &Passage<S>) {
        if self.remembers {
            for level in &mut self.levels {
                with_effect!(&level.effect, |e| e.remember(&mut level.memory, passage));
            }
        }
    }

    /// Back to a contact that was never moved.
    pub fn forget(&mut self) {
        for level in &mut self.levels {
            level.memory = with_effect!(&level.effect, |e| e.fresh());
        }
    }

    /// Takes over what the effects of another plant remember, which depends on no parameter of this
    /// one; effects beyond those of the other start afresh.
    pub fn resume(&mut self, other: &Effects<f64>) {
        for (level, other) in self.levels.iter_mut().zip(&other.levels) {
            level.memory = other.memory.map(S::constant);
        }
    }

    /// Memories as an entry of a state: rows of two numbers, as many for each effect.
    pub fn entry(&self) -> (&'static str, Entry) {
        let numbers = self.levels.iter().flat_map(|level| level.memory);
        let numbers: Vec<f64> = numbers.map(Scalar::re).collect();
        let (rows, _) = numbers.as_chunks::<2>();
        (Self::ENTRY, Entry::Pairs(rows.to_vec()))
    }

    /// Takes the memories from an entry of a state.
    pub fn restore(&mut self, read: &mut EntryReader<'_>) -> Result<()> {
        let rows = read.pairs(Self::ENTRY)?;
        let (given, wanted) = (rows.len(), self.levels.len() * MEMORY / 2);
        if given != wanted {
            let problem = format!("has {given} rows where the effects of this motor need {wanted}");
            return Err(Error::State { name: Self::ENTRY.to_owned(), problem });
        }
        let mut numbers = rows.as_flattened().iter();
        for slot in self.levels.iter_mut().flat_map(|level| &mut level.memory) {
            *slot = S::constant(numbers.next().copied().unwrap_or(0.0));
        }
        Ok(())
    }

    /// Sum of the added efforts.
    #[inline]
    pub fn effort(&self, at: &Situation<S>) -> S {
        let mut sum = S::constant(0.0);
        for effect in &self.efforts {
            sum += with_effect!(effect, |e| e.effort(at));
        }
        sum
    }

    /// What the input becomes.
    #[inline]
    pub fn input(&self, input: S, at: &Situation<S>) -> S {
        self.inputs.iter().fold(input, |input, effect| with_effect!(effect, |e| e.input(input, at)))
    }

    /// What the sensor reads.
    #[inline]
    pub fn sensor(&self, position: S) -> S {
        self.sensors
            .iter()
            .fold(position, |x, effect| x + with_effect!(effect, |e| e.sensor(x)).error)
    }

    /// Whether the sensor reads anything but the position.
    #[inline]
    pub fn misreads(&self) -> bool {
        !self.sensors.is_empty()
    }

    /// The position at which the sensor reads this.
    pub fn behind(&self, reading: S) -> S {
        self.sensors.iter().rev().fold(reading, |reading, effect| {
            with_effect!(effect, |e| behind(reading, |x| e.sensor(x)))
        })
    }

    /// How late the input arrives, where an effect delays it.
    pub fn delay(&self) -> Option<S> {
        self.delay
    }

    /// Plastic module in series with the law.
    pub fn relaxation(&self) -> Option<Relaxation<S>> {
        self.relaxation
    }

    /// Second mass behind a shaft.
    pub fn second_mass(&self) -> Option<SecondMass<S>> {
        self.second_mass
    }
}

/// Newton's iteration for the position behind a reading; the last pass carries the derivatives.
fn behind<S: Scalar>(reading: S, sensor: impl Fn(S) -> Reading<S>) -> S {
    let mut x = S::constant(reading.re());
    for _ in 0..50 {
        let read = sensor(x);
        let next = x - (x + read.error - reading) / (read.slope + 1.0);
        let moved = (next.re() - x.re()).abs();
        x = next;
        if moved <= 4.0 * f64::EPSILON * reading.re().abs() {
            break;
        }
    }
    let read = sensor(S::constant(x.re()));
    S::constant(x.re()) - (read.error + (x.re()) - reading) / (read.slope + 1.0)
}
