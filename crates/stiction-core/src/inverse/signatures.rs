//! What would change along a measured motion if an effect were there: exact derivatives by gains of
//! effects that a motor does not have.

use std::sync::{Mutex, PoisonError};

use crate::inverse::kernel::RowKernel;
use crate::inverse::sensitivity::{EffortSensitivity, Start, Target, columns, seeded};
use crate::inverse::shoot::{Windows, shoot_response};
use crate::inverse::traces::Traces;
use crate::math::scalar::{COLUMNS, Dual};
use crate::plant::effects::{EffectRecord, Hook};
use crate::simulate::motor::{EffectSpec, MotorSpec, Running};
use crate::support::error::Result;
use crate::support::interrupt;
use crate::support::motion::MeasuredMotion;

mod direct;
mod windows;

use direct::{Direct, at_once};
use windows::{Answer, marks};

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
/// then all of the next. Of all places of the kernel, or of those `kept`, which rise: hundreds of
/// columns of a long motion take no more room than what is looked at of them.
pub fn signature_columns(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    candidates: &[EffectSpec],
    kernel: (&RowKernel<'_>, Option<&[usize]>),
    threads: usize,
) -> Vec<f64> {
    let number = gains_of(candidates).len();
    let (kernel, kept) = kernel;
    let rows = kept.map_or_else(|| kernel.rows(motion.samples()), <[usize]>::len);
    let mut values = vec![0.0; number * rows];
    let targets = columns(&mut values, number, kernel, motion.samples(), kept);
    signatures_into(spec, start, motion, candidates, threads, Some(kernel), targets);
    values
}

/// The sums of all windows (see [`Running::shoot`]), differentiated by every gain, of first order in two
/// places: what an effect adds is taken along the measured motion, and how the simulated motion answers
/// to an effort along its own, in so many parts of a window. All windows of the first gain, then all of
/// the next.
pub fn shoot_signatures(
    spec: &MotorSpec,
    start: Start<'_>,
    motion: &MeasuredMotion<'_>,
    windows: &Windows<'_>,
    candidates: &[EffectSpec],
    parts: usize,
    threads: usize,
) -> Result<Vec<f64>> {
    let (number, width) = (gains_of(candidates).len(), windows.number(motion.samples()));
    let response = shoot_response(spec, start, motion, windows, parts)?;
    let marks = marks(windows, &response, parts, width);
    let Windows { stride, weights } = *windows;
    let mean = &weights[weights.len().min(2)..];
    let kernel = RowKernel {
        mean,
        second: weights,
        every: stride,
        inertia: 1.0,
        held: false,
        smooth: false,
    };
    let mut values = vec![0.0; number * width];
    let targets = values.chunks_mut(width.max(1)).map(|values| Answer {
        marks: &marks,
        kernel: &kernel,
        values,
        done: 0,
        total: 0.0,
        ended: 0,
    });
    signatures_into(spec, start, motion, candidates, threads, Some(&kernel), targets.collect());
    Ok(values)
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
        let list = direct.into_iter().map(|((index, gain), target)| {
            let EffectSpec { record, values } = &candidates[index];
            Direct { record, values, gain, target }
        });
        at_once(spec, start, motion, kernel, list.collect());
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
    use crate::plant::effects::{AnyEffect, EFFECTS, Effects, Situation, neutral_values};

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
