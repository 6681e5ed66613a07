//! Derivatives of a step by dual numbers: by its velocity, where the law does not tell that itself, by its
//! other inputs and by parameters.

use super::{Contact, FrictionModel};
use crate::friction::{Channels, Law};
use crate::math::scalar::{COLUMNS, Dual, Scalar};
use crate::support::error::Result;

/// Derivatives of the friction of a step, from a state that depends on nothing.
#[derive(Debug, Clone)]
pub struct Derivatives {
    /// The friction itself.
    pub friction: f64,
    /// By the velocity at fixed duration, as of a trial; by all other effort on the body; by the load at
    /// that effort.
    pub inputs: [f64; 3],
    /// By parameters, in the order of `FrictionModel::parameters`; by one that is infinite 0.
    pub parameters: Vec<f64>,
}

/// What a step is differentiated by.
#[derive(Clone, Copy, PartialEq)]
enum Seed {
    Velocity,
    Effort,
    Load,
    Parameter(usize),
}

const _: () = assert!(COLUMNS > 0);

impl FrictionModel {
    /// Friction of a step and its derivatives, leaving the contact as it is.
    pub fn derivatives(
        &self,
        velocity: f64,
        dt: f64,
        channels: &Channels<f64>,
    ) -> Result<Derivatives> {
        let (friction, slope) = self.clone().trial(velocity, dt, channels)?;
        let values: Vec<f64> = self.parameters().into_iter().map(|(_, value)| value).collect();
        let finite = (0..values.len()).filter(|place| values[*place].is_finite());
        let seeds: Vec<Seed> =
            [Seed::Effort, Seed::Load].into_iter().chain(finite.map(Seed::Parameter)).collect();
        let mut inputs = [slope, 0.0, 0.0];
        let mut parameters = vec![0.0; values.len()];
        for seeds in seeds.chunks(COLUMNS) {
            let found = self.differentiated(seeds, velocity, dt, channels);
            for (column, seed) in seeds.iter().enumerate() {
                let place = match seed {
                    Seed::Velocity => &mut inputs[0],
                    Seed::Effort => &mut inputs[1],
                    Seed::Load => &mut inputs[2],
                    Seed::Parameter(place) => &mut parameters[*place],
                };
                *place = found.partial(column);
            }
        }
        let all = inputs.iter().chain(&parameters);
        if !all.into_iter().all(|derivative| derivative.is_finite()) {
            return Err(self.out_of_range());
        }
        Ok(Derivatives { friction, inputs, parameters })
    }

    /// The slope of a step by dual numbers alone: of one that changes mode, which is rare, and of a contact
    /// in series with which something gives way.
    pub(super) fn slope_through_events(
        &self,
        velocity: f64,
        dt: f64,
        channels: &Channels<f64>,
    ) -> f64 {
        self.differentiated(&[Seed::Velocity], velocity, dt, channels).partial(0)
    }

    /// Friction of a step with its derivatives by up to [`COLUMNS`] seeds.
    fn differentiated(
        &self,
        seeds: &[Seed],
        velocity: f64,
        dt: f64,
        channels: &Channels<f64>,
    ) -> Dual {
        let number = |seed: Seed, value: f64| match seeds.iter().position(|own| *own == seed) {
            Some(column) => Dual::variable(value, column),
            None => Dual::constant(value),
        };
        let (law, mut contact) = self.lifted(|place, value| number(Seed::Parameter(place), value));
        let channels = Channels {
            effort: number(Seed::Effort, channels.effort),
            load: number(Seed::Load, channels.load),
            ..lifted(channels)
        };
        let velocity = number(Seed::Velocity, velocity);
        contact.advance(&law, velocity, Dual::constant(dt), &channels)
    }

    /// What effects make of the slope of a step within one contact mode: by what they let reach the law,
    /// and by what they add. The slope of the law itself is not in it, for at rest it is what the law says
    /// it is and no derivative.
    pub(super) fn slope_by_effects(&self, velocity: f64, dt: f64, channels: &Channels<f64>) -> f64 {
        let (law, contact) = self.lifted(|_, value| Dual::constant(value));
        let Some(mut effects) = contact.effects else { return 0.0 };
        let (span, held) = (Dual::constant(dt), Dual::constant(velocity));
        let reach = effects.advance(Dual::variable(velocity, 0), span, &lifted(channels));
        let through = reach.quiet_step(&law, &contact.state, held, span, effects.relaxes());
        through.map_or(0.0, |(_, found)| found.force.partial(0)) - reach.added.partial(0)
    }

    /// Law and present contact, whose state depends on nothing; `number` makes a number of the place and
    /// the value of a parameter.
    fn lifted(&self, number: impl Fn(usize, f64) -> Dual) -> (Law<Dual>, Contact<Dual>) {
        let values = self.spec.values.iter().enumerate().map(|(k, v)| number(k, *v));
        let law = self.spec.law(&values.collect::<Vec<Dual>>());
        let mut place = self.spec.values.len();
        let mut contact = Contact::new(&law, &self.effects, |value| {
            place += 1;
            number(place - 1, value)
        });
        contact.state = self.contact.state.lift();
        if let (Some(lifted), Some(own)) = (&mut contact.effects, &self.contact.effects) {
            lifted.resume(own);
        }
        (law, contact)
    }
}

fn lifted(channels: &Channels<f64>) -> Channels<Dual> {
    Channels {
        effort: Dual::constant(channels.effort),
        load: Dual::constant(channels.load),
        level: Dual::constant(channels.level),
        viscous_level: Dual::constant(channels.viscous_level),
        temperature: channels.temperature,
    }
}
