"""Cases: short programs, each of which calls one target with what was drawn for it."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from functools import cache

from stiction.library import entries

from .draw import EFFECTS, LAWS, Draw
from .files import kinds, names_in
from .meanings import arguments, mapped, moved
from .surface import Target, names_read, targets

Program = list[str]

STATEFUL = ("Motor", "FrictionModel", "Ensemble")
"""Classes whose objects have a history."""
LONG = ("fit", "diagnose", "compare.compare", "plan.plan", "robot.plan_robot", "demo_session.load",
        "command.fit", "command.diagnose", "command.demo", "command.paper", "command.compare",
        "command.plan", "file.session.toml")  # fmt: skip
"""What works for seconds on few samples, because it simulates many times."""
DISSIPATING = tuple(
    name
    for name, effect in EFFECTS.items()
    if set(effect.hooks) <= {"friction level", "state relaxation", "input map", "input delay",
                             "input lag"}
)  # fmt: skip
"""Effects that can only take energy from a motor without an input."""


def receiver(draw: Draw, cls: type) -> str:
    """Something to call a method of."""
    name = cls.__name__
    if name == "Motor":
        return draw.motor()
    if name == "FrictionModel":
        return draw.law(effects=True)
    if name == "Ensemble":
        return f"st.Ensemble({draw.motor()}, 3)"
    if name == "Plant":
        plain = f"plant({draw.pick(sorted(LAWS))!r})"
        return plain if draw.chance(0.3) else f"st.Plant.from_dict({draw.plant_table()})"
    if name == "Recording":
        return draw.recording()
    if name == "Session":
        return "session(0, 1)" if draw.chance(0.7) else f"st.Session({draw.session()})"
    if name in ("Friction", "Effect"):
        known = sorted(LAWS if name == "Friction" else EFFECTS)
        return f"{name}({draw.text(known)})"
    if name == "Columns":
        return f"stiction.recording.Columns.parse({mapped(draw)})"
    if name == "Motion":
        return moved(draw)
    return f"made({name!r})" if name != "Nothing" else "st._native.Nothing()"


def methods_of(cls: type) -> list[Target]:
    return [t for t in targets().values() if t.owner is cls and t.kind in ("method", "setter")]


def called(draw: Draw, target: Target) -> str:
    """A line that calls a target; its receiver is x."""
    if target.kind == "look":
        return "look(x)"
    if target.kind == "setter":
        return f"{target.call} = {_state(draw, target)}"
    return f"{target.call}({arguments(draw, target)})"


def _state(draw: Draw, target: Target) -> str:
    """A state to set: its own, or one in which something is odd."""
    if not draw.chance(0.6):
        return target.call
    key = f"sorted({target.call})[{draw.random.randint(0, 30)} % len({target.call})]"
    value = draw.signed() if draw.chance(0.5) else draw.pick((*map(str, range(3)), "nan", "'a'",
                "None", "-1e308", "np.zeros((0, 2))", "np.ones((3, 2))", "[1.0]"))  # fmt: skip
    return f"{{**{target.call}, {key}: {value}}}"


def program(name: str, seed: str) -> Program:
    """The case of a target and a seed."""
    draw = Draw(f"{name}/{seed}")
    if name in SCENES:
        return SCENES[name](draw)
    if name.startswith("command."):
        return command_lines(draw, name.removeprefix("command."))
    if name.startswith("file."):
        return file_lines(draw, name.removeprefix("file."))
    target = targets()[name]
    if target.owner is None:
        line = called(draw, target)
        lines = [line] if target.kind != "class" else [f"x = {line}", "look(x)"]
        return [f"x = {draw.motor()}", *lines] if "x" in names_read(line) else lines
    lines = [f"x = {receiver(draw, target.owner)}"]
    stateful = target.owner.__name__ in STATEFUL
    if stateful:
        before = [t for t in methods_of(target.owner) if t.name not in LONG]
        lines += [called(draw, draw.pick(before)) for _ in range(draw.pick((0, 0, 1, 2)))]
    lines.append(called(draw, target))
    if stateful and target.owner.__name__ != "Ensemble" and draw.chance(0.3):
        lines.append(str(draw.pick(("round_trips(x)", "look(x)"))))
    return lines


def coast_lines(draw: Draw) -> Program:
    """A motor with effects that nobody drives."""
    draw.wild = 0.0
    names = draw.random.sample(DISSIPATING, draw.pick((1, 1, 2, 4)))
    rows = {}
    for name in names:
        specs = EFFECTS[name].parameters
        rows[name] = draw.table({p.name: draw.within(p) for p in specs if draw.chance(0.8)})
    law = draw.law() if draw.chance(0.7) else f"st.FrictionModel({draw.pick(sorted(LAWS))!r})"
    lines = [
        f"x = st.Motor({draw.size(-4.0, 0.0)}, friction={law}, effects={draw.table(rows)})",
        f"x.reset({draw.signed(-3.0, 1.0)}, {draw.signed(-1.0, 2.0)})",
    ]
    # Several laws may give energy back by their parameters, and say so.
    warmth = f", {draw.random.uniform(-40.0, 150.0):.4g}" if draw.chance(0.6) else ""
    call = f"coasts(x, {draw.size(-5.0, -2.5)}, 400{warmth})"
    lines.append(f"{call} if x.friction.passive else None")
    return lines


def round_trip_lines(draw: Draw) -> Program:
    """A motor or a contact that was somewhere, and all forms of its state."""
    draw.wild = 0.0
    cls = draw.pick(("Motor", "FrictionModel"))
    own = [t for t in methods_of(targets()[f"{cls}.step"].owner or object)
           if t.name.endswith((".step", ".reset", ".simulate", ".simulate_segments"))]  # fmt: skip
    lines = [f"x = {draw.motor() if cls == 'Motor' else draw.law()}"]
    lines += [called(draw, draw.pick(own)) for _ in range(draw.pick((1, 2, 3)))]
    return [*lines, "round_trips(x)"]


def file_lines(draw: Draw, kind: str) -> Program:
    """A file, and what reads it."""
    path = draw.file(kind, damaged=draw.chance(0.7))
    if kind == "plant.toml":
        return [f"p = {path}", "x = st.Plant.load(p)", "x.motor()", f"x.save({path})"]
    if kind == "params.json":
        return [f"p = {path}", "x = st.Plant.from_bam(p)", "look(x)"]
    if kind == "fit.json":
        return [f"p = {path}", "x = stiction.library.entry_of_fit(p)", "look(x)"]
    if kind == "session.toml":
        return [f"p = {path}", "x = st.load(p)", "look(x)"]
    if kind == "robot.toml":
        return [f"p = {path}", "x = stiction.robot.Robot.load(p)", "look(x)"]
    if kind == "one.urdf":
        whole = draw.file("robot.toml", damaged=False)
        return [f"p = {whole}", path, "x = stiction.robot.Robot.load(p)", "look(x)"]
    if kind == "robot-session.toml":
        return [f"p = {path}", "x = stiction.robot.load_session(p)", "look(x)"]
    if kind == "checkpoint":
        law = draw.pick(("coulomb", "hsieh_pan"))
        chunks = "[np.full(5, 0.4), np.full(5, -0.3), np.ones(3)]"
        streamed = f"list(st.stream(x, {chunks}, 1e-3, checkpoint=p))"
        return [f"p = {path}", f"x = motor({law!r})", streamed, "x.step(0.1, 1e-4)"]
    lines = [f"p = {path}", "stiction.recording.read_table(p)"]
    columns = mapped(draw, names_in(kind)) if draw.chance(0.8) else "None"
    faulty = draw.chance(0.3)
    lines.append(f"x = st.Recording.load(p, {columns}, motion='rotary', keep_faulty={faulty})")
    return [*lines, "stiction.recording.check(x)", "look(x)"]


def command_lines(draw: Draw, verb: str) -> Program:
    """A verb of the command, on files and with options that are odd now and then."""
    outless = ("laws", "effects", "init", "bench")
    out = ["'--out'", "folder + '/out'"] if verb not in outless else []
    files = {
        "fit": [draw.file("session.toml")],
        "diagnose": [draw.file("session.toml"), "'--surrogates'", "'4'"],
        "simulate": [draw.file("plant.toml"), draw.file(draw.pick(kinds()[:5]))],
        "plan": [draw.file("plant.toml"), "'--only'", "'turns'"],
        "init": [draw.file(draw.pick(kinds()[:5]))],
        "import": [draw.file("params.json")],
        "library": [repr(draw.pick([each.name for each in entries()]))],
        "compare": ["'coulomb'", "'--steps'", "'1000'"],
        "paper": ["'nested_loops'"],
        "demo": ["'--quick'"],
        "bench": bench_words(draw),
    }
    words = [repr(verb), *files.get(verb, []), *out]
    if draw.odd() or draw.chance(0.2):
        words.append(draw.pick(("'--nosuch'", "'--json'", "'--help'", "''", "'--out'", "'\\ud800'",
                                "'--seed=nan'", "'x' * 3000", "'-1'")))  # fmt: skip
    return [f"command({', '.join(words)})"]


def bench_words(draw: Draw) -> Program:
    """A bench of one short session, or files in place of one."""
    if draw.chance(0.5):
        seed = f"'{draw.random.randrange(10**9)}'"
        return ["'make'", "folder + '/bench'", "'--number=1'", "'--seconds=4,5'", "'--seed'", seed]
    return [draw.pick(("'score'", "'run'")), "folder", draw.file("params.json")]


SCENES: dict[str, Callable[[Draw], Program]] = {
    "coast": coast_lines,
    "round_trip": round_trip_lines,
}
"""What is looked at beside single calls."""


@cache
def verbs() -> tuple[str, ...]:
    """Every verb of the command."""
    app = importlib.import_module("stiction.cli.app").build()
    return tuple(verb for verb in app if not verb.startswith("-"))


@cache
def names() -> tuple[str, ...]:
    """Everything that cases are drawn for."""
    return (
        *targets(),
        *SCENES,
        *(f"file.{kind}" for kind in kinds()),
        *(f"command.{verb}" for verb in verbs()),
    )
