//! Motors.

use std::ffi::{c_char, c_int};

use stiction_core::motor::{Motor, MotorSpec};

use crate::boundary::{Problem, Status, bounded, duration, guarded, held, known, put, slice, word};
use crate::friction::Friction;
use crate::state;

/// A body with inertia, driven by an input and resisted by friction.
pub struct Machine(pub(crate) Motor);

/// Makes a motor at rest: J·x'' = gain·input + load − F. It takes a copy of the friction model, effects
/// and state included, and stands where that contact is: at 0 where it has no effects.
///
/// # Safety
/// `friction` is a live handle of this library that no other thread uses; `motor` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_motor_new(
    inertia: f64,
    gain: f64,
    friction: *mut Friction,
    motor: *mut *mut Machine,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let model = &unsafe { held(friction, "friction") }?.model;
        if motor.is_null() {
            return Err(Problem::Null("motor"));
        }
        let spec = MotorSpec::new(inertia, gain, model.spec().clone());
        let machine = Motor::with_contact(spec, model)?;
        // SAFETY: as promised by the caller.
        unsafe { put(motor, Box::into_raw(Box::new(Machine(machine))), "motor") }
    })
}

/// One sample with input and load held; position and velocity at its end. Allocates nothing but where
/// numbers are so large that the motion may run away; then it is refused, and nothing has changed.
///
/// # Safety
/// `motor` is a live handle of this library that no other thread uses; `position` and `velocity` may
/// be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_motor_step(
    motor: *mut Machine,
    input: f64,
    load: f64,
    dt: f64,
    position: *mut f64,
    velocity: *mut f64,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let machine = unsafe { held(motor, "motor") }?;
        if position.is_null() || velocity.is_null() {
            return Err(Problem::Null("position or velocity"));
        }
        let (input, load) = (bounded("input", input, f64::MAX)?, bounded("load", load, f64::MAX)?);
        let (x, v) = machine.0.step(input, load, duration(dt)?)?;
        // SAFETY: as promised by the caller.
        unsafe { put(position, x, "position").and_then(|()| put(velocity, v, "velocity")) }
    })
}

/// Sets the temperature in °C of the next steps; NaN where it is not known, as at first.
///
/// # Safety
/// `motor` is a live handle of this library that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_motor_set_temperature(
    motor: *mut Machine,
    temperature: f64,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let machine = unsafe { held(motor, "motor") }?;
        machine.0.set_temperature(known("temperature", temperature)?);
        Ok(())
    })
}

/// Switches the drive on, as at first, or off with 0, for the next steps.
///
/// # Safety
/// `motor` is a live handle of this library that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_motor_set_enabled(motor: *mut Machine, enabled: c_int) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        unsafe { held(motor, "motor") }?.0.set_enabled(enabled != 0);
        Ok(())
    })
}

/// What the position sensor reads where the motor is: its nearest count, or the position where it has no
/// counts.
///
/// # Safety
/// `motor` is a live handle of this library that no other thread uses; `reading` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_motor_measured(motor: *mut Machine, reading: *mut f64) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let running = unsafe { held(motor, "motor") }?.0.running();
        let read = running.machine.measured(running.run.position);
        // SAFETY: as promised by the caller.
        unsafe { put(reading, read, "reading") }
    })
}

/// Back to this position and velocity, with friction never moved.
///
/// # Safety
/// `motor` is a live handle of this library that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_motor_reset(
    motor: *mut Machine,
    position: f64,
    velocity: f64,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let machine = unsafe { held(motor, "motor") }?;
        let position = bounded("position", position, f64::MAX)?;
        Ok(machine.0.reset(position, bounded("velocity", velocity, 1e6)?)?)
    })
}

/// How many doubles the state takes at present.
///
/// # Safety
/// `motor` is a live handle of this library that no other thread uses; `length` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_motor_state_length(
    motor: *mut Machine,
    length: *mut usize,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let motor = unsafe { held(motor, "motor") }?;
        // SAFETY: as promised by the caller.
        unsafe { put(length, state::length(&motor.0.entries()), "length") }
    })
}

/// Copies the state into an array with room for `room` doubles.
///
/// # Safety
/// `motor` is a live handle of this library that no other thread uses; `values` has that room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_motor_get_state(
    motor: *mut Machine,
    values: *mut f64,
    room: usize,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let motor = unsafe { held(motor, "motor") }?;
        // SAFETY: as promised by the caller.
        unsafe { state::copy(&motor.0.entries(), values, room) }
    })
}

/// Goes on from a state that `stiction_motor_get_state` copied, of the same law and parameters.
///
/// # Safety
/// `motor` is a live handle of this library that no other thread uses; `values` holds `count` doubles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_motor_set_state(
    motor: *mut Machine,
    values: *const f64,
    count: usize,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let (motor, values) = unsafe { (held(motor, "motor")?, slice(values, count, "values")?) };
        let entries = state::read(&motor.0.entries(), values)?;
        Ok(motor.0.restore(&entries)?)
    })
}

/// One number of the state by its name, as `law.state` and `motor.state` have it in Python.
///
/// # Safety
/// `motor` is a live handle of this library that no other thread uses; `name` ends in a zero byte;
/// `value` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_motor_get_number(
    motor: *mut Machine,
    name: *const c_char,
    value: *mut f64,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let (motor, name) = unsafe { (held(motor, "motor")?, word(name, "name")?) };
        let number = state::number(&motor.0.entries(), name)?;
        // SAFETY: as promised by the caller.
        unsafe { put(value, number, "value") }
    })
}

/// Frees a handle; NULL is allowed.
///
/// # Safety
/// `motor` is NULL or a live handle of this library, which nobody uses from now on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_motor_free(motor: *mut Machine) {
    if !motor.is_null() {
        // SAFETY: it was made by `Box::into_raw` and is freed once, by the contract above.
        guarded(|| {
            drop(unsafe { Box::from_raw(motor) });
            Ok(())
        });
    }
}
