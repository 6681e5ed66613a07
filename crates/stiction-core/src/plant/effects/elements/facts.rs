//! What the catalogue and diagnosis know of an effect.

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
    /// Lets the input change no faster than a limit.
    InputRate,
    /// Lets the effort follow the input gradually.
    InputLag,
    /// Changes what the position sensor reads.
    SensorMap,
    /// Lets the friction state relax: something that gives way in series with the law.
    StateRelaxation,
    /// Splits the inertia in two with a shaft or a gap between.
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
            Self::InputRate => "input rate",
            Self::InputLag => "input lag",
            Self::SensorMap => "sensor map",
            Self::StateRelaxation => "state relaxation",
            Self::SecondMass => "second mass",
        }
    }

    /// Whether it enters at the contact, or as an effort on the body: what a contact alone can have.
    pub const fn at_contact(self) -> bool {
        matches!(self, Self::FrictionLevel | Self::AddedEffort | Self::StateRelaxation)
    }
}

/// What the values on the grid of a shape parameter are measured in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Themselves.
    One,
    /// Way from the lowest usual speed of the session (0) to the highest (1), logarithmically.
    Speed,
    /// Greatest input of the session.
    Input,
    /// Periods over position: the grid is that which the range of motion can show.
    Order,
    /// Pre-sliding length of the contact: its friction over its initial stiffness.
    Presliding,
    /// Displacement within which the contact rests: its pre-sliding length, or a share of the range
    /// of motion where it has none.
    Resting,
    /// Friction of the contact per second.
    Loading,
    /// Width of the kernel through which motion and effort are seen.
    Kernel,
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
            Self::Input => "input",
            Self::Order => "order",
            Self::Presliding => "presliding",
            Self::Resting => "resting",
            Self::Loading => "loading",
            Self::Kernel => "kernel",
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
    /// Whether only a machine that turns can have it.
    pub rotary_only: bool,
}

impl EffectFacts {
    /// The shape that holds the order of a wave over position, where the two gains are amplitudes of
    /// its cosine and of its sine: such an effect is proportional to the wave.
    pub const fn wave(&self) -> Option<&'static str> {
        match (self.gains, self.shapes) {
            ([_, _], [Shape { parameter, scale: Scale::Order, .. }]) => Some(parameter),
            _ => None,
        }
    }
}
