"""Where ordinary sessions come from: simulators that know nothing of each other, in one form.

Each lays out a session's files and says what is true. `ordinary` is the bench's own machine, and
`axis4` was written from the interface's description alone, by somebody who had read none of the
package (`tests/reference/axis4`).
"""

from __future__ import annotations

import zlib
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from tests.reference.axis4 import sessions as axis4

import stiction as st
from stiction.bench.ordinary.draw import SECONDS, Spec, null_grid, ordinary, size_of
from stiction.bench.ordinary.files import write
from stiction.bench.ordinary.hidden import HIDDEN

from .draw import deck

FIRST_SEED = 5_000_000
SEEDS_EACH = 10_000
USUAL = 0.6
"""Share of sessions whose plant file states the usual law of such a machine; others state any."""
USUAL_LAWS = {"dry": "coulomb", "bristle": "dahl"}
"""What somebody would state of a machine with such a contact."""
AXIS4_SECONDS = (20.0, 30.0)
CATALOGUE = {
    "asymmetry": "direction_asymmetry",
    "position_load": "gravity_unbalance",
    "load_dependence": "effort_dependent_friction",
    "input_saturation": "drive_saturation",
    "input_dead_band": "drive_deadband",
    "torque_constant_error": "torque_constant_saturation",
    "position_friction": "position_dependent_friction",
    "temperature_drift": "warm_up",
    "log_delay": "input_delay",
}
"""Effects of the stranger's axis, where the catalogue has another word."""
SPRING = "position_spring"
"""Of a linear axis: no effect of the catalogue."""


@dataclass(frozen=True)
class Laid:
    """A session on the disk, and what is true of it.

    `reached` is the rms of what is hidden, `left` of what the plant that is stated cannot take up;
    shares of the dry friction. `left` is None where it was not measured.
    """

    path: Path
    spec: dict[str, Any]
    seed: int
    names: list[str]
    reached: float
    truth: dict[str, float]
    left: float | None = None


@dataclass(frozen=True)
class OrdinaryCase:
    """A session of the bench's machine, and what it is counted as."""

    kind: str
    spec: Spec

    @property
    def key(self) -> str:
        spec = self.spec
        return f"{self.kind} {spec.seed} {spec.law} {spec.hidden} {spec.size}"

    def lay(self, folder: Path) -> Laid:
        made = ordinary(self.spec)
        machine = made.machine
        return Laid(
            path=write(made, folder),
            spec={name: value for name, value in asdict(made.spec).items() if name != "seed"},
            seed=made.spec.seed,
            names=made.names,
            reached=made.relative_rms,
            truth={
                "inertia": machine.inertia,
                "coulomb": machine.coulomb,
                "viscous": machine.viscous + machine.counter,
            },
        )


@dataclass(frozen=True)
class Axis4Case:
    """A session of the stranger's axis."""

    kind: str
    bench: axis4.Bench
    effect: str | None
    share: float

    @property
    def key(self) -> str:
        return f"axis4 {self.kind} {self.bench.seed} {self.effect} {self.share:.6g}"

    def lay(self, folder: Path) -> Laid:
        bench = self.bench
        truth = folder.parent / "truth"
        facts = axis4.write(bench, self.effect, self.share, folder, truth)
        machine = bench.machine
        law = axis4.stated_law(machine)
        return Laid(
            path=folder / "session.toml",
            spec={
                "law": law,
                "contact": machine.contact,
                "own_law": True,
                "kind": "driven",
                "recordings": len(bench.kinds),
                "seconds": bench.seconds * len(bench.kinds),
                "dt": bench.period,
                "counts": bench.counts,
                "log_noise": bench.log_noise,
                "loop": bench.loop.kind if bench.loop else "open",
                "drive": bench.family,
                "signals": bench.kinds,
            },
            seed=bench.seed,
            names=[catalogued(self.effect, bench.linear)] if self.effect else [],
            reached=float(facts["share"]),
            left=float(facts["share_left_by_the_fit"]),
            truth={
                "inertia": machine.inertia,
                "coulomb": machine.coulomb,
                "viscous": machine.viscous,
            },
        )


def catalogued(effect: str, linear: bool) -> str:
    """Name in the catalogue of an effect of the stranger's axis."""
    if effect == "position_load" and linear:
        return SPRING
    return CATALOGUE.get(effect, effect)


def ordinary_cases(kinds, number, seed, seconds=None):
    """The cases of some kinds; a longer list begins with the shorter one."""
    found = [OrdinaryCase("grid", spec) for spec in null_grid()] if "grid" in kinds else []
    drawn = [kind for kind in kinds if kind != "grid"]
    rng = np.random.default_rng([seed, zlib.crc32(b"ordinary cases")])
    laws, effects = deck(rng, [law.name for law in st.laws()]), deck(rng, HIDDEN)
    for k in range(number if drawn else 0):
        contact = str(rng.choice(["dry", "dry", "bristle"]))
        law = USUAL_LAWS[contact] if rng.random() < USUAL else next(laws)
        kind = drawn[k % len(drawn)]
        length = None if seconds in (None, SECONDS) else float(rng.uniform(*seconds))
        own = FIRST_SEED + SEEDS_EACH * seed + k
        spec = Spec(own, law=law, contact=contact, seconds=length)
        if kind == "hidden":
            spec = Spec(**asdict(spec) | {"hidden": next(effects), "size": size_of(rng)})
        found.append(OrdinaryCase(kind, spec))
    return found


def axis4_cases(kinds, number, seed, seconds=None):
    """As many of each kind as `number` asks for in all; each effect comes once in sixteen."""
    wanted = [kind for kind in kinds if kind != "grid"]
    each = -(-number // len(wanted)) if wanted else 0
    planned = axis4.plan(seed, each, seconds or AXIS4_SECONDS)
    found = [
        Axis4Case("hidden" if c.effect else "null", c.bench, c.effect, c.share) for c in planned
    ]
    return [case for case in found if case.kind in wanted]


PLANTS = {"ordinary": ordinary_cases, "axis4": axis4_cases}
