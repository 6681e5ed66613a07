//! What makes a motor dear to simulate: the parameter to change where a call takes too much work.

use super::{MotorSpec, Running};
use crate::support::error::Error;
use crate::support::work::WITHIN_STEPS;

/// How much parts change with a parameter that is worth naming: with a power of it.
const LEAST_POWER: f64 = 0.1;
/// Parameters of the body, which come first.
const OF_THE_BODY: usize = 5;

impl MotorSpec {
    /// An error, where it is too much work with what of this motor is to be changed.
    pub(crate) fn blame(&self, mut error: Error) -> Error {
        if let Error::TooMuchWork { why, remedy, .. } | Error::TooManySteps { why, remedy, .. } =
            &mut error
        {
            let law = self.friction.record.name;
            *remedy = if *why == WITHIN_STEPS {
                format!("values nearer to the typical ones that `stiction laws {law}` shows, ")
            } else {
                self.dearest().map_or(String::new(), |change| format!("{change}, "))
            };
        }
        error
    }

    /// The parameter by which samples get cheaper most, and which way: what is stated of friction and
    /// effects goes before the body.
    fn dearest(&self) -> Option<String> {
        let (paths, values): (Vec<String>, Vec<f64>) = self.parameters().into_iter().unzip();
        // Of a second, so that whole parts are no matter.
        let cost = |values: &[f64]| Running::<f64>::new(self, values).cost_here(0.0, 1.0).ln();
        let now = cost(&values);
        let power = |place: usize| {
            [2.0_f64, 0.5].into_iter().find_map(|factor| {
                let mut changed = values.clone();
                changed[place] *= factor;
                self.allows(&changed).ok().map(|()| (cost(&changed) - now) / factor.ln())
            })
        };
        let mut best: Option<(usize, f64)> = None;
        for place in (OF_THE_BODY..paths.len()).chain(0..OF_THE_BODY) {
            let Some(power) = power(place).filter(|power| power.abs() > LEAST_POWER) else {
                continue;
            };
            if best.is_none_or(|(_, other)| power.abs() > 1.01 * other.abs()) {
                best = Some((place, power));
            }
        }
        best.map(|(place, power)| {
            let way = if power > 0.0 { "smaller" } else { "larger" };
            format!("a {way} {}", paths[place])
        })
    }
}
