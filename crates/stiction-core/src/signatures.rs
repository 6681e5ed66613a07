//! What would change along a measured motion if an effect were there: exact derivatives by gains of
//! effects that a motor does not have.

use std::sync::{Mutex, PoisonError};

use stiction_dispatch::{Task, Width};

use crate::effects::{AnyEffect, EffectRecord, Effects, Hook, Passage, Situation, neutral_values};
use crate::interrupt;
use crate::kernel::RowKernel;
use crate::motor::{EffectSpec, MotorSpec, Running};
use crate::scalar::{COLUMNS, Dual, Scalar};
use crate::sensitivity::{EffortSensitivity, MeasuredMotion, Start, Target, columns, seeded};
use crate::traces::Traces;
use crate::trig;

/// Follows given positions and differentiates the efforts by every gain of effects that the motor
/// does not have, each at the gain 0 and at its own shape; rows in the order of the candidates and
/// of their gains.
///
/// The effects of a pass are neutral, so none of them sees the others, nor an effect of the same
/// name that the motor has. Passes share nothing: the result is the same for any number of threads.
pub fn signatures(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    candidates: &[EffectSpec],
    threads: usize,
) -> EffortSensitivity {
    let mut result = EffortSensitivity::zeros(gains_of(candidates).len(), motion);
    signatures_into(spec, start, motion, candidates, threads, None, result.rows(motion));
    result
}

/// The same, of measured minus needed effort seen through a kernel: all rows of the first gain,
/// then all of the next.
pub fn signature_columns(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    candidates: &[EffectSpec],
    kernel: &RowKernel<'_>,
    threads: usize,
) -> Vec<f64> {
    let number = gains_of(candidates).len();
    let mut values = vec![0.0; number * kernel.rows(motion.samples())];
    let targets = columns(&mut values, number, kernel);
    signatures_into(spec, start, motion, candidates, threads, Some(kernel), targets);
    values
}

/// Candidate and place among its parameters of every gain.
fn gains_of(candidates: &[EffectSpec]) -> Vec<(usize, usize)> {
    let gains = |effect: &'static EffectRecord| {
        let place = |gain: &&str| effect.parameters.iter().position(|p| p.name == *gain);
        effect.facts.gains.iter().filter_map(place)
    };
    candidates
        .iter()
        .enumerate()
        .flat_map(|(index, candidate)| gains(candidate.record).map(move |gain| (index, gain)))
        .collect()
}

fn signatures_into(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    candidates: &[EffectSpec],
    threads: usize,
    kernel: Option<&RowKernel<'_>>,
    targets: Vec<impl Target>,
) {
    let (mut direct, mut seeded) = (Vec::new(), Vec::new());
    for (place, target) in gains_of(candidates).into_iter().zip(targets) {
        let list = if acts_at_once(candidates[place.0].record) { &mut direct } else { &mut seeded };
        list.push((place, target));
    }
    if !direct.is_empty() {
        at_once(spec, start, motion, candidates, direct);
    }
    let work = Mutex::new(apart(seeded, candidates).into_iter());
    let next = || work.lock().unwrap_or_else(PoisonError::into_inner).next();
    let passes = || {
        let mut traces = Traces::new(motion.samples(), kernel);
        while let Some(mut pass) = next() {
            let places: Vec<(usize, usize)> = pass.iter().map(|(place, _)| *place).collect();
            let mut running = with_candidates(spec, start, candidates, &places);
            motion.differentiate(&mut running, traces.of(pass.len()), |column, begin, stretch| {
                pass[column].1.take(begin, stretch);
            });
        }
    };
    interrupt::shared(threads, passes);
}

/// A gain, by candidate and place, and where its traces go.
type Seeded<T> = ((usize, usize), T);

/// Gains dealt to passes: a contact relaxes in one way of a kind at a time, so candidates of one
/// effect that does so must not share a pass.
fn apart<T>(gains: Vec<Seeded<T>>, candidates: &[EffectSpec]) -> Vec<Vec<Seeded<T>>> {
    let alone = |index: usize| candidates[index].record.hooks.contains(&Hook::StateRelaxation);
    let mut passes: Vec<Vec<Seeded<T>>> = Vec::new();
    for gain in gains {
        let index = gain.0.0;
        let bars = |(other, _): &Seeded<T>| {
            let same = candidates[other.0].record.name == candidates[index].record.name;
            alone(index) && same && other.0 != index
        };
        match passes.iter_mut().find(|pass| pass.len() < COLUMNS && !pass.iter().any(bars)) {
            Some(pass) => pass.push(gain),
            None => passes.push(vec![gain]),
        }
    }
    passes
}

/// Whether an effect enters the efforts of a sample through that sample alone.
fn acts_at_once(record: &EffectRecord) -> bool {
    record.hooks.iter().all(|hook| match hook {
        Hook::FrictionLevel | Hook::AddedEffort | Hook::InputMap => true,
        Hook::InputDelay
        | Hook::InputRate
        | Hook::InputLag
        | Hook::SensorMap
        | Hook::StateRelaxation
        | Hook::SecondMass => false,
    })
}

/// Share of the usual input by which a gain of the input map is moved to see what it does; such maps
/// are made of straight pieces, so any small step gives the derivative.
const SMALL: f64 = 1e-6;

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
fn at_once<T: Target>(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    candidates: &[EffectSpec],
    targets: Vec<Seeded<T>>,
) {
    let along = Along::of(spec, start, motion);
    if interrupt::due() {
        return;
    }
    let number = motion.samples();
    let (mut needed, mut driven) = (vec![0.0; number], vec![0.0; number]);
    let mut fill = |unit: &Unit, wave: &[f64], target: &mut T| {
        let (needed, driven) = (&mut *needed, &mut *driven);
        let driven = if unit.driven.is_empty() { &mut driven[..0] } else { driven };
        let rigid = along.rigid;
        Width::widest().run(Modulated { unit, wave, rigid, needed, driven });
        target.take(0, [needed, driven, &[]]);
    };
    let even = vec![1.0; number];
    let mut waves = Vec::new();
    for ((index, gain), mut target) in targets {
        if interrupt::due() {
            return;
        }
        let EffectSpec { record, values } = &candidates[index];
        match record.facts.wave() {
            None => fill(&along.unit(record, values, gain), &even, &mut target),
            Some(shape) => {
                let order = record.parameters.iter().position(|p| p.name == shape);
                let sine = record.facts.gains.last() == Some(&record.parameters[gain].name);
                waves.push((order.map_or(0.0, |place| values[place]), record, sine, target));
            }
        }
    }
    // Effects of one order share their waves.
    waves.sort_by(|one, other| one.0.total_cmp(&other.0));
    let positions: Vec<f64> = along.samples.iter().map(|sample| sample.at.position).collect();
    let (mut cosines, mut sines) = (even, vec![0.0; number]);
    let mut carriers: Vec<(&str, Unit)> = Vec::new();
    let mut present = None;
    for (order, record, sine, mut target) in waves {
        if interrupt::due() {
            return;
        }
        if present != Some(order) {
            present = Some(order);
            trig::waves(order, &positions, &mut cosines, &mut sines);
        }
        let known = carriers.iter().position(|(name, _)| *name == record.name);
        let known = known.unwrap_or_else(|| {
            carriers.push((record.name, along.carrier(record)));
            carriers.len() - 1
        });
        fill(&carriers[known].1, if sine { &sines } else { &cosines }, &mut target);
    }
}

/// What a unit of a gain does in every sample.
struct Unit {
    /// To friction: by the levels, and by how a contact answers an effort.
    friction: Vec<f64>,
    /// Effort that is added; empty where there is none.
    added: Vec<f64>,
    /// What the drive gives; empty where there is none.
    driven: Vec<f64>,
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

/// The samples along a motion.
struct Along {
    samples: Vec<Sample>,
    /// Whether their friction is its mean over each of them.
    rigid: bool,
    /// Greatest command.
    usual: f64,
}

impl Along {
    fn of(spec: &MotorSpec, start: Start<'_>, motion: &MeasuredMotion<'_>) -> Self {
        let (samples, rigid) = samples_along(spec, start, motion);
        let usual = samples.iter().map(|sample| sample.command.abs()).fold(0.0, f64::max);
        Self { samples, rigid, usual }
    }

    /// What a unit of the gain at this place does, the other parameters as given.
    fn unit(&self, record: &EffectRecord, values: &[f64], gain: usize) -> Unit {
        let mapped = record.hooks.contains(&Hook::InputMap);
        let adds = record.hooks.contains(&Hook::AddedEffort);
        let unit = if mapped && self.usual > 0.0 { SMALL * self.usual } else { 1.0 };
        let mut own = values.to_vec();
        own[gain] = unit;
        let mut effects = Effects::new(AnyEffect::build(record.name, &own));
        let room = |wanted| Vec::with_capacity(if wanted { self.samples.len() } else { 0 });
        let mut found = Unit { friction: room(true), added: room(adds), driven: room(mapped) };
        for sample in &self.samples {
            effects.remember(&sample.passage);
            let (dry, viscous) = effects.sums(&sample.at);
            let (mut added, mut moved) = (0.0, 0.0);
            if adds {
                added = effects.effort(&sample.at) / unit;
                found.added.push(added);
            }
            if mapped {
                let input = effects.input(sample.command, &sample.at) - sample.command;
                moved = sample.gain * input / unit;
                found.driven.push(moved);
            }
            let levels = (dry - 1.0) * sample.by[0] + (viscous - 1.0) * sample.by[1];
            found.friction.push(levels / unit + (added + moved) * sample.by[2]);
        }
        found
    }

    /// What an effect that is proportional to a wave over position does where the wave is 1.
    fn carrier(&self, record: &EffectRecord) -> Unit {
        let place = |name: &str| record.parameters.iter().position(|p| p.name == name);
        let mut values = neutral_values(record);
        if let Some(order) = record.facts.wave().and_then(place) {
            values[order] = 0.0;
        }
        let cosine = record.facts.gains.first().and_then(|name| place(name));
        self.unit(record, &values, cosine.unwrap_or(0))
    }
}

/// The samples, and whether their friction is its mean over each of them.
fn samples_along(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
) -> (Vec<Sample>, bool) {
    let values: Vec<f64> = spec.parameters().into_iter().map(|(_, value)| value).collect();
    let mut running = seeded(spec, start, &values, &[]);
    let seeds = [1.0, 1.0, 0.0];
    let [level, viscous, effort] = std::array::from_fn(|k| Dual::variable(seeds[k], k));
    running.machine.effects.seed(level, viscous, effort);
    let drive = running.machine.drive;
    let mut before = (running.actual(motion.positions[0]), running.run.friction.re());
    let mut samples = Vec::with_capacity(motion.samples());
    let mut rigid = false;
    running.follow(motion, |k, efforts, there| {
        let (friction, at) = (efforts.friction, there.situation());
        rigid = efforts.mean.is_some();
        let mean = efforts.mean.unwrap_or(friction);
        let position = at.position.re();
        let (displacement, span) = (position - before.0, motion.dt.at(k));
        let passage = Passage { displacement, friction: before.1, span };
        before = (position, friction.re());
        let command = there.command().re();
        samples.push(Sample {
            at: Situation {
                position,
                velocity: at.velocity.re(),
                time: at.time.re(),
                path: at.path.re(),
                moved: at.moved.re(),
                load: at.load.re(),
                sliding: at.sliding.re(),
                temperature: at.temperature,
                wound: at.wound.re(),
                enabled: at.enabled,
            },
            passage,
            by: [mean.partial(0), mean.partial(1), mean.partial(2)],
            command,
            gain: if at.enabled { drive.slope(command, at.velocity.re()) } else { 0.0 },
        });
    });
    (samples, rigid)
}

/// The motor with the candidates of a pass, given as rows of candidate and place of its gain.
fn with_candidates(
    spec: &MotorSpec,
    start: Start<'_>,
    candidates: &[EffectSpec],
    rows: &[(usize, usize)],
) -> Running<Dual> {
    let mut extended = spec.clone();
    let mut places = Vec::with_capacity(rows.len());
    let mut end = spec.parameters().len();
    let (mut added, mut begin) = (None, end);
    for (index, gain) in rows {
        if added != Some(*index) {
            added = Some(*index);
            begin = end;
            end += candidates[*index].values.len();
            extended.effects.push(candidates[*index].clone());
        }
        places.push(begin + gain);
    }
    let values: Vec<f64> = extended.parameters().into_iter().map(|(_, value)| value).collect();
    seeded(&extended, start, &values, &places)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::EFFECTS;

    #[test]
    fn what_is_proportional_to_a_wave_is_its_carrier_times_the_wave() {
        let mut waves = 0;
        for record in EFFECTS {
            let Some(shape) = record.facts.wave() else { continue };
            waves += 1;
            let place = |name: &str| record.parameters.iter().position(|p| p.name == name).unwrap();
            let with = |gain: &str, order: f64| {
                let mut values = neutral_values(record);
                values[place(gain)] = 0.01;
                values[place(shape)] = order;
                let effects = Effects::new(AnyEffect::build(record.name, &values));
                move |position: f64| {
                    let mut at = Situation::resting();
                    at.position = position;
                    let (dry, viscous) = effects.levels(&at);
                    [dry - 1.0, viscous - 1.0, effects.effort(&at), effects.input(0.7, &at) - 0.7]
                }
            };
            let [cosine, sine] = record.facts.gains else { panic!("{}", record.name) };
            let carrier = with(cosine, 0.0);
            assert!(carrier(0.3).iter().any(|each| *each != 0.0), "{}", record.name);
            for (gain, wave) in [(cosine, f64::cos as fn(f64) -> f64), (sine, f64::sin)] {
                let whole = with(gain, 7.0);
                for position in [-2.0, 0.1, 40.0] {
                    for (found, carried) in whole(position).iter().zip(carrier(position)) {
                        let expected = carried * wave(7.0 * position);
                        assert!((found - expected).abs() < 1e-14, "{} {gain}", record.name);
                    }
                }
            }
        }
        assert!(waves >= 3);
    }
}
