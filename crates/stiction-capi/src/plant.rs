//! Motors from plant files.

use std::f64::consts::PI;
use std::ffi::c_char;
use std::sync::LazyLock;

use stiction_core::effects::{EffectSpec, Hook};
use stiction_core::error::Error;
use stiction_core::friction::law_record;
use stiction_core::model::LawSpec;
use stiction_core::motor::{Motor, MotorSpec};
use stiction_core::servo::Servo;
use toml::{Table, Value};

use crate::boundary::{Problem, Status, guarded, put, word};
use crate::machine::Machine;

/// m/s², as a payload of a plant file is weighed.
const GRAVITY: f64 = 9.80665;
const TABLES: [&str; 7] =
    ["motion", "drive", "body", "friction", "effects", "sensor", "controller"];
const BODY: [&str; 6] =
    ["inertia", "gravity_amplitude", "gravity_zero_rad", "weight_n", "payload_kg", "payload_m"];
/// Keys of a servo beside its torque constant, and what the core calls them.
const SERVO: [(&str, &str); 7] = [
    ("proportional", "proportional"),
    ("integral", "integral"),
    ("derivative", "derivative"),
    ("duty_limit", "duty_limit"),
    ("supply_v", "supply"),
    ("resistance_ohm", "resistance"),
    ("current_limit_a", "current_limit"),
];
/// What a servo cannot move without.
const NEEDED: [&str; 4] = ["proportional", "supply_v", "resistance_ohm", "torque_constant"];

/// Makes a motor of the text of a plant file, at rest at 0 with a contact that was never moved: its drive
/// or servo, body, friction, effects and sensor. What a fit goes by (bounds, what is fixed) is read over,
/// and so is a controller.
///
/// # Safety
/// `text` ends in a zero byte; `motor` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_motor_from_plant(
    text: *const c_char,
    motor: *mut *mut Machine,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let text = unsafe { word(text, "text") }?;
        // SAFETY: as promised by the caller.
        unsafe { make(text, "plant", motor) }
    })
}

/// The same of a plant file by its path.
///
/// # Safety
/// `path` ends in a zero byte; `motor` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stiction_motor_load_plant(
    path: *const c_char,
    motor: *mut *mut Machine,
) -> Status {
    guarded(|| {
        // SAFETY: as promised by the caller.
        let path = unsafe { word(path, "path") }?;
        let text = std::fs::read_to_string(path)
            .map_err(|error| refused(path, format!("cannot be read: {error}")))?;
        // SAFETY: as promised by the caller.
        unsafe { make(&text, path, motor) }
    })
}

/// # Safety
/// `motor` is NULL or may be written.
unsafe fn make(text: &str, source: &str, motor: *mut *mut Machine) -> Result<(), Problem> {
    if motor.is_null() {
        return Err(Problem::Null("motor"));
    }
    let spec = spec_of(text, source)?;
    let made = Motor::new(spec).map_err(|error| refused(source, error.to_string()))?;
    // SAFETY: as promised by the caller.
    unsafe { put(motor, Box::into_raw(Box::new(Machine(made))), "motor") }
}

fn refused(source: &str, what: impl std::fmt::Display) -> Problem {
    Problem::Refused(format!("{source}: {what}"))
}

/// What a plant file says of a motor.
pub(crate) fn spec_of(text: &str, source: &str) -> Result<MotorSpec, Problem> {
    let plant: Table = text.parse().map_err(|error: toml::de::Error| {
        let at = error.span().map_or(0, |span| span.start);
        let line = 1 + text.bytes().take(at).filter(|byte| *byte == b'\n').count();
        refused(source, format!("line {line} is no TOML: {}", error.message()))
    })?;
    let file = File { plant: &plant, source };
    file.known(&plant, "table", &TABLES)?;
    let motion = file.section("motion")?;
    file.known(motion, "key of [motion]", &["kind"])?;
    let linear = match text_of(motion, "kind") {
        None if !motion.contains_key("kind") => false,
        Some("rotary") => false,
        Some("linear") => true,
        _ => return Err(refused(source, "[motion] kind is \"rotary\" or \"linear\"")),
    };
    file.spec(linear)
}

/// A plant file that is read.
struct File<'a> {
    plant: &'a Table,
    source: &'a str,
}

fn text_of<'a>(table: &'a Table, name: &str) -> Option<&'a str> {
    table.get(name).and_then(Value::as_str)
}

static EMPTY: LazyLock<Table> = LazyLock::new(Table::new);

impl<'a> File<'a> {
    fn refuse<T>(&self, what: impl std::fmt::Display) -> Result<T, Problem> {
        Err(refused(self.source, what))
    }

    /// A table that is empty where it is not there.
    fn section(&self, name: &str) -> Result<&'a Table, Problem> {
        match self.plant.get(name) {
            None => Ok(&EMPTY),
            Some(Value::Table(table)) => Ok(table),
            Some(_) => self.refuse(format!("{name} is not a table; write it as [{name}]")),
        }
    }

    fn known(&self, table: &Table, what: &str, names: &[&str]) -> Result<(), Problem> {
        for key in table.keys() {
            if !names.contains(&key.as_str()) {
                let error = Error::unknown(what, key, names.iter().copied());
                return Err(refused(self.source, error));
            }
        }
        Ok(())
    }

    /// A number, or the value of a table that says how it is fitted.
    fn number(&self, value: &Value, where_: &str) -> Result<f64, Problem> {
        match value {
            Value::Float(number) if !number.is_nan() => Ok(*number),
            Value::Integer(number) => Ok(*number as f64),
            Value::Table(table) => {
                let what = format!("key of {where_}");
                self.known(table, &what, &["value", "min", "max", "fixed"])?;
                match table.get("value") {
                    Some(value @ (Value::Float(_) | Value::Integer(_))) => {
                        self.number(value, where_)
                    }
                    _ => self.refuse(format!("{where_} has no value; write {{ value = … }}")),
                }
            }
            _ => self.refuse(format!("{where_} = {value} is no number")),
        }
    }

    fn optional(&self, table: &Table, name: &str, of: &str) -> Result<Option<f64>, Problem> {
        table.get(name).map(|value| self.number(value, &format!("{of} {name}"))).transpose()
    }

    fn spec(&self, linear: bool) -> Result<MotorSpec, Problem> {
        let drive = self.section("drive")?;
        let servo = match text_of(drive, "kind") {
            Some("servo") => true,
            Some("prescribed_motion") => {
                return self.refuse("[drive] kind = \"prescribed_motion\" has no motor; make its friction model by hand");
            }
            Some("direct") => false,
            None if !drive.contains_key("kind") => false,
            _ => {
                return self
                    .refuse("[drive] kind is \"direct\", \"servo\" or \"prescribed_motion\"");
            }
        };
        let (inertia, gravity, weight) = self.body(linear)?;
        let mut spec = MotorSpec::new(inertia, 1.0, self.law()?);
        (spec.gravity_amplitude, spec.gravity_zero) = gravity;
        spec.weight = weight;
        if servo {
            let names = SERVO.map(|(key, _)| key);
            let allowed = [&["kind", "torque_constant"][..], &names[..]].concat();
            self.known(drive, "key of a servo in [drive]", &allowed)?;
            for name in NEEDED {
                if !drive.contains_key(name) {
                    return self.refuse(format!("[drive] {name} is missing; a servo needs it"));
                }
            }
            let mut stated = Vec::new();
            for (key, name) in SERVO {
                if let Some(value) = self.optional(drive, key, "[drive]")? {
                    stated.push((name.to_owned(), value));
                }
            }
            let made = Servo::new(&stated).map_err(|error| refused(self.source, error))?;
            spec.servo = Some(made);
            spec.gain = self.optional(drive, "torque_constant", "[drive]")?.unwrap_or(1.0);
        } else {
            let allowed = ["kind", "input", "gain", "limit"];
            self.known(drive, "key of [drive]", &allowed)?;
            spec.gain = self.optional(drive, "gain", "[drive]")?.unwrap_or(1.0);
            let limit = self.optional(drive, "limit", "[drive]")?;
            spec.input_limit = limit.unwrap_or(f64::INFINITY);
        }
        if spec.gain == 0.0 {
            return self.refuse("[drive] a gain of 0 moves nothing; give the effort per input");
        }
        spec.effects = self.effects(linear, servo)?;
        spec.count = self.count(linear)?;
        Ok(spec)
    }

    /// Inertia, pendulum and weight, payload included.
    fn body(&self, linear: bool) -> Result<(f64, (f64, f64), f64), Problem> {
        let body = self.section("body")?;
        self.known(body, "key of [body]", &BODY)?;
        let other: &[&str] = if linear {
            &["gravity_amplitude", "gravity_zero_rad", "payload_m"]
        } else {
            &["weight_n"]
        };
        for name in other {
            if body.contains_key(*name) {
                let kind = if linear { "rotary" } else { "linear" };
                return self.refuse(format!("[body] {name} is for {kind} plants; leave it out"));
            }
        }
        let read = |name| self.optional(body, name, "[body]");
        let Some(own) = read("inertia")? else {
            return self.refuse("[body] inertia is missing; state it (kg·m² or kg)");
        };
        let mass = read("payload_kg")?.unwrap_or(0.0);
        if !linear && body.contains_key("payload_kg") && !body.contains_key("payload_m") {
            return self.refuse("[body] payload_kg is stated without payload_m; state that too");
        }
        let lever = if linear { 1.0 } else { read("payload_m")?.unwrap_or(0.0) };
        let hung = if linear { 0.0 } else { mass * lever * GRAVITY };
        let pendulum = read("gravity_amplitude")?.unwrap_or(0.0) + hung;
        let weight = read("weight_n")?.map_or(0.0, |own| own + mass * GRAVITY);
        let zero = read("gravity_zero_rad")?.unwrap_or(0.0);
        Ok((own + mass * lever * lever, (pendulum, zero), weight))
    }

    fn law(&self) -> Result<LawSpec, Problem> {
        let table = self.section("friction")?;
        let Some(law) = text_of(table, "law") else {
            return self.refuse("[friction] law is missing; name one");
        };
        let record = law_record(law).map_err(|error| refused(self.source, error))?;
        let (mut stated, mut chosen) = (Vec::new(), Vec::new());
        for (name, value) in table.iter().filter(|(name, _)| *name != "law") {
            if record.options.iter().any(|option| option.name == name) {
                let Some(choice) = value.as_str() else {
                    return self.refuse(format!("[friction] {name} = {value} is no word"));
                };
                chosen.push((name.clone(), choice.to_owned()));
            } else {
                stated.push((name.clone(), self.number(value, &format!("[friction] {name}"))?));
            }
        }
        LawSpec::new(law, &stated, &chosen).map_err(|error| refused(self.source, error))
    }

    fn effects(&self, linear: bool, servo: bool) -> Result<Vec<EffectSpec>, Problem> {
        let list = match self.plant.get("effects") {
            None => return Ok(Vec::new()),
            Some(Value::Array(list)) => list,
            Some(_) => return self.refuse("effects is not a list of tables; write [[effects]]"),
        };
        let mut specs = Vec::with_capacity(list.len());
        for (place, entry) in list.iter().enumerate() {
            let place = place + 1;
            let name = entry.as_table().and_then(|entry| text_of(entry, "name"));
            let (Some(entry), Some(name)) = (entry.as_table(), name) else {
                return self.refuse(format!("[[effects]] {place}: name is missing"));
            };
            let where_ = format!("[[effects]] {place} ({name})");
            let mut stated = Vec::new();
            for (key, value) in entry.iter().filter(|(key, _)| *key != "name") {
                stated.push((key.clone(), self.number(value, &format!("{where_} {key}"))?));
            }
            let spec = EffectSpec::new(name, &stated)
                .map_err(|error| refused(self.source, format!("{where_}: {error}")))?;
            if linear && spec.record.facts.rotary_only {
                return self.refuse(format!("{where_}: only a machine that turns has it"));
            }
            if !servo && spec.record.hooks.contains(&Hook::InputRate) {
                return self.refuse(format!("{where_}: only a servo has a goal"));
            }
            specs.push(spec);
        }
        EffectSpec::refuse_twice(&specs).map_err(|error| refused(self.source, error))?;
        Ok(specs)
    }

    /// Size of a count of the encoder, 0 where none is stated.
    fn count(&self, linear: bool) -> Result<f64, Problem> {
        let (sensor, name) =
            (self.section("sensor")?, if linear { "count_m" } else { "counts_per_rev" });
        self.known(sensor, "key of [sensor]", &[name])?;
        let Some(stated) = self.optional(sensor, name, "[sensor]")? else { return Ok(0.0) };
        if !(stated > 0.0 && stated.is_finite()) {
            return self.refuse(format!("[sensor] {name} = {stated} is no number above 0"));
        }
        Ok(if linear { stated } else { 2.0 * PI / stated })
    }
}
