"""What the words of a program mean: the package, arrays in few letters, and things ready made."""

from __future__ import annotations

import contextlib
import importlib
import inspect
import io
import json
import math
import pickle
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import stiction
import stiction as st

from .files import Shelf, write_parameters, write_urdf
from .surface import modules, named

ROWS = 260
"""Of recordings: what is the least is 200."""


class Broken(Exception):  # noqa: N818 (a rule that does not hold, and no error of the program)
    """Something that always holds does not."""


def wave(n: int, seed: int = 0, size: float = 1.0) -> np.ndarray:
    """Held levels, ramps and a sine of this size, n of them."""
    rng = np.random.default_rng(seed)
    levels = np.repeat(rng.uniform(-1.0, 1.0, n // 10 + 1), 10)[:n]
    values = size * (levels, np.sin(rng.uniform(0.01, 1.0) * np.arange(n)))[int(rng.integers(2))]
    return np.where(rng.random(n) < 0.05, 0.0, values)


def real(values: Any) -> np.ndarray:
    """A new array of floats; what is complex becomes none without a warning, which is no find."""
    array = np.array(values)
    if array.dtype.kind == "c":
        raise TypeError("complex numbers")
    return array.astype(float)


def spoiled(values: Any, place: int, value: Any) -> np.ndarray:
    """An array with another value in one place."""
    array, value = real(values), value if isinstance(value, int) else real(value)
    if array.size:
        array.flat[place % array.size] = value
    return array


def masked(values: Any, place: int) -> np.ma.MaskedArray[Any, Any]:
    """An array that is masked in one place."""
    array = np.ma.array(real(values))
    if array.size:
        array[place % array.size] = np.ma.masked
    return array


def positive(values: Any) -> np.ndarray:
    """Magnitudes of numbers, none of them 0."""
    return np.abs(real(values)) + 1e-7


def scaled(factor: Any, values: Any) -> np.ndarray:
    """Numbers times a factor."""
    return real(factor) * real(values)


def motor(law: str = "coulomb", **keywords: Any) -> st.Motor:
    """A plain motor."""
    return st.Motor(0.0076, friction=st.FrictionModel(law), **keywords)


def plant(law: str = "coulomb", **tables: Any) -> st.Plant:
    """A plain plant."""
    return st.Plant.from_dict(
        {"body": {"inertia": 0.01}, "friction": {"law": law}, "drive": {"gain": 1.0}} | tables
    )


@cache
def recording(rows: int = ROWS, seed: int = 0, law: str = "coulomb") -> st.Recording:
    """What a plain plant does, measured with a little noise."""
    rng = np.random.default_rng(seed)
    dt = 1e-2
    effort = np.repeat(rng.uniform(-2.0, 2.0, rows // 25 + 1), 25)[:rows]
    run = motor(law).simulate(effort, dt, outputs=["position"])
    position = np.concatenate([[0.0], run.position[:-1]]) + 1e-5 * rng.standard_normal(rows)
    return st.Recording(dt * np.arange(rows), effort, position)


def session(*seeds: int, law: str = "coulomb") -> st.Session:
    """Recordings of a plain plant."""
    return st.Session([recording(ROWS, seed, law) for seed in seeds or (0, 1)])


def plain_entry() -> Any:
    """A plain plant as an entry of the library."""
    source = {"text": "here", "url": "nowhere", "license": "ours"}
    own = plant("coulomb", friction={"law": "coulomb", "coulomb": 0.35})
    numbers = {"friction.coulomb": stiction.library.EntryNumber(0.35, (0.3, 0.4), "N·m")}
    return stiction.library.Entry("plain", "a motor", "published", own, numbers, source)


def bam_reading() -> Any:
    """A plant from a file of parameters, and what is to be told of it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "params.json"
        write_parameters(path, 4)
        return stiction.bam.read_bam(path)


def robot() -> Any:
    """A robot of one joint. Its URDF is gone when it is asked for efforts."""
    with tempfile.TemporaryDirectory() as folder:
        write_urdf(Path(folder) / "one.urdf", 0)
        columns = {"position": "q", "input": "u"}
        turn = {"name": "turn", "columns": columns, "drive": {"input": "torque_nm"}}
        table = {"robot": {"urdf": "one.urdf", "joints": [turn]}}
        return stiction.robot.Robot.from_dict(table, folder=Path(folder))


def robot_session() -> Any:
    """Two recordings of that robot."""
    return stiction.robot.RobotSession(
        robot(), tuple(stiction.robot.Run((recording(ROWS, seed),)) for seed in (0, 1))
    )


def robot_fit() -> Any:
    """Links that somebody states; nothing is asked of pinocchio, which may not be there."""
    from stiction.robot.motion import motion_of
    from stiction.robot.regression import ArmFit

    own = robot_session()
    link = np.array([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0])
    plain = np.array([[0.1, 0.2, 0.0]])
    arm = ArmFit(link, {}, np.array([0.1]), plain, np.array([0.01]), 2, (), 0.0)
    motions = tuple(motion_of(run.joints) for run in own.runs)
    return stiction.robot.RobotFit(own, arm, motions, session().split())


def robot_diagnosis() -> Any:
    """A diagnosis of that robot."""
    own = stiction.robot.JointFindings("turn", "turn", PRODUCERS["Diagnosis"]())
    return stiction.robot.RobotDiagnosis(robot_fit(), (own,))


def robot_signal() -> Any:
    """Positions of that robot."""
    time = np.arange(50) * 0.02
    place = np.sin(time)[:, None]
    most = {name: np.ones(1) for name in ("position", "speed", "effort")}
    return stiction.robot.RobotSignal(
        "together", "", "train", ("turn",), ("rad",), time, place, most
    )


PRODUCERS: dict[str, Callable[[], Any]] = {
    "Trajectory": lambda: motor().simulate(wave(50), 1e-3),
    "EffortResidual": lambda: stiction.residual.effort_residual(plant(), recording()),
    "FreeRun": lambda: stiction.residual.free_run(plant(), recording()),
    "EnsembleRun": lambda: st.simulate_ensemble(motor(), np.ones((2, 5)), 1e-3),
    "Ensemble": lambda: st.Ensemble(motor(), 3),
    "CurveFit": lambda: st.fit_curve(
        [0.1, 0.2, 0.5, 1.0, 2.0, 4.0], [0.3, 0.31, 0.3, 0.34, 0.4, 0.5]
    ),
    "FitResult": lambda: st.fit(plant(), session(), max_evaluations=3),
    "Diagnosis": lambda: st.diagnose(plant(), session(), surrogates=4),
    "Split": lambda: session().split(),
    "Check": lambda: stiction.recording.check(recording())[0],
    "Part": lambda: session().split().train[0],
    "Comparison": lambda: stiction.compare.compare(["coulomb"], steps=1000, draws=1),
    "Plan": lambda: stiction.plan.plan(plant(), only=["turns"]),
    "Signal": lambda: stiction.plan.plan(plant(), only=["turns"]).signals[0],
    "Export": lambda: plant().export("table"),
    "Target": lambda: stiction.export.targets()["table"],
    "BamReading": bam_reading,
    "Robot": robot,
    "RobotSession": robot_session,
    "RobotFit": robot_fit,
    "RobotDiagnosis": robot_diagnosis,
    "RobotPlan": lambda: stiction.robot.RobotPlan(robot(), (robot_signal(),)),
    "RobotSignal": robot_signal,
    "Run": lambda: robot_session().runs[0],
    "Joint": lambda: robot().joints[0],
    "Entry": plain_entry,
    "EntryNumber": lambda: plain_entry().numbers["friction.coulomb"],
    "UnitComparison": lambda: stiction.library.compare(plain_entry(), session(0)),
    "Recorded": lambda: stiction.paper.Recorded(1e-3, wave(300), 1e-3 * wave(300, 1)),
    "Estimate": lambda: stiction.paper.estimate(stiction.paper.experiment_1()),
    "Measured": lambda: stiction.compare.Measured(True, {"a": 1.0}),
    "Limits": lambda: stiction.plan.Limits(1.0, 2.0, 3.0),
    "Number": lambda: stiction.paper.Number(1.0, "N·m"),
    "Parameter": lambda: stiction.plant.Parameter(0.1, 0.0, 1.0),
    "RowKernel": lambda: st._native.RowKernel([0.25, 0.5, 0.25], [1.0, -2.0, 1.0], 1, 0.01),
    "Motion": lambda: st.Motion(1e-3 * wave(51), wave(50), 1e-3),
    "CancelToken": lambda: st._native.CancelToken(),
    "Table": lambda: stiction.recording.Table(Path("t"), {"a": np.ones(3)}),
}
"""What makes one of a class, where no constructor is drawn."""


@cache
def made(name: str) -> Any:
    """One of a class, made once: by its producer, or by a public function that returns it."""
    if name in PRODUCERS:
        return PRODUCERS[name]()
    for _, function in named():
        if inspect.isclass(function) or not callable(function):
            continue
        with contextlib.suppress(ValueError):
            signature = inspect.signature(function)
            returned = signature.return_annotation
            if getattr(returned, "__name__", returned) == name and not needed(signature):
                return function()
    if name in ("Result", "MotionResult"):
        return made("StickSlip")
    raise Broken(f"nothing public makes a {name}; name what does in tests/fuzz/world.py")


def needed(signature: inspect.Signature) -> list[str]:
    """Parameters that must be given."""
    return [
        p.name
        for p in signature.parameters.values()
        if p.default is p.empty and p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)
    ]


def same(one: Any, other: Any) -> bool:
    """Whether two states or results are the same to the bit."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(same(one[k], other[k]) for k in one)
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        one, other = np.asarray(one), np.asarray(other)
        return one.shape == other.shape and one.tobytes() == other.tobytes()
    if isinstance(one, float) and isinstance(other, float):
        return np.float64(one).tobytes() == np.float64(other).tobytes()
    return bool(one == other)


def onward(x: Any) -> Any:
    """Where a few more samples lead, from here."""
    again = x.copy()
    try:
        if isinstance(again, st.Motor):
            return [*(again.step(u, 1e-4) for u in (0.3, -0.2, 0.0)), again.state]
        return [*(again.step(v, 1e-3) for v in (1e-3, -0.2, 0.0)), again.state]
    except st.InputError as error:
        return str(error)


def round_trips(x: Any) -> None:
    """Go to every other form and back: nothing may change, and the way on is the same."""
    state = x.state
    plain = json.loads(json.dumps(state, default=lambda array: np.asarray(array).tolist()))
    ways = {
        "a copy": lambda: x.copy(),
        "a pickle": lambda: pickle.loads(pickle.dumps(x)),
        "its own state": lambda: assign(x, x.state),
        "JSON": lambda: assign(x.copy(), plain),
    }
    way = None
    for form, take in ways.items():
        try:
            other = take()
            onwards = onward(other)
        except Exception as error:
            raise Broken(f"{form} is refused: {error}") from error
        if not same(other.state, state):
            raise Broken(f"{form} brings another state back")
        if way is not None and not same(onwards, way):
            raise Broken(f"{form} goes on in another way")
        way = onwards


def assign(x: Any, state: Any) -> Any:
    x.state = state
    return x


def look(x: Any) -> str:
    """Read everything that can be read of an object."""
    try:
        return _look(x)
    except st.InputError as error:
        raise Broken(f"what is there cannot be shown: {error}") from error


def _look(x: Any) -> str:
    shown = [repr(x)]
    if callable(html := getattr(type(x), "_repr_html_", None)):
        shown.append(html(x))
    for name in dir(type(x)):
        if not name.startswith("_") and not callable(getattr(type(x), name)):
            # What an object cannot tell, it may refuse: a plant that lacks what it is asked for.
            with contextlib.suppress(AttributeError, st.InputError):
                shown.append(repr(getattr(x, name)))
    return "\n".join(shown)


COAST = 0.02
"""Share of energy that a coarse step may seem to give."""


def coasts(x: st.Motor, dt: float, samples: int, temperature: float | None = None) -> None:
    """Let a motor coast without any input: it must not gain energy."""
    settings = x.settings()
    inertia, swing = settings["inertia"], abs(settings["gravity_amplitude"])
    before = x.step(0.0, 1e-12)
    run = x.simulate(
        np.zeros(samples), dt, temperature=temperature, outputs=["position", "velocity"]
    )
    if not run.success:
        raise Broken(f"a motor that nobody drives runs away: {run.message}")
    fallen = abs(settings["weight"]) * np.max(np.abs(run.position - before[0]), initial=0.0)
    least = 0.5 * inertia * before[1] ** 2
    most = 0.5 * inertia * float(np.max(np.abs(run.velocity), initial=0.0)) ** 2
    if not most <= (1.0 + COAST) * least + 2.0 * swing + fallen + 1e-9:
        raise Broken(
            f"a motor that nobody drives goes from {before[1]:.6g} to "
            f"{np.max(np.abs(run.velocity)):.6g} rad/s"
        )


def command(*arguments: str) -> str:
    """The command, run here: an answer and no error, or no answer and one sentence."""
    from stiction.cli import run

    out, error = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
        status = run(arguments)
    said = error.getvalue()
    if status not in (0, 2):
        raise Broken(f"the command ends with {status}: {said!r}")
    if status == 2 and (said.count("\n") != 1 or not said.startswith("stiction: ")):
        raise Broken(f"the command refuses with {said!r}")
    return f"{status}"


def namespace(folder: Path) -> dict[str, Any]:
    """The words of a program whose files are in this folder."""
    for path in modules():
        importlib.import_module(path)
    words = (
        scaled,
        wave,
        spoiled,
        masked,
        positive,
        motor,
        plant,
        recording,
        session,
        made,
        round_trips,
        look,
    )
    shelf = Shelf(folder)
    return {
        "stiction": stiction,
        "st": st,
        "np": np,
        "math": math,
        "pickle": pickle,
        "inf": math.inf,
        "nan": math.nan,
        "Parameter": stiction.plant.Parameter,
        "Effect": stiction.plant.Effect,
        "Friction": stiction.plant.Friction,
        "coasts": coasts,
        "command": command,
        "file": shelf.file,
        "folder": str(folder),
        **{each.__name__: each for each in words},
    }
