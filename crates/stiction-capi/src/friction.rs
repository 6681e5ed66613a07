//! Friction models.

use std::ffi::c_char;

use stiction_core::effects::EffectSpec;
use stiction_core::friction::Channels;
use stiction_core::model::{FrictionModel, LawSpec};

use crate::boundary::{
    Problem, Status, bounded, duration, guarded, held, known, numbers, put, slice, word,
};
use crate::state;

/// A friction law with its parameters and state, and with the effects that act at the contact.
pub struct Friction {
    pub(crate) model: FrictionModel,
    /// Temperature of the next steps in °C, where it is known.
    temperature: Option<f64>,
}

/// Greatest speed that a contact is moved at.
const FASTEST: f64 = 1e6;

/// Makes a contact that was never moved: `names` and `values` of `count` parameters, `options` and
/// `words` of `choices` options; what is not stated takes its default.
///
/// # Safety
/// All words end in a zero byte, all arrays are as long as stated (NULL where that is 0), and
/// `friction` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_friction_new(
    law: *const c_char,
    names: *const *const c_char,
    values: *const f64,
    count: usize,
    options: *const *const c_char,
    words: *const *const c_char,
    choices: usize,
    friction: *mut *mut Friction,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let law = unsafe { word(law, "law") }?;
        // SAFETY: as promised by the caller.
        let stated = unsafe { numbers(names, values, count) }?;
        // SAFETY: as promised by the caller.
        let (options, words) =
            unsafe { (slice(options, choices, "options")?, slice(words, choices, "words")?) };
        let mut chosen = Vec::with_capacity(choices);
        for (option, choice) in options.iter().zip(words) {
            // SAFETY: as promised by the caller.
            let (option, choice) = unsafe { (word(*option, "option")?, word(*choice, "word")?) };
            chosen.push((option.to_owned(), choice.to_owned()));
        }
        if friction.is_null() {
            return Err(Problem::Null("friction"));
        }
        let model = FrictionModel::new(LawSpec::new(law, &stated, &chosen)?);
        let made = Friction { model, temperature: None };
        // SAFETY: as promised by the caller.
        unsafe { put(friction, Box::into_raw(Box::new(made)), "friction") }
    })
}

/// Adds an effect at the contact, by its name, with `names` and `values` of `count` parameters; what is
/// not stated takes its default. The contact is then one that was never moved. Effects of a drive, of a
/// sensor and second masses are refused: no contact has them.
///
/// # Safety
/// `friction` is a live handle of this library that no other thread uses; all words end in a zero byte,
/// all arrays are as long as stated (NULL where that is 0).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_friction_add_effect(
    friction: *mut Friction,
    effect: *const c_char,
    names: *const *const c_char,
    values: *const f64,
    count: usize,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let (friction, effect) = unsafe { (held(friction, "friction")?, word(effect, "effect")?) };
        // SAFETY: as promised by the caller.
        let stated = unsafe { numbers(names, values, count) }?;
        let mut effects = friction.model.effects().to_vec();
        effects.push(EffectSpec::new(effect, &stated)?);
        friction.model = FrictionModel::with_effects(friction.model.spec().clone(), effects)?;
        Ok(())
    })
}

/// Sets the temperature in °C of the next steps; NaN where it is not known, as at first.
///
/// # Safety
/// `friction` is a live handle of this library that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_friction_set_temperature(
    friction: *mut Friction,
    temperature: f64,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        unsafe { held(friction, "friction") }?.temperature = known("temperature", temperature)?;
        Ok(())
    })
}

impl Friction {
    fn channels(&self, effort: f64, load: f64) -> Result<Channels<f64>, Problem> {
        let effort = bounded("effort", effort, f64::MAX)?;
        let load = bounded("load", load, f64::MAX)?;
        Ok(Channels { effort, load, temperature: self.temperature, ..Channels::default() })
    }
}

/// One sample at a held velocity; `force` is friction at its end, positive when it resists positive
/// motion. With effects it is all that resists motion at the contact: what they add is in it with its
/// sign turned round. `effort` is all other effort on the body, which a contact with true stick holds at
/// rest; `load` is the external part of it. Allocates nothing but where numbers are so large that the force
/// may be none; then it is refused, and nothing has changed.
///
/// # Safety
/// `friction` is a live handle of this library that no other thread uses; `force` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_friction_step(
    friction: *mut Friction,
    velocity: f64,
    dt: f64,
    effort: f64,
    load: f64,
    force: *mut f64,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let friction = unsafe { held(friction, "friction") }?;
        if force.is_null() {
            return Err(Problem::Null("force"));
        }
        let (velocity, dt) = (bounded("velocity", velocity, FASTEST)?, duration(dt)?);
        let channels = friction.channels(effort, load)?;
        let result = friction.model.step(velocity, dt, &channels)?;
        // SAFETY: as promised by the caller.
        unsafe { put(force, result, "force") }
    })
}

/// As `stiction_friction_step`, leaving the state as it is; `slope` is the derivative of the force by
/// the velocity at fixed dt. Allocates where the contact mode changes within the sample, and with effects.
///
/// # Safety
/// `friction` is a live handle of this library that no other thread uses; `force` and `slope` may be
/// written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_friction_trial(
    friction: *mut Friction,
    velocity: f64,
    dt: f64,
    effort: f64,
    load: f64,
    force: *mut f64,
    slope: *mut f64,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let friction = unsafe { held(friction, "friction") }?;
        if force.is_null() || slope.is_null() {
            return Err(Problem::Null("force or slope"));
        }
        let (velocity, dt) = (bounded("velocity", velocity, FASTEST)?, duration(dt)?);
        let channels = friction.channels(effort, load)?;
        let (result, steepness) = friction.model.trial(velocity, dt, &channels)?;
        // SAFETY: as promised by the caller.
        unsafe { put(force, result, "force").and_then(|()| put(slope, steepness, "slope")) }
    })
}

/// Accepts the last trial.
///
/// # Safety
/// `friction` is a live handle of this library that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_friction_commit(friction: *mut Friction) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let friction = unsafe { held(friction, "friction") }?;
        if friction.model.commit() {
            return Ok(());
        }
        Err(Problem::Refused("there is no trial to commit; call trial first".to_owned()))
    })
}

/// Back to a contact that was never moved.
///
/// # Safety
/// `friction` is a live handle of this library that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_friction_reset(friction: *mut Friction) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        unsafe { held(friction, "friction") }?.model.reset();
        Ok(())
    })
}

/// The same at this position, with this time on the session clock and this path behind it: what effects
/// go by.
///
/// # Safety
/// `friction` is a live handle of this library that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_friction_reset_at(
    friction: *mut Friction,
    position: f64,
    time: f64,
    path: f64,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let friction = unsafe { held(friction, "friction") }?;
        let position = bounded("position", position, f64::MAX)?;
        let (time, path) = (bounded("time", time, f64::MAX)?, bounded("path", path, f64::MAX)?);
        friction.model.reset_at(position, time, path);
        Ok(())
    })
}

/// How many doubles the state takes at present.
///
/// # Safety
/// `friction` is a live handle of this library that no other thread uses; `length` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_friction_state_length(
    friction: *mut Friction,
    length: *mut usize,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let friction = unsafe { held(friction, "friction") }?;
        // SAFETY: as promised by the caller.
        unsafe { put(length, state::length(&friction.model.entries()), "length") }
    })
}

/// Copies the state into an array with room for `room` doubles.
///
/// # Safety
/// `friction` is a live handle of this library that no other thread uses; `values` has that room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_friction_get_state(
    friction: *mut Friction,
    values: *mut f64,
    room: usize,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let friction = unsafe { held(friction, "friction") }?;
        // SAFETY: as promised by the caller.
        unsafe { state::copy(&friction.model.entries(), values, room) }
    })
}

/// Goes on from a state that `stiction_friction_get_state` copied, of the same law, effects and parameters.
///
/// # Safety
/// `friction` is a live handle of this library that no other thread uses; `values` holds `count` doubles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_friction_set_state(
    friction: *mut Friction,
    values: *const f64,
    count: usize,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let (friction, values) =
            unsafe { (held(friction, "friction")?, slice(values, count, "values")?) };
        let entries = state::read(&friction.model.entries(), values)?;
        Ok(friction.model.restore(&entries)?)
    })
}

/// One number of the state by its name, as `law.state` and `motor.state` have it in Python.
///
/// # Safety
/// `friction` is a live handle of this library that no other thread uses; `name` ends in a zero byte;
/// `value` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_friction_get_number(
    friction: *mut Friction,
    name: *const c_char,
    value: *mut f64,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let (friction, name) = unsafe { (held(friction, "friction")?, word(name, "name")?) };
        let number = state::number(&friction.model.entries(), name)?;
        // SAFETY: as promised by the caller.
        unsafe { put(value, number, "value") }
    })
}

/// Frees a handle; NULL is allowed.
///
/// # Safety
/// `friction` is NULL or a live handle of this library, which nobody uses from now on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_friction_free(friction: *mut Friction) {
    if !friction.is_null() {
        // SAFETY: it was made by `Box::into_raw` and is freed once, by the contract above.
        guarded(|| {
            drop(unsafe { Box::from_raw(friction) });
            Ok(())
        });
    }
}
