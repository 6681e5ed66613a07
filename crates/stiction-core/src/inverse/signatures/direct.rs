//! Traces of effects that enter the efforts of a sample through that sample alone, stretch by stretch:
//! what all gains ask of a stretch stays in the cache, and a long motion takes no more room than a short
//! one.

use stiction_dispatch::{Task, Width};

use crate::inverse::follow::{Efforts, Whereabouts};
use crate::inverse::kernel::RowKernel;
use crate::inverse::sensitivity::{Start, Target, seeded};
use crate::inverse::traces::Reach;
use crate::math::scalar::{Dual, Scalar};
use crate::math::trig;
use crate::plant::effects::{
    AnyEffect, EffectRecord, Effects, Hook, Passage, Situation, neutral_values,
};
use crate::simulate::motor::{MotorSpec, Running};
use crate::support::interrupt;
use crate::support::motion::MeasuredMotion;

/// Share of the usual input by which a gain of the input map is moved to see what it does; such maps
/// are made of straight pieces, so any small step gives the derivative.
const SMALL: f64 = 1e-6;

/// A gain of an effect that acts at once, and where its traces go.
pub(super) struct Direct<'a, T> {
    pub record: &'static EffectRecord,
    /// Of all parameters of the effect.
    pub values: &'a [f64],
    /// Place among them.
    pub gain: usize,
    pub target: T,
}

/// What a sample holds for effects that act at once.
struct Sample {
    at: Situation<f64>,
    passage: Passage<f64>,
    /// ∂friction/∂(level of dry, of viscous friction, effort): a contact at rest answers an effort.
    by: [f64; 3],
    command: f64,
    /// ∂(effort of the drive)/∂command.
    gain: f64,
}

/// Traces of effects that act at once: what one unit of a gain adds to level, effort or input, times
/// the derivative by that. One pass carries the derivatives by the levels, whatever the number of
/// gains; and what is proportional to a wave over position is asked once, whatever the number of
/// orders.
pub(super) fn at_once<T: Target>(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    kernel: Option<&RowKernel<'_>>,
    gains: Vec<Direct<'_, T>>,
) {
    let usual = if gains.iter().any(|own| maps(own.record)) {
        greatest_command(spec, start, motion)
    } else {
        0.0
    };
    let values: Vec<f64> = spec.parameters().into_iter().map(|(_, value)| value).collect();
    let mut running = seeded(spec, start, &values, &[]);
    let seeds = [1.0, 1.0, 0.0];
    let [level, viscous, effort] = std::array::from_fn(|k| Dual::variable(seeds[k], k));
    running.machine.effects.seed(level, viscous, effort);
    let mut before = (running.actual(motion.positions[0]), running.run.friction.re());
    let drive = running.machine.drive;
    let number = motion.samples();
    let mut along = Along::new(gains, usual, Reach::of(number, kernel));
    running.follow(motion, |k, efforts, there| {
        let (sample, rigid) =
            sampled(k, motion, efforts, there, &mut before, |command, velocity| {
                drive.slope(command, velocity)
            });
        along.put(sample, rigid);
    });
    along.hand_over();
}

/// Whether an effect changes what the drive is commanded.
fn maps(record: &EffectRecord) -> bool {
    record.hooks.contains(&Hook::InputMap)
}

/// Greatest command along a motion.
fn greatest_command(spec: &MotorSpec, start: Start<'_>, motion: &MeasuredMotion<'_>) -> f64 {
    let values: Vec<f64> = spec.parameters().into_iter().map(|(_, value)| value).collect();
    let mut running = Running::new(spec, &values);
    running.resume(start.running);
    if let Some(primed) = start.primed {
        running.state = running.law.primed(primed);
    }
    let mut usual = 0.0_f64;
    running.follow(motion, |_, _, there| usual = usual.max(there.command().abs()));
    usual
}

/// A sample, and whether friction is its mean over it.
fn sampled(
    k: usize,
    motion: &MeasuredMotion<'_>,
    efforts: &Efforts<Dual>,
    there: &Whereabouts<'_, Dual>,
    before: &mut (f64, f64),
    slope: impl Fn(f64, f64) -> f64,
) -> (Sample, bool) {
    let (friction, at) = (efforts.friction, there.situation());
    let mean = efforts.mean.unwrap_or(friction);
    let position = at.position.re();
    let (displacement, span) = (position - before.0, motion.dt.at(k));
    let passage = Passage { displacement, friction: before.1, span };
    *before = (position, friction.re());
    let command = there.command().re();
    let sample = Sample {
        at: Situation {
            position,
            velocity: at.velocity.re(),
            time: at.time.re(),
            path: at.path.re(),
            moved: at.moved.re(),
            load: at.load.re(),
            motor: at.motor.re(),
            sliding: at.sliding.re(),
            transmitted: at.transmitted,
            temperature: at.temperature,
            wound: at.wound.re(),
            enabled: at.enabled,
        },
        passage,
        by: [mean.partial(0), mean.partial(1), mean.partial(2)],
        command,
        gain: if at.enabled { slope(command, at.velocity.re()) } else { 0.0 },
    };
    (sample, efforts.mean.is_some())
}

/// What a unit of a gain does in the samples of a stretch.
struct Unit {
    effects: Effects<f64>,
    /// By how much the gain is moved.
    size: f64,
    adds: bool,
    mapped: bool,
    /// To friction: by the levels, and by how a contact answers an effort.
    friction: Vec<f64>,
    /// Effort that is added; empty where there is none.
    added: Vec<f64>,
    /// What the drive gives; empty where there is none.
    driven: Vec<f64>,
}

impl Unit {
    /// Of the gain at this place, the other parameters as given.
    fn of(record: &'static EffectRecord, values: &[f64], gain: usize, usual: f64) -> Self {
        let mapped = maps(record);
        let size = if mapped && usual > 0.0 { SMALL * usual } else { 1.0 };
        let mut own = values.to_vec();
        own[gain] = size;
        Self {
            effects: Effects::new(AnyEffect::build(record.name, &own)),
            size,
            adds: record.hooks.contains(&Hook::AddedEffort),
            mapped,
            friction: Vec::new(),
            added: Vec::new(),
            driven: Vec::new(),
        }
    }

    /// Of an effect that is proportional to a wave over position, where the wave is 1.
    fn carrier(record: &'static EffectRecord, usual: f64) -> Self {
        let place = |name: &str| record.parameters.iter().position(|p| p.name == name);
        let mut values = neutral_values(record);
        if let Some(order) = record.facts.wave().and_then(place) {
            values[order] = 0.0;
        }
        let cosine = record.facts.gains.first().and_then(|name| place(name));
        Self::of(record, &values, cosine.unwrap_or(0), usual)
    }

    /// Takes the samples that follow those it has.
    fn extend(&mut self, samples: &[Sample]) {
        for sample in samples {
            self.effects.remember(&sample.passage);
            let (dry, viscous) = self.effects.sums(&sample.at);
            let (mut added, mut moved) = (0.0, 0.0);
            if self.adds {
                added = self.effects.effort(&sample.at) / self.size;
                self.added.push(added);
            }
            if self.mapped {
                let input = self.effects.input(sample.command, &sample.at) - sample.command;
                moved = sample.gain * input / self.size;
                self.driven.push(moved);
            }
            let levels = (dry - 1.0) * sample.by[0] + (viscous - 1.0) * sample.by[1];
            self.friction.push(levels / self.size + (added + moved) * sample.by[2]);
        }
    }

    /// Forgets the first samples.
    fn forget(&mut self, number: usize) {
        for values in [&mut self.friction, &mut self.added, &mut self.driven] {
            values.drain(..number.min(values.len()));
        }
    }
}

/// Traces of a gain whose unit comes and goes with a wave.
struct Modulated<'a> {
    unit: &'a Unit,
    wave: &'a [f64],
    rigid: bool,
    needed: &'a mut [f64],
    driven: &'a mut [f64],
}

impl Task for Modulated<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { unit, wave, rigid, needed, driven } = self;
        for ((needed, friction), wave) in needed.iter_mut().zip(&unit.friction).zip(wave) {
            *needed = friction * wave;
        }
        if rigid {
            // As `Running::follow_about` has it.
            for k in 1..needed.len() {
                needed[k - 1] = 0.5 * (needed[k - 1] + needed[k]);
            }
        }
        for ((needed, added), wave) in needed.iter_mut().zip(&unit.added).zip(wave) {
            *needed -= added * wave;
        }
        for ((driven, own), wave) in driven.iter_mut().zip(&unit.driven).zip(wave) {
            *driven = own * wave;
        }
    }
}

/// Where the unit of a gain is found: its own, or the carrier of an effect times a wave.
enum Kind {
    Plain,
    Wave { order: f64, sine: bool },
}

/// The samples along a motion, as far as they are still asked for, and what gains make of them.
struct Along<T> {
    /// Gains: those without a wave first, then those with one, by order.
    gains: Vec<(Kind, usize, T)>,
    units: Vec<Unit>,
    reach: Reach,
    /// Whether friction is its mean over each sample.
    rigid: bool,
    /// The first sample there is.
    begin: usize,
    /// Those that no unit has seen.
    fresh: Vec<Sample>,
    positions: Vec<f64>,
}

impl<T: Target> Along<T> {
    fn new(gains: Vec<Direct<'_, T>>, usual: f64, reach: Reach) -> Self {
        let mut units = Vec::new();
        let mut carriers: Vec<(&str, usize)> = Vec::new();
        let mut kinds = Vec::new();
        for Direct { record, values, gain, target } in gains {
            let Some(shape) = record.facts.wave() else {
                kinds.push((Kind::Plain, units.len(), target));
                units.push(Unit::of(record, values, gain, usual));
                continue;
            };
            let order = record.parameters.iter().position(|p| p.name == shape);
            let order = order.map_or(0.0, |place| values[place]);
            let sine = record.facts.gains.last() == Some(&record.parameters[gain].name);
            let known = carriers.iter().find(|(name, _)| *name == record.name);
            let unit = known.map_or(units.len(), |(_, place)| *place);
            if unit == units.len() {
                carriers.push((record.name, unit));
                units.push(Unit::carrier(record, usual));
            }
            kinds.push((Kind::Wave { order, sine }, unit, target));
        }
        // Effects of one order share their waves.
        kinds.sort_by(|(one, ..), (other, ..)| match (one, other) {
            (Kind::Plain, Kind::Plain) => std::cmp::Ordering::Equal,
            (Kind::Plain, Kind::Wave { .. }) => std::cmp::Ordering::Less,
            (Kind::Wave { .. }, Kind::Plain) => std::cmp::Ordering::Greater,
            (Kind::Wave { order, .. }, Kind::Wave { order: other, .. }) => order.total_cmp(other),
        });
        let (fresh, positions) = (Vec::new(), Vec::new());
        Self { gains: kinds, units, reach, rigid: false, begin: 0, fresh, positions }
    }

    /// Takes the next sample.
    fn put(&mut self, sample: Sample, rigid: bool) {
        self.rigid = rigid;
        self.positions.push(sample.at.position);
        self.fresh.push(sample);
        if self.positions.len() == self.reach.room() {
            self.hand_over();
        }
    }

    /// Hands over what is there, and keeps what is asked for again.
    fn hand_over(&mut self) {
        if self.positions.is_empty() || interrupt::due() {
            // After an interruption what was found is thrown away.
            self.forget(self.positions.len());
            return;
        }
        for unit in &mut self.units {
            unit.extend(&self.fresh);
        }
        let length = self.positions.len();
        let end = self.begin + length;
        // About the last sample there the next one tells, if there is any.
        let whole = end == self.reach.samples();
        let told = if self.rigid && !whole { length.saturating_sub(1) } else { length };
        let (mut needed, mut driven) = (vec![0.0; length], vec![0.0; length]);
        let (mut cosines, mut sines) = (vec![1.0; length], vec![0.0; length]);
        let even = vec![1.0; length];
        let mut present = None;
        for (kind, unit, target) in &mut self.gains {
            let unit = &self.units[*unit];
            let wave = match kind {
                Kind::Plain => &even,
                Kind::Wave { order, sine } => {
                    if present != Some(*order) {
                        present = Some(*order);
                        trig::waves(*order, &self.positions, &mut cosines, &mut sines);
                    }
                    if *sine { &sines } else { &cosines }
                }
            };
            let drives = if unit.driven.is_empty() { 0 } else { length };
            let (needed, driven) = (&mut *needed, &mut driven[..drives]);
            let rigid = self.rigid;
            Width::widest().run(Modulated { unit, wave, rigid, needed, driven });
            let driven: &[f64] = if drives == 0 { &[] } else { &driven[..told] };
            target.take(self.begin, [&needed[..told], driven, &[]]);
        }
        let kept = if whole { end } else { self.reach.kept_from(self.begin + told) };
        self.forget(kept - self.begin);
    }

    /// Forgets the first samples.
    fn forget(&mut self, number: usize) {
        self.begin += number;
        self.fresh.clear();
        self.positions.drain(..number);
        self.units.iter_mut().for_each(|unit| unit.forget(number));
    }
}
