"""Columns are guessed from names, units and numbers; and what cannot be guessed is said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from stiction.recording import Columns, Recording, Table, read_table
from stiction.recording.guess import Guess, guess
from stiction.recording.guess.overrule import overrule

DEG = np.pi / 180.0
TURN = 2.0 * np.pi


def machine(rows: int = 3000, noise: float = 1e-5) -> dict[str, np.ndarray]:
    """A shaft that swings a good radian: SI values by role, all but the reference measured."""
    t = np.arange(rows) * 1e-3
    rng = np.random.default_rng(7)
    wanted = 1.2 * np.sin(2.0 * t) + 0.3 * np.sin(7.0 * t)
    return {
        "time": t,
        "position": wanted + noise * rng.standard_normal(rows),
        "reference": np.concatenate([wanted[5:], wanted[-5:]]),
        "velocity": 2.4 * np.cos(2.0 * t) + 2.1 * np.cos(7.0 * t),
        "effort": np.sin(2.3 * t) + 0.4 * np.sign(np.cos(2.0 * t)),
    }


def table(columns: dict[str, np.ndarray], path: str = "run.npz") -> Table:
    return Table(Path(path), {name: np.asarray(x, dtype=float) for name, x in columns.items()})


def roles(found: Guess) -> dict[str, tuple[str, str | None]]:
    return {role: (one.column, one.unit) for role, one in found.by_role.items()}


# Header of time, position and drive; what they are multiplied with; the units to be found.
HEADERS = {
    "canonical names": (("time_s", "position_rad", "current_a"), (1, 1, 1), ("s", "rad", "A")),
    "canonical, linear": (("time_s", "position_m", "force_n"), (1, 1, 1), ("s", "m", "N")),
    "letters": (("t", "q", "i"), (1, 1, 1), ("s", "rad", "A")),
    "letters, linear": (("t", "x", "u"), (1, 1, 1), ("s", "m", "V")),
    "brackets": (("t [ms]", "pos [deg]", "cur [mA]"), (1e3, 1 / DEG, 1e3), ("ms", "deg", "mA")),
    "parentheses": (("Time (s)", "Angle (deg)", "T (Nm)"), (1, 1 / DEG, 1), ("s", "deg", "Nm")),
    "endings": (("time_ms", "pos_mm", "i_ma"), (1e3, 1e3, 1e3), ("ms", "mm", "mA")),
    "capitals": (("TimeMs", "PosDeg", "MotorTorque"), (1e3, 1 / DEG, 1), ("ms", "deg", "Nm")),
    "struct fields": (("run.time", "run.theta", "run.tau"), (1, 1, 1), ("s", "rad", "Nm")),
    "micrometres": (("time", "travel_µm", "motor_voltage"), (1, 1e6, 1), ("s", "um", "V")),
    "microseconds": (("timestamp", "q", "iq"), (1e6, 1, 1), ("us", "rad", "A")),
    "German": (("Zeit", "Winkel", "Drehmoment"), (1, 1, 1), ("s", "rad", "Nm")),
    "joint numbers": (("t", "q[0]", "tau[0]"), (1, 1, 1), ("s", "rad", "Nm")),
    "unit words": (("seconds", "encoder_degrees", "amps"), (1, 1 / DEG, 1), ("s", "deg", "A")),
    "milliampere by size": (("t", "theta", "current"), (1, 1, 500), ("s", "rad", "mA")),
    "many turns are degrees": (("t", "theta", "i"), (1, 100, 1), ("s", "deg", "A")),
    "turns of an angle too": (("t", "angle", "i"), (1, 10, 1), ("s", "deg", "A")),
    "long travel is millimetres": (("t", "dist", "motor_current"), (1, 20, 1), ("s", "mm", "A")),
}  # fmt: skip


@pytest.mark.parametrize("case", HEADERS)
def test_time_position_and_input_are_found(case: str) -> None:
    names, factors, units = HEADERS[case]
    real = machine()
    values = [
        real[role] * f for role, f in zip(("time", "position", "effort"), factors, strict=True)
    ]
    found = guess([table(dict(zip(names, values, strict=True)))])
    assert roles(found) == {
        role: (name, unit)
        for role, name, unit in zip(("time", "position", "input"), names, units, strict=True)
    }
    assert found.complete
    assert not found.missing


def test_every_column_says_why() -> None:
    real = machine()
    found = guess([table({"t": real["time"], "q": real["position"], "i": real["effort"],
                          "blue": real["effort"], "enable": np.ones(3000)})])  # fmt: skip
    assert all(one.reason for one in found.columns)
    assert [one.column for one in found.columns] == ["t", "q", "i", "blue", "enable"]
    why = {one.column: one.reason for one in found.columns if one.role is None}
    assert why == {
        "blue": "no word of its name is known",
        "enable": "it is 1 in every row: the drive was always on",
    }
    assert found.motion_reason
    assert found.drive_reason


@pytest.mark.parametrize("name", ["enable", "torque_enable", "DriveEnabled"])
def test_where_the_drive_is_off_is_known_by_what_it_is_enabled_by(name: str) -> None:
    real = machine()
    columns = {"t": real["time"], "q": real["position"], "i": real["effort"]}
    off = np.where(real["time"] < 1.0, 1.0, 0.0)
    assert roles(guess([table({**columns, name: off})]))["enabled"] == (name, "1")
    for other in (2.0 * off, 0.0 * off):
        found = guess([table({**columns, name: other})])
        why = {one.column: one.reason for one in found.columns if one.role is None}
        assert why == {name: "what says whether a drive is on is 0 or 1"}


def test_the_order_of_the_columns_does_not_matter() -> None:
    real = machine()
    columns = {"i": real["effort"], "q": real["position"], "t": real["time"]}
    back = dict(reversed(columns.items()))
    assert roles(guess([table(columns)])) == roles(guess([table(back)]))


def test_of_two_similar_positions_the_smoother_is_the_reference() -> None:
    real = machine(noise=1e-4)
    for pair in (("pos1", "pos2"), ("pos2", "pos1")):
        columns = {"t": real["time"], "u": real["effort"]}
        columns |= dict(zip(pair, (real["position"], real["reference"]), strict=True))
        found = roles(guess([table(columns)]))
        assert found["position"][0] == pair[0]
        assert found["reference"][0] == pair[1]


@pytest.mark.parametrize("name", ["ref", "qg", "goal_position", "q_des", "setpoint", "qr", "cmd"])
def test_a_reference_is_known_by_its_name(name: str) -> None:
    real = machine()
    columns = {"t": real["time"], "q": real["position"], "i": real["effort"]}
    found = roles(guess([table({**columns, name: real["reference"]})]))
    assert found["reference"] == (name, "rad")
    assert found["position"] == ("q", "rad")


def test_a_command_that_does_not_look_like_the_position_is_no_reference() -> None:
    real = machine()
    noise = np.random.default_rng(1).normal(size=3000)
    columns = {"t": real["time"], "q": real["position"], "i": real["effort"], "ref": noise}
    assert "reference" not in roles(guess([table(columns)]))


@pytest.mark.parametrize(
    ("name", "factor", "unit"),
    [
        ("velocity", 1.0, "rad/s"),
        ("speed", 1.0 / DEG, "deg/s"),
        ("omega", 60.0 / TURN, "rpm"),
        ("v", 1.0, "rad/s"),
        ("qd", 1.0, "rad/s"),
        ("speed [rpm]", 60.0 / TURN, "rpm"),
    ],
)
def test_the_unit_of_a_velocity_is_the_one_that_agrees_with_the_motion(
    name: str, factor: float, unit: str
) -> None:
    real = machine()
    columns = {"t": real["time"], "q": real["position"], "i": real["effort"]}
    found = roles(guess([table({**columns, name: factor * real["velocity"]})]))
    assert found["velocity"] == (name, unit)


def test_a_velocity_that_runs_backward_is_flipped() -> None:
    real = machine()
    columns = {"t": real["time"], "q": real["position"], "i": real["effort"]}
    found = guess([table({**columns, "speed": -real["velocity"]})])
    assert found.by_role["velocity"].scale == -1.0
    assert "against" in found.by_role["velocity"].reason


def test_names_with_two_meanings_get_the_one_that_the_data_bear_out() -> None:
    real = machine()
    columns = {"t": real["time"], "q": real["position"]}
    assert roles(guess([table({**columns, "v": real["effort"]})]))["input"] == ("v", "V")
    with_qd = {**columns, "i": real["effort"], "qd": real["reference"]}
    assert roles(guess([table(with_qd)]))["reference"] == ("qd", "rad")
    warm = {**columns, "i": real["effort"], "T": 30.0 + real["time"] ** 0.5}
    assert roles(guess([table(warm)]))["temperature"] == ("T", "degC")


def test_steps_of_an_encoder_tell_radians_from_degrees() -> None:
    real = machine()
    for turn, unit in ((TURN, "rad"), (360.0, "deg")):
        step = turn / 4096
        position = np.round(40.0 * real["position"] / step) * step
        found = guess([table({"t": real["time"], "pos": position, "i": real["effort"]})])
        assert roles(found)["position"] == ("pos", unit)
        assert found.motion == "rotary"
        assert found.counts_per_rev == 4096


def test_a_linear_scale_is_known_by_its_round_steps() -> None:
    real = machine()
    # Slow enough for steps of a few counts at the turning points.
    position = np.round(0.002 * real["position"] / 1e-7) * 1e-7
    found = guess([table({"t": real["time"], "qm": position, "vir": real["effort"]})])
    assert (found.motion, roles(found)["position"]) == ("linear", ("qm", "m"))


def test_counts_need_their_size() -> None:
    real = machine()
    counts = np.round(2000.0 * real["position"])
    found = guess([table({"t": real["time"], "encoder": counts, "i": real["effort"]})])
    assert roles(found)["position"] == ("encoder", "count")
    assert not found.complete
    around = np.mod(counts * 2, 4096)
    found = guess([table({"t": real["time"], "encoder": around, "i": real["effort"]})])
    assert found.counts_per_rev == 4096
    assert found.complete


def test_a_force_alone_beside_a_motion_is_a_measured_effort() -> None:
    real = machine()
    columns = {"t": real["time"], "dist": 10.0 * real["position"], "forc": real["velocity"]}
    found = guess([table(columns)])
    assert found.drive == "prescribed_motion"
    assert roles(found)["effort"] == ("forc", "N")
    assert found.by_role["effort"].scale == 1.0
    turned = guess([table({**columns, "forc": -real["velocity"]})])
    assert turned.by_role["effort"].scale == -1.0
    # With a current there is something that drives, and with a reference someone asked for it.
    driven = guess([table({**columns, "i": real["effort"]})])
    assert driven.drive == "current_a"
    asked = guess([table({**columns, "xref": 10.0 * real["reference"]})])
    assert asked.drive == "force_n"


@pytest.mark.parametrize(
    ("current", "drive"),
    [
        ("Iststrom [A]", "current_a"),
        ("actual_current [A]", "current_a"),
        ("Measured current (A)", "current_a"),
        ("Torque actual value [Nm]", "torque_nm"),
        ("measured torque [Nm]", "prescribed_motion"),
    ],
)
def test_what_a_drive_reports_drives_and_what_a_sensor_feels_does_not(
    current: str, drive: str
) -> None:
    real = machine()
    columns = {"Zeit [s]": real["time"], "Lage [rad]": real["position"], current: real["effort"]}
    found = guess([table(columns)])
    assert found.drive == drive
    assert found.complete
    assert found.by_role["position"].column == "Lage [rad]"


def test_a_torque_drives() -> None:
    real = machine()
    found = guess([table({"time": real["time"], "position": real["position"],
                          "velocity": real["velocity"], "torque": real["effort"]})])  # fmt: skip
    assert found.drive == "torque_nm"
    assert found.motion == "rotary"


def test_the_effort_of_a_joint_state_is_no_voltage() -> None:
    real, joint = machine(), "/joint_states/elbow"
    names = {word: f"{joint}/{word}" for word in ("position", "velocity", "effort")}
    columns = {"__time": real["time"]} | {name: real[word] for word, name in names.items()}
    found = guess([table(columns)])
    assert found.drive == "torque_nm"
    assert found.by_role["input"].unit == "Nm"
    assert found.input_unknown
    assert "JointState" in found.drive_reason


def test_a_column_of_which_the_numbers_are_spoiled_is_named_where_it_is_missed() -> None:
    columns = machine() | {"position": np.full(3000, 1e200)}
    found = guess([table({name: columns[name] for name in ("time", "position", "effort")})])
    assert found.missing["position"].endswith("'position' holds numbers beyond 1e100")


def test_a_friction_coefficient_stands_for_the_effort() -> None:
    real = machine()
    found = guess([table({
        "Time(s)": real["time"],
        "Displ(microns)": 8500.0 + 10.0 * real["time"],
        "Friction": 0.6 + 0.01 * real["effort"],
        "Normal_stress(MPa)": 20.0 + 0.01 * real["effort"],
    })])  # fmt: skip
    assert roles(found) == {
        "time": ("Time(s)", "s"),
        "position": ("Displ(microns)", "um"),
        "normal_force": ("Normal_stress(MPa)", "MPa"),
        "friction_coefficient": ("Friction", "1"),
    }
    assert (found.motion, found.drive, found.complete) == ("linear", "prescribed_motion", True)


UNFIT = {
    "a supply": ("input_volts", lambda real: 12.0 + 0.1 * real["effort"], "a supply"),
    "a magnitude": ("torque", lambda real: np.abs(real["effort"]), "without sign"),
    "read too slowly": ("current", lambda r: np.repeat(r["effort"][::100], 100), "too slowly"),
    "unsigned": ("pwm", lambda real: np.mod(np.round(900 * real["effort"]), 65536), "without its"),
    "constant": ("current", lambda real: np.full(3000, 0.5), "0.5 in every row"),
    "a force on a shaft": ("force", lambda real: real["effort"], "the motion is rotary"),
}  # fmt: skip


@pytest.mark.parametrize("case", UNFIT)
def test_what_cannot_be_the_input_is_not_taken_and_says_why(case: str) -> None:
    name, made, why = UNFIT[case]
    real = machine()
    found = guess([table({"t": real["time"], "theta": real["position"], name: made(real)})])
    assert "input" in found.missing
    assert found.drive is None
    assert not found.complete
    refused = found.columns[2]
    assert (refused.role, refused.candidate) == (None, "input")
    assert why in refused.reason


def test_a_current_is_taken_before_a_voltage_and_a_torque_before_both() -> None:
    real = machine()
    columns = {"t": real["time"], "theta": real["position"], "voltage": real["effort"]}
    assert guess([table(columns)]).drive == "voltage_v"
    columns["current"] = real["effort"]
    assert guess([table(columns)]).drive == "current_a"
    columns["torque"] = real["effort"]
    found = guess([table(columns)])
    assert found.drive == "torque_nm"
    assert found.by_role["input"].alternatives[1:] == ("column 'current'", "column 'voltage'")


def test_without_names_only_the_time_is_guessed() -> None:
    real = machine()
    found = guess([table({"a": real["time"], "b": real["position"], "c": real["effort"]})])
    assert roles(found) == {"time": ("a", "s")}
    assert set(found.missing) == {"position", "input"}


def test_a_row_number_is_no_time() -> None:
    real = machine()
    found = guess([table({"index": np.arange(3000.0), "q": real["position"], "i": real["effort"]})])
    assert "time" in found.missing


def test_what_is_no_vector_of_numbers_is_left_out_with_its_reason(tmp_path: Path) -> None:
    real = machine()
    path = tmp_path / "run.npz"
    np.savez(path, t=real["time"], q=real["position"], i=real["effort"], gain=2.0,
             tau=np.ones((300, 2)), theta=np.ones(30))  # fmt: skip
    found = guess([read_table(path)])
    why = {one.column: one.reason for one in found.columns if one.role is None}
    assert set(why) == {"gain", "tau", "theta"}
    assert why["gain"] == "is a scalar"
    assert "matrix" in why["tau"]
    assert why["theta"] == "has 30 rows, and the others have 3000"


def test_lengths_by_other_units_get_a_scale() -> None:
    real = machine()
    columns = {"t": real["time"], "pos [cm]": 10.0 * real["position"], "i": real["effort"]}
    one = guess([table(columns)]).by_role["position"]
    assert (one.unit, one.scale) == ("m", 0.01)


def test_a_speed_of_the_motor_beside_a_travel_of_the_load_is_not_taken() -> None:
    real = machine()
    columns = {"t": real["time"], "pos_mm": real["position"], "i": real["effort"]}
    found = guess([table({**columns, "motor_rpm": real["velocity"]})])
    assert "velocity" not in roles(found)
    assert "the motion is linear" in found.columns[-1].reason
    assert found.complete


def test_several_files_are_guessed_together() -> None:
    real = machine()
    columns = {"t": real["time"], "angle": real["position"], "i": real["effort"]}
    wide = {**columns, "angle": 30.0 * real["position"]}
    assert roles(guess([table(columns)]))["position"] == ("angle", "rad")
    assert roles(guess([table(columns), table(wide)]))["position"] == ("angle", "deg")


@pytest.mark.parametrize("spoiled", [np.nan, np.inf, -np.inf, 1e300, 0.0])
def test_no_number_breaks_it(spoiled: float) -> None:
    real = machine()
    names = dict(zip(("t", "q", "ref", "v", "i"), real.values(), strict=True))
    names["T"] = real["effort"]
    for name in names:
        for rows in (slice(5, 6), slice(0, 2000), slice(None)):
            columns = {key: value.copy() for key, value in names.items()}
            columns[name][rows] = spoiled
            assert len(guess([table(columns)]).columns) == len(columns)


def test_canonical_columns_are_read_by_the_guess_as_without_it(tmp_path: Path) -> None:
    real = machine()
    path = tmp_path / "run.csv"
    head = "time_s,current_a,position_rad,velocity_rad_s"
    columns = [real[role] for role in ("time", "effort", "position", "velocity")]
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=head, comments="")
    found = guess([read_table(path)])
    guessed = Recording.load(path, found.mapping, motion=found.motion, drive=found.drive)
    assert guessed.hash == Recording.load(path).hash


REAL = {
    "emps": ("*.mat", "linear", "voltage_v",
             {"time": "t", "input": "vir", "position": "qm", "reference": "qg"}),
    "mr_damper": ("*.mat", "linear", "prescribed_motion",
                  {"time": "Tout", "position": "dist", "effort": "forc"}),
    "pick_and_place": ("*.mat", "linear", "voltage_v",
                       {"time": "t", "position": "y", "input": "u"}),
    "rock_rsf": ("*.txt", "linear", "prescribed_motion",
                 {"time": "Time(s)", "position": "Displ(microns)",
                  "friction_coefficient": "Friction", "normal_force": "Normal_stress(MPa)"}),
    "dfki_simple_pendulum": ("*.csv", "rotary", "torque_nm",
                             {"time": "time", "position": "position", "velocity": "velocity",
                              "input": "torque"}),
    # Their input is a goal; supply voltage, raw load and unsigned torque do not stand for it.
    "xl330": ("*.json", "rotary", None,
              {"time": "timestamp", "position": "position", "velocity": "speed",
               "temperature": "temp", "reference": "goal_position", "enabled": "torque_enable"}),
    "sts3215": ("*.json", "rotary", None,
                {"time": "timestamp", "position": "position", "velocity": "speed",
                 "temperature": "temp", "reference": "goal_position", "enabled": "torque_enable"}),
}  # fmt: skip
UNITS = {"dist": "mm", "y": "mm", "qm": "m", "Displ(microns)": "um", "position": "rad"}


@pytest.mark.parametrize("folder", REAL)
def test_real_recordings_are_understood(shared_data: Path, folder: str) -> None:
    pattern, motion, drive, expected = REAL[folder]
    paths = sorted((shared_data / folder).glob(pattern))
    for chosen in (paths, paths[:1], paths[-1:]):
        found = guess([read_table(path) for path in chosen])
        assert (found.motion, found.drive) == (motion, drive)
        known = {role: one.column for role, one in found.by_role.items()}
        # A single log in which a servo is never switched off tells of no drive that is.
        assert known.pop("enabled", expected.get("enabled")) == expected.get("enabled")
        assert chosen != paths or found.by_role.keys() == expected.keys()
        assert known == {role: name for role, name in expected.items() if role != "enabled"}
        assert found.by_role["position"].unit == UNITS[expected["position"]]
        assert found.complete == (drive is not None)


@pytest.mark.parametrize("name", ["n [U/min]", "Drehzahl (U/min)", "n [rpm]"])
def test_a_speed_of_the_shaft_alone_is_a_velocity(name: str) -> None:
    real = machine()
    columns = {"t": real["time"], "i": real["effort"], name: real["velocity"] * 30.0 / np.pi}
    found = guess([table(columns)])
    assert roles(found)["velocity"] == (name, "rpm")
    assert found.missing == {}


def test_the_only_column_that_may_drive_says_why_it_does_not() -> None:
    real = machine()
    columns = {"t": real["time"], "q": real["position"], "torque [% rated]": 30.0 * real["effort"]}
    missing = guess([table(columns)]).missing["input"]
    assert "('torque [% rated]' did not qualify: in parts of a rated value" in missing


def test_a_velocity_that_is_stated_stands_for_the_position() -> None:
    real = machine()
    columns = {"t": real["time"], "i": real["effort"], "what": real["velocity"]}
    stated = Columns.parse({"velocity": {"name": "what", "unit": "rad/s"}})
    assert overrule(guess([table(columns)]), stated).missing == {}
