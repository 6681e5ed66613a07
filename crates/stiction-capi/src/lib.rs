//! C interface of stiction-core: friction models and motors behind opaque handles.
//!
//! The only crate with unsafe code: it reads pointers that a C caller gives. Every function checks
//! them for NULL, returns a status and lets no panic through. A handle belongs to one thread at a
//! time; handles are independent of each other, and messages are kept for each thread.

mod boundary;
mod friction;
mod machine;
mod plant;
mod state;

pub use boundary::Status;
pub use friction::Friction;
pub use machine::*;
pub use plant::*;

use std::ffi::{CStr, c_char};

const VERSION: &CStr =
    match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
        Ok(version) => version,
        Err(_) => c"",
    };

/// Version of the library. The text is static.
#[unsafe(no_mangle)]
pub extern "C" fn stiction_version() -> *const c_char {
    VERSION.as_ptr()
}

/// What the last refused call of this thread was about, in one sentence; empty before any. The text
/// is valid until the next refused call of this thread.
#[unsafe(no_mangle)]
pub extern "C" fn stiction_message() -> *const c_char {
    boundary::message()
}

#[cfg(test)]
mod tests {
    use std::ffi::CString;
    use std::ptr::{null, null_mut};

    use stiction_core::effects::{EFFECTS, EffectRecord, EffectSpec};
    use stiction_core::friction::Channels;
    use stiction_core::model::{FrictionModel, LawSpec};

    use super::friction::*;
    use super::machine::*;
    use super::*;

    fn said() -> String {
        // SAFETY: the message ends in a zero byte and lives until the next refused call.
        unsafe { CStr::from_ptr(stiction_message()) }.to_str().unwrap().to_owned()
    }

    fn contact() -> *mut Friction {
        let (mut friction, law) = (null_mut(), c"hsieh_pan".as_ptr());
        let (names, values) = ([c"breakaway".as_ptr()], [0.5]);
        let (options, words) = ([c"virgin_curve".as_ptr()], [c"same".as_ptr()]);
        // SAFETY: all arrays have one element, all words end in a zero byte.
        let made = unsafe {
            stiction_friction_new(
                law,
                names.as_ptr(),
                values.as_ptr(),
                1,
                options.as_ptr(),
                words.as_ptr(),
                1,
                &raw mut friction,
            )
        };
        assert_eq!(made, Status::Ok);
        friction
    }

    #[test]
    fn a_state_that_is_copied_goes_on_to_the_bit() {
        let (friction, mut motor, mut other) = (contact(), null_mut(), null_mut());
        let (mut x, mut v, mut length) = (0.0, 0.0, 0);
        // SAFETY: handles are live until they are freed, all targets are locals of this test.
        unsafe {
            assert_eq!(stiction_motor_new(0.0076, 1.0, friction, &raw mut motor), Status::Ok);
            assert_eq!(stiction_motor_new(0.0076, 1.0, friction, &raw mut other), Status::Ok);
            for k in 0..500 {
                let input = 0.3 * (f64::from(k) * 0.05).sin();
                stiction_motor_step(motor, input, 0.0, 1e-3, &raw mut x, &raw mut v);
            }
            assert_eq!(stiction_motor_state_length(motor, &raw mut length), Status::Ok);
            let mut state = vec![0.0; length];
            let short = stiction_motor_get_state(motor, state.as_mut_ptr(), length - 1);
            assert_eq!(short, Status::Refused);
            assert!(said().contains("room = "), "{}", said());
            let copied = stiction_motor_get_state(motor, state.as_mut_ptr(), length);
            assert_eq!(copied, Status::Ok);
            assert_eq!(stiction_motor_set_state(other, state.as_ptr(), length), Status::Ok);
            assert_eq!(stiction_motor_set_state(other, state.as_ptr(), 3), Status::Refused);
            let (mut y, mut w) = (0.0, 0.0);
            stiction_motor_step(motor, 0.1, 0.0, 1e-3, &raw mut x, &raw mut v);
            stiction_motor_step(other, 0.1, 0.0, 1e-3, &raw mut y, &raw mut w);
            assert_eq!((x, v), (y, w));
            let mut position = 0.0;
            let name = c"position".as_ptr();
            assert_eq!(stiction_motor_get_number(motor, name, &raw mut position), Status::Ok);
            assert_eq!(position, x);
            stiction_motor_reset(motor, 0.5, 0.0);
            stiction_motor_get_number(motor, name, &raw mut position);
            assert_eq!(position, 0.5);
            stiction_motor_free(motor);
            stiction_motor_free(other);
            stiction_friction_free(friction);
        }
    }

    /// A contact of any law with its defaults.
    fn any_contact(law: &str) -> *mut Friction {
        let (mut friction, law) = (null_mut(), CString::new(law).unwrap());
        let new = |law, none| {
            // SAFETY: the word ends in a zero byte, and there are no arrays.
            unsafe { stiction_friction_new(law, null(), null(), 0, null(), null(), 0, none) }
        };
        assert_eq!(new(law.as_ptr(), &raw mut friction), Status::Ok);
        friction
    }

    #[test]
    fn a_state_of_every_law_goes_on_to_the_bit_in_another_handle() {
        for record in stiction_core::friction::LAWS {
            let (friction, fresh) = (any_contact(record.name), any_contact(record.name));
            let (mut motor, mut other) = (null_mut(), null_mut());
            let (mut x, mut v, mut y, mut w, mut length) = (0.0, 0.0, 0.0, 0.0, 0);
            // SAFETY: handles are live until they are freed, all targets are locals of this test.
            unsafe {
                stiction_motor_new(0.0076, 1.0, friction, &raw mut motor);
                stiction_motor_new(0.0076, 1.0, fresh, &raw mut other);
                stiction_motor_reset(motor, 5.0, 0.0);
                for k in 0..400 {
                    let phase = f64::from(k) * 0.05;
                    stiction_motor_step(motor, phase.sin(), 0.0, 1e-3, &raw mut x, &raw mut v);
                    stiction_friction_step(friction, phase.cos(), 1e-3, 0.0, 0.0, &raw mut y);
                }
                stiction_motor_state_length(motor, &raw mut length);
                let mut state = vec![0.0; length];
                stiction_motor_get_state(motor, state.as_mut_ptr(), length);
                let set = stiction_motor_set_state(other, state.as_ptr(), length);
                assert_eq!(set, Status::Ok, "{}: {}", record.name, said());
                stiction_motor_get_number(other, c"position".as_ptr(), &raw mut y);
                assert_eq!(x, y, "{}", record.name);
                for _ in 0..100 {
                    stiction_motor_step(motor, 0.3, 0.0, 1e-3, &raw mut x, &raw mut v);
                    stiction_motor_step(other, 0.3, 0.0, 1e-3, &raw mut y, &raw mut w);
                    assert_eq!((x, v), (y, w), "{}", record.name);
                }
                stiction_friction_state_length(friction, &raw mut length);
                let mut state = vec![0.0; length];
                stiction_friction_get_state(friction, state.as_mut_ptr(), length);
                let set = stiction_friction_set_state(fresh, state.as_ptr(), length);
                assert_eq!(set, Status::Ok, "{}: {}", record.name, said());
                stiction_friction_step(friction, -0.1, 1e-3, 0.0, 0.0, &raw mut x);
                stiction_friction_step(fresh, -0.1, 1e-3, 0.0, 0.0, &raw mut y);
                assert_eq!(x, y, "{}", record.name);
                for handle in [motor, other] {
                    stiction_motor_free(handle);
                }
                for handle in [friction, fresh] {
                    stiction_friction_free(handle);
                }
            }
        }
    }

    /// Adds an effect with all of its parameters at their typical values.
    fn add(friction: *mut Friction, record: &EffectRecord) -> Status {
        let words = record.parameters.iter().map(|p| CString::new(p.name).unwrap());
        let words: Vec<CString> = words.collect();
        let names: Vec<*const c_char> = words.iter().map(|word| word.as_ptr()).collect();
        let values: Vec<f64> = record.parameters.iter().map(|p| p.typical).collect();
        let effect = CString::new(record.name).unwrap();
        // SAFETY: the handle is live, all words end in a zero byte, the arrays have one length.
        unsafe {
            stiction_friction_add_effect(
                friction,
                effect.as_ptr(),
                names.as_ptr(),
                values.as_ptr(),
                values.len(),
            )
        }
    }

    #[test]
    fn every_effect_at_a_contact_steps_as_in_the_core_and_goes_on_to_the_bit() {
        for law in stiction_core::friction::LAWS {
            let (friction, fresh) = (any_contact(law.name), any_contact(law.name));
            let mut specs = Vec::new();
            for record in EFFECTS {
                let given = add(friction, record);
                if record.at_contact() {
                    assert_eq!((given, add(fresh, record)), (Status::Ok, Status::Ok));
                    let typical = record.parameters.iter().map(|p| (p.name.to_owned(), p.typical));
                    let typical: Vec<(String, f64)> = typical.collect();
                    specs.push(EffectSpec::new(record.name, &typical).unwrap());
                    assert_eq!(add(friction, record), Status::Refused);
                    assert!(said().contains("stated twice"), "{}", said());
                } else {
                    assert_eq!(given, Status::Refused, "{}", record.name);
                    assert!(said().contains(record.name), "{}", said());
                }
            }
            let spec = LawSpec::new(law.name, &[], &[]).unwrap();
            let mut core = FrictionModel::with_effects(spec, specs).unwrap();
            core.reset_at(0.3, 2.0, 5.0);
            let (mut force, mut other, mut slope, mut length) = (0.0, 0.0, 0.0, 0);
            // SAFETY: handles are live until they are freed, all targets are locals of this test.
            unsafe {
                stiction_friction_set_temperature(friction, 40.0);
                stiction_friction_set_temperature(fresh, 40.0);
                stiction_friction_reset_at(friction, 0.3, 2.0, 5.0);
                for k in 0..300 {
                    let (v, dt) = (0.2 * (f64::from(k) * 0.05).sin(), 1e-3);
                    let (f, s) = (&raw mut force, &raw mut slope);
                    stiction_friction_trial(friction, v, dt, 0.1, 0.05, f, s);
                    stiction_friction_step(friction, v, dt, 0.1, 0.05, &raw mut other);
                    let temperature = Some(40.0);
                    let around =
                        Channels { effort: 0.1, load: 0.05, temperature, ..Channels::default() };
                    let (_, steepness) = core.trial(v, dt, &around).unwrap();
                    let wanted = core.step(v, dt, &around).unwrap();
                    assert_eq!((force, other, slope), (wanted, wanted, steepness), "{}", law.name);
                }
                stiction_friction_state_length(friction, &raw mut length);
                let mut state = vec![0.0; length];
                stiction_friction_get_state(friction, state.as_mut_ptr(), length);
                let set = stiction_friction_set_state(fresh, state.as_ptr(), length);
                assert_eq!(set, Status::Ok, "{}: {}", law.name, said());
                stiction_friction_step(friction, -0.1, 1e-3, 0.0, 0.0, &raw mut force);
                stiction_friction_step(fresh, -0.1, 1e-3, 0.0, 0.0, &raw mut other);
                assert_eq!(force, other, "{}", law.name);
                let (mut motor, mut x, mut y, mut v) = (null_mut(), 0.0, 0.0, 0.0);
                assert_eq!(stiction_motor_new(0.01, 1.0, friction, &raw mut motor), Status::Ok);
                stiction_friction_get_number(friction, c"position".as_ptr(), &raw mut x);
                stiction_motor_get_number(motor, c"position".as_ptr(), &raw mut y);
                assert!(x == y && x != 0.0, "{}", law.name);
                stiction_motor_set_temperature(motor, 40.0);
                let went = stiction_motor_step(motor, 0.3, 0.0, 1e-4, &raw mut x, &raw mut v);
                assert_eq!(went, Status::Ok, "{}", said());
                stiction_motor_free(motor);
                for handle in [friction, fresh] {
                    stiction_friction_free(handle);
                }
            }
        }
    }

    #[test]
    fn what_is_no_effect_or_no_temperature_is_refused() {
        let friction = any_contact("coulomb");
        // SAFETY: the handle is live until it is freed; NULL is checked for.
        unsafe {
            let add = |effect| stiction_friction_add_effect(friction, effect, null(), null(), 0);
            assert_eq!(add(c"coging".as_ptr()), Status::Refused);
            assert!(said().contains("did you mean 'cogging'"), "{}", said());
            assert_eq!(add(null()), Status::Null);
            assert_eq!(stiction_friction_set_temperature(friction, f64::INFINITY), Status::Refused);
            assert_eq!(stiction_friction_set_temperature(friction, f64::NAN), Status::Ok);
            let at = |x| stiction_friction_reset_at(friction, x, 0.0, 0.0);
            assert_eq!((at(f64::NAN), at(0.5)), (Status::Refused, Status::Ok));
            assert_eq!(stiction_friction_reset_at(null_mut(), 0.0, 0.0, 0.0), Status::Null);
            stiction_friction_free(friction);
        }
    }

    #[test]
    fn a_motion_that_runs_away_is_refused_and_nothing_has_changed() {
        let (friction, mut motor) = (any_contact("coulomb"), null_mut());
        let (mut x, mut v, mut force) = (0.5, 0.5, 0.5);
        // SAFETY: handles are live until they are freed, all targets are locals of this test.
        unsafe {
            stiction_motor_new(1e-5, 100.0, friction, &raw mut motor);
            let away = stiction_motor_step(motor, 1e308, 0.0, 1e-4, &raw mut x, &raw mut v);
            assert_eq!(away, Status::Refused);
            assert!(said().contains("ran away"), "{}", said());
            assert_eq!((x, v), (0.5, 0.5));
            stiction_motor_get_number(motor, c"velocity".as_ptr(), &raw mut v);
            assert_eq!(v, 0.0);
            let step = |effort, force| {
                stiction_friction_step(friction, 0.1, 1e-3, effort, f64::MAX, force)
            };
            let status = step(f64::MAX, &raw mut force);
            assert!(force.is_finite() && (status == Status::Ok || force == 0.5));
            stiction_motor_free(motor);
            stiction_friction_free(friction);
        }
    }

    #[test]
    fn a_trial_changes_nothing_until_it_is_committed() {
        let friction = contact();
        let (mut tried, mut slope, mut force) = (0.0, 0.0, 0.0);
        // SAFETY: the handle is live until it is freed, all targets are locals of this test.
        unsafe {
            assert_eq!(stiction_friction_commit(friction), Status::Refused);
            let (t, s) = (&raw mut tried, &raw mut slope);
            assert_eq!(stiction_friction_trial(friction, 1e-3, 1e-2, 0.0, 0.0, t, s), Status::Ok);
            stiction_friction_step(friction, 1e-3, 1e-2, 0.0, 0.0, &raw mut force);
            assert_eq!(tried, force);
            assert!(slope > 0.0);
            stiction_friction_reset(friction);
            stiction_friction_trial(friction, 1e-3, 1e-2, 0.0, 0.0, t, s);
            assert_eq!(stiction_friction_commit(friction), Status::Ok);
            let name = c"spring_force".as_ptr();
            stiction_friction_get_number(friction, name, &raw mut force);
            assert!(force > 0.0);
            stiction_friction_free(friction);
        }
    }

    #[test]
    fn what_cannot_be_done_is_refused_with_a_sentence() {
        let (friction, mut force) = (contact(), f64::NAN);
        let target = &raw mut force;
        // SAFETY: the handle is live until it is freed; NULL is checked for.
        unsafe {
            let step = |velocity, dt, target| {
                stiction_friction_step(friction, velocity, dt, 0.0, 0.0, target)
            };
            assert_eq!(step(f64::NAN, 1e-3, target), Status::Refused);
            assert!(said().starts_with("velocity = NaN"), "{}", said());
            assert_eq!(step(0.1, 0.0, target), Status::Refused);
            assert_eq!(step(1e7, 1e-3, target), Status::Refused);
            assert_eq!(step(0.1, 1e-3, null_mut()), Status::Null);
            assert!(said().starts_with("force is NULL"), "{}", said());
            assert!(force.is_nan());
            assert_eq!(
                stiction_friction_step(null_mut(), 0.1, 1e-3, 0.0, 0.0, target),
                Status::Null
            );
            let unknown = stiction_friction_get_number(friction, c"colour".as_ptr(), target);
            assert_eq!(unknown, Status::Refused);
            assert!(said().contains("hardening"), "{}", said());
            let mut none = null_mut();
            let no_law =
                |law, none| stiction_friction_new(law, null(), null(), 0, null(), null(), 0, none);
            assert_eq!(no_law(c"glue".as_ptr(), &raw mut none), Status::Refused);
            assert_eq!(no_law(null(), &raw mut none), Status::Null);
            assert_eq!(no_law(c"\xff".as_ptr(), &raw mut none), Status::Refused);
            assert!(none.is_null());
            stiction_friction_free(friction);
            stiction_friction_free(null_mut());
        }
    }

    #[test]
    fn no_panic_gets_beyond_the_boundary() {
        assert_eq!(boundary::guarded(|| panic!("as if")), Status::Internal);
        assert!(said().contains("report"), "{}", said());
    }
}
