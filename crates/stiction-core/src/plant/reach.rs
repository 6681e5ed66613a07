//! What reaches the contact of a machine in a sample: compiled once, and not once for each law.

use stiction_dispatch::Task;

use super::effects::Situation;
use super::machine::Machine;
use crate::friction::Channels;
use crate::math::scalar::Scalar;

impl<S: Scalar> Machine<S> {
    /// What reaches the contact, and the effort of the drive and the rest of it but the load, to places
    /// that hold what was there before.
    ///
    /// `at` is where the plant is, from [`Machine::at_contact`] on; its load is brought up to date.
    #[inline(never)]
    pub fn reach(
        &self,
        at: &mut Situation<S>,
        [input, load]: [&S; 2],
        channels: &mut Channels<S>,
        [driven, ambient]: [&mut S; 2],
    ) {
        S::run(Reaching { machine: self, at, input, load, channels, driven, ambient });
    }
}

/// The same as a task: rows of derivatives want the widest vectors, and nothing copied.
struct Reaching<'a, S: Scalar> {
    machine: &'a Machine<S>,
    at: &'a mut Situation<S>,
    input: &'a S,
    load: &'a S,
    channels: &'a mut Channels<S>,
    driven: &'a mut S,
    ambient: &'a mut S,
}

impl<S: Scalar> Task for Reaching<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { machine, at, input, load, channels, driven, ambient } = self;
        let effects = &machine.effects;
        let gravity = machine.body.gravity(at.position);
        at.load = at.carried(*load + gravity);
        *driven = if machine.drive.servo.is_some() {
            machine.driven(*input, at)
        } else if at.enabled {
            machine.drive.direct(effects.input_within(*input, at))
        } else {
            S::constant(0.0)
        };
        let added =
            if effects.adds_efforts() { effects.effort_within(at) } else { S::constant(0.0) };
        *ambient = gravity + added;
        channels.effort = *driven + *load + *ambient;
        at.motor = channels.effort - (*load + gravity);
        channels.load = at.load;
        (channels.level, channels.viscous_level) = effects.levels_within(at);
        channels.temperature = at.temperature;
    }
}
