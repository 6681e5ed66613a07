"""What the names of parameters mean: what is drawn for each."""

from __future__ import annotations

import inspect
from collections.abc import Callable

from stiction.export import targets
from stiction.library import entries
from stiction.recording import ROLES, SETTINGS

from .draw import EFFECTS, LAWS, Draw
from .files import kinds
from .surface import Target
from .world import needed

ALONE = 0.3
"""Of plain cases, how many have one argument of any kind."""
Drawer = Callable[[Draw], str]

STARTS = sorted({p.name for law in LAWS.values() for p in law.start})


def _paths(draw: Draw) -> str:
    if draw.odd():
        return draw.texts(["friction.coulomb", "body.inertia", "inertia"])
    first = draw.random.randint(0, 12)
    return f"list(x.parameters)[{first}:{first + draw.random.randint(0, 3)}]"


def _values(draw: Draw) -> str:
    """New values by path for a plant."""
    if draw.odd():
        return draw.table({draw.pick(("inertia", "coulomb", "nonsense")): draw.size()})
    return f"{{path: p.value * {draw.size(-1.0, 1.0)} for path, p in x.parameters.items()}}"


def _members(draw: Draw) -> str:
    """What the machines of an ensemble differ in."""
    name = draw.pick(("inertia", "body.inertia", "torque_constant", "friction.viscous", "viscous"))
    return draw.table({name: draw.array(-3.0, 0.0, n=3)})


def _candidates(draw: Draw) -> str:
    names = draw.random.sample(sorted(EFFECTS), draw.random.randint(0, 3))
    return f"[{', '.join(f'({draw.text([n])}, {{}})' for n in names)}]"


def mapped(draw: Draw, names: tuple[str, str, str] = ("t", "u", "q")) -> str:
    """Which column plays which role, of a file that calls them so."""
    if draw.chance(0.6):
        time, given, position = map(repr, names)
        own = f"{{'name': {given}, 'unit': 'Nm'}}"
        return f"{{'time': {time}, 'input': {own}, 'position': {position}}}"
    roles = draw.random.sample(sorted(ROLES), draw.random.randint(0, 3))
    tables = {
        role: draw.table({"name": draw.text(["t", "u", "q"]), "unit": draw.text(["s", "rad", "A"]),
                          "scale": draw.signed(), "offset": draw.signed()})
        for role in roles
    }  # fmt: skip
    return draw.table(tables)


def _start(draw: Draw) -> str:
    names = draw.random.sample(STARTS, draw.random.randint(0, min(2, len(STARTS))))
    return draw.table({name: draw.signed() for name in names})


def moved(draw: Draw) -> str:
    """A measured motion."""
    n = draw.n
    position = f"scaled({draw.size(-6.0, 0.0)}, {draw.array(-1.0, 0.0, n=n + 1)})"
    if draw.odd():
        position = draw.array(n=n)
    more = f", load={draw.array(n=n)}" if draw.chance(0.2) else ""
    return f"st.Motion({position}, {draw.array(n=n)}, {draw.size(-5.0, -2.0)}{more})"


def _chunks(draw: Draw) -> str:
    return f"[{', '.join(draw.array(n=draw.pick((0, 1, 3, 20))) for _ in range(3))}]"


def _outputs(draw: Draw) -> str:
    return draw.texts(["position", "velocity", "friction", "measured", "mode", "spring"])


def _out(draw: Draw) -> str:
    return f"{{'position': np.empty({draw.n if not draw.odd() else draw.n + 1})}}"


def _level(draw: Draw) -> str:
    return draw.signed(-3.0, 0.5)


def _folder(draw: Draw) -> str:
    if draw.odd():
        return str(draw.pick(("None", "3", "b'x'", "'/proc/x'", "''", "'\\0'", "folder")))
    return f"folder + {draw.pick(('/a', '/a.npz', '/b.csv', '/new/c', '/x.txt'))!r}"


BY_NAME: dict[str, Drawer] = {
    "current": lambda d: d.array(),
    "currents": lambda d: d.array(),
    "velocity": lambda d: d.array(),
    "load": lambda d: d.per_sample(-3.0, 0.5),
    "transmitted": lambda d: d.per_sample(-3.0, 0.5),
    "temperature": lambda d: d.per_sample(0.0, 2.0),
    "effort": lambda d: d.array(),
    "enabled": lambda d: d.array(0.0, 0.0),
    "dt": lambda d: d.steps(),
    "durations": lambda d: f"positive({d.array(-5.0, d.pick((-2.0, -1.0, 4.0)))})",
    "times": lambda d: d.rising(),
    "tolerance": lambda d: d.size(-9.0, -4.0),
    "parameters": _paths,
    "motor": lambda d: d.motor(),
    "friction": lambda d: d.law(),
    "plant": lambda d: d.plant(),
    "session": lambda d: d.session(),
    "recording": lambda d: d.recording(),
    "recordings": lambda d: d.session(),
    "outputs": _outputs,
    "out": _out,
    "position": lambda d: d.array(),
    "start": _start,
    "weights": lambda d: d.array(-1.0, 0.0, n=9),
    "second": lambda d: d.array(-1.0, 2.0, n=11),
    "stride": lambda d: d.whole(1, 9),
    "every": lambda d: d.whole(1, 9),
    "parts": lambda d: d.whole(1, 5),
    "threads": lambda d: d.whole(1, 3),
    "motion": moved,
    "kernel": lambda d: "made('RowKernel')",
    "candidates": _candidates,
    "other": lambda d: "x",
    "path": _folder,
    "where": _folder,
    "folder": _folder,
    "checkpoint": _folder,
    "reduce": lambda d: d.text(("last", "rms", "extremes")),
    "target": lambda d: d.signed(),
    "keep": lambda d: d.text(("every", "last", "rms", "extremes")),
    "integrator": lambda d: d.text(("fast", "reference")),
    "ax": lambda d: "None",
    "label": lambda d: d.text(["measured", ""]),
    "law": lambda d: d.text(sorted(LAWS)),
    "to": lambda d: d.text(sorted(targets())),
    "laws": lambda d: d.texts(sorted(LAWS), 1),
    "without": lambda d: d.texts(sorted(EFFECTS)),
    "surrogates": lambda d: d.whole(4, 6),
    "smallest": lambda d: d.size(-4.0, -0.5),
    "alpha": lambda d: d.size(-4.0, -0.5),
    "seed": lambda d: d.whole(0, 9),
    "columns": mapped,
    "max_evaluations": lambda d: d.whole(1, 5),
    "steps": lambda d: d.whole(1000, 1001),
    "draws": lambda d: d.whole(0, 1),
    "only": lambda d: d.experiments(),
    "executor": lambda d: "None",
    "members": lambda d: d.whole(1, 4),
    "count": lambda d: d.size(-6.0, -3.0),
    "halves": lambda d: "[0, 1, 2, 4]" if not d.odd() else f"[{d.whole(0, 9)}, {d.whole(0, 9)}]",
    "readings": lambda d: d.array(),
    "rate": lambda d: d.size(2.0, 3.5),
    "table": lambda d: d.plant_table(),
    "settings": lambda d: d.table({d.pick(SETTINGS): d.size()}),
    "values": _values,
    "progress": lambda d: "None",
    "cases": lambda d: "{}",
    "role": lambda d: d.text(("train", "select", "test")),
    "name": lambda d: d.text(("a", "b")),
    "drive": lambda d: d.text(("torque_nm", "current_a", "prescribed_motion")),
    "index": lambda d: d.whole(0, 1),
    "replicates": lambda d: "{1: 0}" if d.chance(0.5) else "{}",
    "given": mapped,
    "kind": lambda d: d.text(("sine", "")),
    "paths": lambda d: "list(x.parameters)",
    "body": lambda d: f"{{'inertia': Parameter({d.size()})}}",
    "time": lambda d: d.array(),
    "input": lambda d: d.array(),
    "rig": lambda d: "None",
    "diagnosis": lambda d: "made('Diagnosis')",
    "records": lambda d: "stiction.paper.experiment_1()",
    "effects": lambda d: d.effects(),
    "servo": lambda d: d.servo(),
    "cold": lambda d: d.pick(("True", "False")),
    "block_s": lambda d: d.size(-0.7, 0.0),
    "edge_s": lambda d: d.size(-3.0, -1.5),
}
"""What is drawn for a parameter of this name."""


def _robot_table(draw: Draw) -> str:
    """A robot of one joint, with numbers of its drive that are mostly possible."""
    gain = draw.signed() if draw.odd() else draw.size()
    drive = f"{{'input': 'torque_nm', 'gain': {gain}, 'gear_ratio': {draw.size()}}}"
    columns = "{'position': 'q', 'input': 'u'}"
    limits = f"{{'speed': {draw.size()}, 'effort': {gain}}}"
    joint = f"{{'name': 'turn', 'columns': {columns}, 'drive': {drive}, 'limits': {limits}}}"
    return f"{{'robot': {{'urdf': {draw.file('one.urdf')}, 'joints': [{joint}]}}}}"


def _stated(draw: Draw) -> str:
    """Parameters of a law or an effect, whichever it is."""
    name = draw.pick(("viscous", "coulomb", "excess", "share"))
    return "{}" if draw.chance(0.5) else f"{{{name!r}: Parameter({draw.signed()})}}"


OF_TARGET: dict[str, Drawer] = {
    "Motion.position": lambda d: d.array(-6.0, -1.0, n=d.n + 1),
    "Plant.motion": lambda d: d.text(("rotary", "linear")),
    "fit_curve.motion": lambda d: d.text(("rotary", "linear")),
    "fit_curve.speed": lambda d: "np.linspace(0.1, 3.0, 12)" if not d.odd() else d.array(),
    "fit_curve.friction": lambda d: "np.linspace(0.3, 0.5, 12)" if not d.odd() else d.array(),
    "Trajectory.of_motion.motion": lambda d: d.text(("rotary", "linear")),
    "Plant.plot_friction.kind": lambda d: d.text(("speed", "hysteresis", "breakaway")),
    "called.given": lambda d: d.text(("sigma0", "F_s")),
    "Recording.load.motion": lambda d: d.text(("rotary", "linear")),
    "Plant.friction": lambda d: f"Friction({d.text(['coulomb'])})",
    "Plant.effects": lambda d: f"(Effect({d.text(sorted(EFFECTS))}),)" if d.odd() else "()",
    "Plant.load.path": lambda d: d.file("plant.toml"),
    "Plant.from_bam.path": lambda d: d.file("params.json"),
    "bam.read_bam.path": lambda d: d.file("params.json"),
    "plant.Friction.parameters": _stated,
    "plant.Effect.name": lambda d: d.text(sorted(EFFECTS)),
    "plant.Effect.parameters": _stated,
    **dict.fromkeys(
        tuple(f"library.Entry.{each}" for each in ("numbers", "source", "made", "floor")),
        lambda d: "{}" if not d.odd() else d.text(("a",)),
    ),
    "library.entry.name": lambda d: d.text([each.name for each in entries()]),
    "library.entry_of_fit.path": lambda d: d.file("fit.json"),
    "library.compare.entry": lambda d: "made('Entry')",
    "load.path": lambda d: d.file("session.toml"),
    "Recording.load.path": lambda d: d.file(".csv"),
    "recording.read_table.path": lambda d: d.file(d.pick(kinds())),
    "FrictionModel.step.velocity": _level,
    "FrictionModel.trial.velocity": _level,
    "FrictionModel.derivatives.velocity": _level,
    "FrictionModel.step.load": _level,
    "FrictionModel.trial.load": _level,
    "FrictionModel.derivatives.load": _level,
    "FrictionModel.step.effort": _level,
    "FrictionModel.trial.effort": _level,
    "FrictionModel.derivatives.effort": _level,
    "Nothing.step.velocity": _level,
    "Motor.step.current": _level,
    "Motor.step.load": _level,
    "Motor.step.enabled": lambda d: d.pick(("True", "False")),
    "FrictionModel.reset.position": _level,
    "FrictionModel.reset.time": lambda d: d.size(),
    "FrictionModel.reset.path": lambda d: d.size(),
    "Motor.reset.position": _level,
    "Motor.reset.velocity": _level,
    "Motor.reset.time": lambda d: d.size(),
    "Motor.reset.path": lambda d: d.size(),
    "Motor.accompany.stiffness": lambda d: d.size(0.0, 4.0),
    "Motor.accompany.damping": lambda d: d.size(-2.0, 2.0),
    "Motor.follow.motion": moved,
    "Motor.step.temperature": lambda d: d.signed(0.0, 2.0),
    "Motor.adopt.other": lambda d: "x" if not d.odd() else d.motor(),
    "FrictionModel.step.temperature": lambda d: d.signed(0.0, 2.0),
    "FrictionModel.trial.temperature": lambda d: d.signed(0.0, 2.0),
    "FrictionModel.derivatives.temperature": lambda d: d.signed(0.0, 2.0),
    "Ensemble.parameters": _members,
    "simulate_ensemble.parameters": _members,
    "Ensemble.step_many.current": lambda d: d.array(n=3),
    "Ensemble.step_many.load": lambda d: d.array(n=3),
    "Ensemble.run.target": lambda d: "None",
    "Ensemble.members": lambda d: d.whole(3, 3),
    "Ensemble.run.load": lambda d: "None",
    "Motor.effects": lambda d: d.effects(),
    "stream.currents": _chunks,
    "stream.load": _level,
    "stream.dt": lambda d: d.size(-5.0, -2.0),
    "stated.Friction.parameters": lambda d: f"{{'coulomb': Parameter({d.size()})}}",
    "stated.Effect.parameters": lambda d: f"{{'order': Parameter({d.size()})}}",
    "stated.check_parameters.given": lambda d: f"{{'coulomb': Parameter({d.size()})}}",
    "plant.Parameter.read.given": lambda d: f"{{'value': {d.size()}}}",
    "Plant.simulate.position": _level,
    "Plant.simulate.velocity": _level,
    "plan.plan.position": lambda d: d.size(-1.0, 1.0),
    "plan.plan.speed": lambda d: d.size(0.0, 1.0),
    "plan.plan.effort": lambda d: d.size(-1.0, 1.0),
    "plan.Limits.position": lambda d: d.size(),
    "plan.Limits.speed": lambda d: d.size(),
    "plan.Limits.effort": lambda d: d.size(),
    "recording.Column.parse.value": lambda d: d.text(("t", "u [Nm]")),
    "recording.Table.find.name": lambda d: "'a'" if not d.odd() else d.text(("b",)),
    "recording.Table.place.row": lambda d: d.whole(0, 2),
    "Recording.time": lambda d: "0.01 * np.arange(220.0)",
    "played.width": lambda d: d.size(),
    "Recording.input": lambda d: d.array(n=220),
    "Recording.position": lambda d: d.array(n=220),
    "Recording.with_input.values": lambda d: d.array(n=260),
    "Recording.with_load.values": lambda d: "0.1 * x.time",
    "Recording.with_load.transmitted": lambda d: "0.2 * x.time",
    "Recording.decimate.every": lambda d: d.whole(1, 3),
    "Recording.without_ends.rows": lambda d: d.whole(0, 40),
    "robot.Robot.load.path": lambda d: d.file("robot.toml"),
    "robot.Robot.from_dict.table": _robot_table,
    "robot.plan_robot.robot": lambda d: f"stiction.robot.Robot.from_dict({_robot_table(d)})",
    "robot.load_session.path": lambda d: d.file("robot-session.toml"),
    "robot.Run.joints": lambda d: "(made('Run').joints[0],)",
    "robot.Run.payload": lambda d: d.size(),
    "robot.RobotSession.robot": lambda d: "made('Robot')",
    "robot.RobotSession.runs": lambda d: "(made('Run'),)",
    "robot.RobotSession.left_out": lambda d: "()",
    "robot.RobotSession.of_joint.joint": lambda d: d.whole(0, 0),
    "robot.RobotFit.efforts.run": lambda d: d.whole(0, 1),
    "robot.RobotFit.joint.joint": lambda d: d.whole(0, 0),
    "robot.RobotFit.plant.joint": lambda d: d.whole(0, 0),
    "robot.fit_robot.session": lambda d: "made('RobotSession')",
    "robot.diagnose_robot.session": lambda d: "made('RobotSession')",
    "demo_session.copy.folder": lambda d: f"folder + '/{d.pick(('demo', 'other'))}'",
    "report.write.folder": lambda d: "__import__('pathlib').Path(folder)",
    "adaptively_smoothed.noise": lambda d: d.size(-6.0, 0.0),
    "paper.stick_slip.speed": lambda d: d.size(-2.0, 0.0),
    "compare.Measured.numbers": lambda d: d.table({"a": d.size()}),
    "paper.illustrative_motor.overrides": lambda d: "",
}
"""And where a name means something else."""


def arguments(draw: Draw, target: Target) -> str:
    """What a target is called with."""
    try:
        signature = inspect.signature(target.value)
    except (TypeError, ValueError):
        return ""
    texts = []
    must = needed(signature)
    known = [n for n, p in signature.parameters.items() if n not in ("self", "cls")
             and p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL)]  # fmt: skip
    # Among plain ones a single argument is odd now and then: many odd ones hide one another.
    alone = draw.pick(known) if known and draw.wild == 0.0 and draw.chance(ALONE) else ""
    for name, parameter in signature.parameters.items():
        if name in ("self", "cls") or parameter.kind is parameter.VAR_KEYWORD:
            continue
        if name not in must and parameter.kind is not parameter.VAR_POSITIONAL:
            likely = name in ("friction", "members", "noise", "max_evaluations", "surrogates")
            if name != alone and not draw.chance(0.9 if likely else 0.3):
                continue
        text = draw.odd_one() if name == alone else argument(draw, target, name, parameter)
        keyword = parameter.kind is parameter.KEYWORD_ONLY or name not in must
        texts.append(f"{name}={text}" if keyword and parameter.kind is not
                     parameter.VAR_POSITIONAL else text)  # fmt: skip
    if target.name in ("FrictionModel", "paper.illustrative_friction"):
        law = draw.law(effects=True)
        return law.partition("(")[2][:-1] if target.kind == "class" else ""
    if target.name == "Motor":
        return draw.motor().partition("(")[2][:-1]
    return ", ".join(texts)


def argument(draw: Draw, target: Target, name: str, parameter: inspect.Parameter) -> str:
    """What is drawn for one parameter: by its name, or by what its annotation says."""
    drawer = OF_TARGET.get(f"{target.name}.{name}") or BY_NAME.get(name)
    if drawer is not None:
        return drawer(draw)
    said = str(parameter.annotation)
    if isinstance(parameter.default, bool):
        return str(draw.pick(("True", "False")))
    if "ArrayLike" in said or "FloatArray" in said:
        return draw.array()
    if "int" in said:
        return draw.whole(0, 9)
    if "str" in said:
        return draw.text(["a", "position"])
    if "bool" in said:
        return str(draw.pick(("True", "False")))
    return draw.signed()
