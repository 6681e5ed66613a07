//! Drive: from a recording's input to effort.

use std::collections::VecDeque;
use std::ops::Mul;

use crate::friction::{Entry, EntryReader};
use crate::math::scalar::Scalar;
use crate::plant::servo::{Servo, within};
use crate::support::error::{Error, Result};

/// Gain and limit of the drive, and the servo in it where it has one.
#[derive(Debug, Clone, Copy)]
pub struct Drive<S> {
    /// Effort per unit of input; of a servo per ampere.
    pub gain: S,
    /// Greatest magnitude of the input that gets through; infinite means no limit.
    pub limit: f64,
    /// What makes an effort of a goal position.
    pub servo: Option<Servo>,
}

impl<S: Scalar> Drive<S> {
    /// Effort for what it is commanded: an input, or the voltage of a servo.
    #[inline]
    pub fn effort(&self, command: S, velocity: S) -> S {
        match &self.servo {
            None => self.direct(command),
            Some(servo) => self.gain * servo.current(self.gain, command, velocity),
        }
    }

    /// Effort for an input that no servo stands before.
    #[inline(always)]
    pub fn direct<N: Scalar>(&self, input: N) -> S
    where
        S: Mul<N, Output = S>,
    {
        self.gain * within(input, self.limit)
    }

    /// Effort per unit of the command.
    pub fn slope(&self, command: f64, velocity: f64) -> f64 {
        let gain = self.gain.re();
        match &self.servo {
            None if command.abs() <= self.limit => gain,
            Some(servo) if servo.current(gain, command, velocity).abs() < servo.current_limit => {
                gain / servo.resistance
            }
            None | Some(_) => 0.0,
        }
    }
}

/// Stretches that differ by less than this share of a sample or of the delay are equal: sums of
/// durations carry round-off, and a sliver would turn a derivative to the wrong side of its kink.
const ROUND_OFF: f64 = 1e-9;

/// A delay and the inputs that are on their way through it.
///
/// Inputs are data, plain numbers; only the delay is a parameter. What waits always spans the
/// delay, so a sample costs the same however long that is.
#[derive(Debug)]
pub struct DelayLine<S> {
    delay: S,
    /// The input that arrived last.
    arrived: f64,
    /// Value and duration of the inputs on their way, oldest first.
    waiting: VecDeque<[f64; 2]>,
}

// A derived Clone would leave no spare room, and the next sample of the copy would allocate.
impl<S: Clone> Clone for DelayLine<S> {
    fn clone(&self) -> Self {
        let mut waiting = VecDeque::with_capacity(self.waiting.capacity());
        waiting.extend(&self.waiting);
        Self { delay: self.delay.clone(), arrived: self.arrived, waiting }
    }
}

impl<S: Scalar> DelayLine<S> {
    /// Name of its entry in a state.
    pub const ENTRY: &'static str = "input_history";

    /// A delay through which nothing has passed yet.
    pub fn new(delay: S) -> Self {
        let mut line = Self { delay, arrived: 0.0, waiting: VecDeque::new() };
        line.clear();
        line
    }

    /// Forgets all inputs: before, they were 0.
    pub fn clear(&mut self) {
        self.arrived = 0.0;
        self.waiting.clear();
        if self.delay.re() > 0.0 {
            self.waiting.push_back([0.0, self.delay.re()]);
        }
    }

    /// Takes over the inputs on their way through another line of the same delay.
    pub fn resume<T>(&mut self, other: &DelayLine<T>) {
        self.arrived = other.arrived;
        self.waiting.clone_from(&other.waiting);
    }

    /// Takes in the input of a sample and gives the mean of what arrives during it.
    #[inline(never)] // motors without a delay are not to carry it through their loop
    pub fn pass(&mut self, input: f64, dt: f64) -> S {
        let before = self.arrived;
        self.waiting.push_back([input, dt]);
        let mean = self.mean_of_next(dt);
        // Mean of u over t₀−τ to t₁−τ: a longer delay takes in what came before at one end and
        // leaves out what came last at the other.
        self.delay.chain(mean, (before - self.arrived) / dt)
    }

    /// Derivatives by the inputs, of those by what comes out in each sample: an input is a part of
    /// the mean of a sample as long as it comes out during it.
    fn carry_back(&self, late: &[f64], spans: &[f64]) -> Vec<f64> {
        let mut edges = vec![0.0];
        for (k, span) in spans.iter().enumerate() {
            edges.push(edges[k] + span);
        }
        let delay = self.delay.re();
        let carried = |k: usize| {
            let (from, to) = (edges[k] + delay, edges[k + 1] + delay);
            let first = edges.partition_point(|edge| *edge <= from) - 1;
            let during = (first..late.len()).take_while(|j| edges[*j] < to);
            during.map(|j| late[j] * (to.min(edges[j + 1]) - from.max(edges[j])) / spans[j]).sum()
        };
        (0..late.len()).map(carried).collect()
    }

    fn mean_of_next(&mut self, dt: f64) -> f64 {
        let nearly = ROUND_OFF * dt.min(self.delay.re());
        let mut left = dt;
        // −0 is the neutral element of a sum, to the bit.
        let mut mean = -0.0;
        while let Some([value, duration]) = self.waiting.front_mut() {
            let (value, beyond) = (*value, *duration - left);
            self.arrived = value;
            if beyond > nearly {
                *duration = beyond;
                return mean + value * (left / dt);
            }
            if beyond >= -nearly {
                self.waiting.pop_front();
                return mean + value * (left / dt);
            }
            mean += value * (*duration / dt);
            left -= *duration;
            self.waiting.pop_front();
        }
        mean
    }

    /// The inputs as an entry of a state: rows of value and duration, first the input that arrived
    /// last, whose duration is over.
    pub fn entry(&self) -> (&'static str, Entry) {
        let rows = std::iter::once([self.arrived, 0.0]).chain(self.waiting.iter().copied());
        (Self::ENTRY, Entry::Pairs(rows.collect()))
    }

    /// Takes the inputs from an entry of a state.
    pub fn restore(&mut self, read: &mut EntryReader<'_>) -> Result<()> {
        let rows = read.pairs(Self::ENTRY)?;
        let bad = |problem: String| Err(Error::State { name: Self::ENTRY.to_owned(), problem });
        let [[arrived, 0.0], waiting @ ..] = rows else {
            return bad("does not begin with the input that arrived last, of duration 0".to_owned());
        };
        let span: f64 = waiting.iter().map(|row| row[1]).sum();
        let delay = self.delay.re();
        if waiting.iter().any(|row| row[1] <= 0.0) || (span - delay).abs() > 1e-6 * delay + 1e-9 {
            return bad(format!("spans {span} s where the delay is {delay} s"));
        }
        self.arrived = *arrived;
        self.waiting.clear();
        self.waiting.extend(waiting);
        Ok(())
    }
}

/// An input that changes no faster than a limit, and how far it has come.
#[derive(Debug, Clone, Copy)]
pub struct RateLimit<S> {
    /// Time for one unit of a change.
    slowness: S,
    /// How far it has come; none before the first sample, which is where it starts.
    reached: Option<S>,
}

impl<S: Scalar> RateLimit<S> {
    /// Name of its entry in a state.
    pub const ENTRY: &'static str = "limited_input";

    /// A limit that nothing has passed yet.
    pub fn new(slowness: S) -> Self {
        Self { slowness, reached: None }
    }

    /// Takes in the input of a sample and gives the mean over it of what comes nearer to it at a
    /// constant rate: u − Δ·T/(2·dt) where it gets there within T = |Δ|·slowness, and half of the way
    /// that it makes where it does not.
    #[inline(never)] // motors without a limit are not to carry it through their loop
    pub fn pass(&mut self, input: S, dt: f64) -> S {
        let Some(before) = self.reached else {
            self.reached = Some(input);
            return input;
        };
        let missing = input - before;
        let needed = missing.abs() * self.slowness;
        if needed.re() <= dt {
            self.reached = Some(input);
            let short = missing * needed / (2.0 * dt);
            // No limit changes no bit, and shows its derivative.
            return if short.re() == 0.0 { input - short.chain(0.0, 1.0) } else { input - short };
        }
        let made = S::constant(if missing.re() < 0.0 { -dt } else { dt }) / self.slowness;
        self.reached = Some(before + made);
        before + made * 0.5
    }

    fn entry(&self) -> (&'static str, Entry) {
        let row = self.reached.map(|reached| [reached.re(), 0.0]);
        (Self::ENTRY, Entry::Pairs(row.into_iter().collect()))
    }

    fn restore(&mut self, read: &mut EntryReader<'_>) -> Result<()> {
        self.reached = match read.pairs(Self::ENTRY)? {
            [] => None,
            [[reached, _], ..] => Some(S::constant(*reached)),
        };
        Ok(())
    }
}

/// A first-order lag of the input and what has come through it.
#[derive(Debug, Clone, Copy)]
pub struct Lag<S> {
    time: S,
    followed: S,
}

impl<S: Scalar> Lag<S> {
    /// Name of its entry in a state.
    pub const ENTRY: &'static str = "lagged_input";

    /// A lag that nothing has passed yet.
    pub fn new(time: S) -> Self {
        Self { time, followed: S::constant(0.0) }
    }

    /// Takes in the input of a sample and gives the mean over it of what follows it:
    /// u + (i − u)·(T/dt)·(1 − e^(−dt/T)), i as it was before.
    #[inline(never)] // motors without a lag are not to carry it through their loop
    pub fn pass(&mut self, input: S, dt: f64) -> S {
        let behind = self.followed - input;
        if self.time.re() <= 0.0 {
            self.followed = input;
            // No lag changes no bit, and shows its derivative: x + (−0) is x, also where that is −0.
            return input + self.time.chain(-0.0, behind.re() / dt);
        }
        let share = S::constant(dt) / self.time;
        let gone = -((-share).exp_m1());
        self.followed = input - behind * (gone - 1.0);
        input + behind * gone / share
    }
}

/// What the input passes on its way to the drive: a delay, then a limit of its rate, then a lag.
#[derive(Debug, Clone)]
pub struct Way<S> {
    delay: Option<DelayLine<S>>,
    rate: Option<RateLimit<S>>,
    lag: Option<Lag<S>>,
}

impl<S: Scalar> Way<S> {
    /// The way through a delay, a limit of the rate and a lag, where there are any.
    pub fn new(delay: Option<S>, slowness: Option<S>, lag: Option<S>) -> Self {
        Self {
            delay: delay.map(DelayLine::new),
            rate: slowness.map(RateLimit::new),
            lag: lag.map(Lag::new),
        }
    }

    /// Mean of what arrives during a sample, with something that comes to it behind the delay.
    #[inline]
    pub fn pass(&mut self, input: f64, more: Option<S>, dt: f64) -> S {
        let late = match &mut self.delay {
            None => S::constant(input),
            Some(line) => line.pass(input, dt),
        };
        let late = more.map_or(late, |more| late + more);
        let limited = match &mut self.rate {
            None => late,
            Some(rate) => rate.pass(late, dt),
        };
        match &mut self.lag {
            None => limited,
            Some(lag) => lag.pass(limited, dt),
        }
    }

    /// Derivatives by the inputs, of those by what comes out of the delay in each sample.
    pub fn carry_back(&self, late: Vec<f64>, spans: &[f64]) -> Vec<f64> {
        match &self.delay {
            None => late,
            Some(line) => line.carry_back(&late, spans),
        }
    }

    /// Forgets all inputs: before, they were 0.
    pub fn clear(&mut self) {
        if let Some(line) = &mut self.delay {
            line.clear();
        }
        if let Some(rate) = &mut self.rate {
            rate.reached = None;
        }
        if let Some(lag) = &mut self.lag {
            lag.followed = S::constant(0.0);
        }
    }

    /// Takes over what is on its way in another machine with the same delay.
    pub fn resume<T: Scalar>(&mut self, other: &Way<T>) {
        if let (Some(line), Some(other)) = (&mut self.delay, &other.delay) {
            line.resume(other);
        }
        if let (Some(rate), Some(other)) = (&mut self.rate, &other.rate) {
            rate.reached = other.reached.map(|reached| S::constant(reached.re()));
        }
        if let (Some(lag), Some(other)) = (&mut self.lag, &other.lag) {
            lag.followed = S::constant(other.followed.re());
        }
    }

    /// Names that its entries in a state may have.
    pub const NAMES: [&'static str; 3] =
        [DelayLine::<f64>::ENTRY, RateLimit::<f64>::ENTRY, Lag::<f64>::ENTRY];

    /// What is on the way, as entries of a state.
    pub fn entries(&self) -> impl Iterator<Item = (&'static str, Entry)> {
        let delay = self.delay.as_ref().map(DelayLine::entry);
        let lag = self.lag.as_ref();
        let lag = lag.map(|lag| (Lag::<S>::ENTRY, Entry::Number(lag.followed.re())));
        let rate = self.rate.as_ref().map(RateLimit::entry);
        delay.into_iter().chain(rate).chain(lag)
    }

    /// Takes what is on the way from the entries of a state.
    pub fn restore(&mut self, read: &mut EntryReader<'_>) -> Result<()> {
        if let Some(line) = &mut self.delay {
            line.restore(read)?;
        }
        if let Some(rate) = &mut self.rate {
            rate.restore(read)?;
        }
        if let Some(lag) = &mut self.lag {
            lag.followed = S::constant(read.number(Lag::<S>::ENTRY, false)?);
        }
        Ok(())
    }
}

/// What of the input reaches the drive during a sample, with something that comes to it behind a
/// delay.
#[inline(always)]
pub(crate) fn arriving<S: Scalar>(
    way: &mut Option<&mut Way<S>>,
    input: f64,
    more: Option<S>,
    dt: f64,
) -> S {
    match way {
        None => more.map_or(S::constant(input), |more| more + input),
        Some(way) => way.pass(input, more, dt),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar::Dual;

    /// Inputs and durations that repeat in no period.
    fn samples() -> Vec<(f64, f64)> {
        (0..400)
            .map(|k| {
                let k = f64::from(k);
                ((0.7 * k).sin() + (0.013 * k * k).cos(), 1e-3 * (1.1 + (1.7 * k).sin()))
            })
            .collect()
    }

    /// Integral of the held inputs up to a time; 0 before the first.
    fn integral(samples: &[(f64, f64)], time: f64) -> f64 {
        let mut start = 0.0;
        samples
            .iter()
            .map(|(value, duration)| {
                let covered = (time - start).clamp(0.0, *duration);
                start += duration;
                value * covered
            })
            .sum()
    }

    #[test]
    fn what_arrives_is_the_mean_of_the_delayed_input() {
        let samples = samples();
        for delay in [0.0, 1e-5, 4e-4, 2e-3, 0.0317, 5.0] {
            let mut line = DelayLine::new(Dual::variable(delay, 0));
            let mut end = 0.0;
            for (input, dt) in &samples {
                let start = end;
                end += dt;
                let mean = |delay: f64| {
                    (integral(&samples, end - delay) - integral(&samples, start - delay)) / dt
                };
                let got = line.pass(*input, *dt);
                assert!((got.re() - mean(delay)).abs() < 1e-10, "{delay} {end}");
                let slope = (mean(delay + 1e-9) - mean(delay)) / 1e-9;
                assert!((Scalar::partial(got, 0) - slope).abs() < 2e-3 * (1.0 + slope.abs()));
            }
        }
    }

    #[test]
    fn no_delay_changes_no_bit_and_shows_its_derivative() {
        let mut line = DelayLine::new(Dual::variable(0.0, 3));
        let mut before = 0.0;
        for (input, dt) in samples().into_iter().chain([(-0.0, 1e-3), (0.0, 1e-3)]) {
            let got = line.pass(input, dt);
            assert_eq!(got.re().to_bits(), input.to_bits());
            assert_eq!(Scalar::partial(got, 3), (before - input) / dt);
            before = input;
        }
    }

    #[test]
    fn a_lag_passes_a_sine_as_its_response_says() {
        for time in [0.0, 1e-5, 3e-3, 0.05] {
            let (dt, w) = (1e-4, 60.0_f64);
            let mut lag = Lag::new(Dual::variable(time, 0));
            let response = |time: f64, t: f64| {
                let (real, imaginary) = (1.0, w * time);
                ((w * t).sin() * real - (w * t).cos() * imaginary) / (1.0 + imaginary * imaginary)
            };
            for k in 0..20_000 {
                let t = f64::from(k) * dt;
                // Held at the value in the middle: its mean over the sample, nearly.
                let middle = t + 0.5 * dt;
                let got = lag.pass(Dual::constant((w * middle).sin()), dt);
                if t > 1.0 {
                    assert!((got.re() - response(time, middle)).abs() < 1e-4, "{time} {t}");
                    let chord = (response(time + 1e-7, middle) - response(time, middle)) / 1e-7;
                    assert!((Scalar::partial(got, 0) - chord).abs() < 0.01 * w, "{time} {t}");
                }
            }
        }
    }

    #[test]
    fn a_delay_of_whole_samples_shifts_the_input() {
        for (dt, whole) in [(1e-3, 3), (1e-4, 20), (1e-4, 5000), (0.3, 1)] {
            let mut line = DelayLine::new(Dual::variable(dt * f64::from(whole), 0));
            let inputs: Vec<f64> = samples().iter().map(|(input, _)| *input).collect();
            let at = |k: usize, late: i32| {
                k.checked_sub(late as usize).map_or(0.0, |k| inputs[k % inputs.len()])
            };
            for k in 0..12_000 {
                let got = line.pass(at(k, 0), dt);
                assert!((got.re() - at(k, whole)).abs() < 1e-8);
                let slope = (at(k, whole + 1) - at(k, whole)) / dt;
                assert!((Scalar::partial(got, 0) - slope).abs() < 1e-8 / dt, "{dt} {whole} {k}");
            }
            assert!(line.waiting.len() <= whole as usize + 1);
        }
    }
}
