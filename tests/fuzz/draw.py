"""Draws values as text: plausible ones, and now and then what nobody would give."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence
from typing import Any

import stiction as st
from stiction.catalogue import EffectRecord, LawRecord, ParameterRecord
from stiction.plan import EXPERIMENTS

from .files import DAMAGES, kinds

EXTREMES = (
    "0.0", "-0.0", "5e-324", "-5e-324", "1e-300", "1e-30", "1e-17", "1e-12", "1e6", "1e9", "-1e9",
    "1e16", "1e30", "-1e150", "1e154", "-1e300", "1e304", "-1e304", "1.7976931348623157e308",
    "-1e308", "inf", "-inf", "nan", "2**31", "2**63", "-1", "10**400",
)  # fmt: skip
"""Numbers at which something may give way."""
ODD_TEXTS = (
    "''", "'\\x00'", "'\\ud800'", "'é'", "'\\u202e'", "'Ω·m²'", "'a\\nb'", "'nan'", "'{}'", "'%s'",
    "'../x'", "'\\ufeffx'", "'\\U0001f600'", "'x' * 5000", "'[bold]'", "'ſ'", "'İ'",
)  # fmt: skip
FOREIGN = (
    "None", "True", "1j", "'1'", "b'1'", "[]", "{}", "()", "[[1.0, 2.0]]", "np.zeros((2, 2))",
    "np.array(3.0)", "np.array(['a'])", "object", "np.zeros(0)", "range(3)", "[None]", "[1, 'a']",
    "np.array([1.0], dtype=object)", "np.array([1j])", "np.float32(0.1)", "np.int64(3)",
    "np.zeros((0, 2))", "np.ma.masked", "np.datetime64('2020')", "(lambda: 1)", "Ellipsis",
    "np.complex128(1j)", "np.array(['2020'], dtype='datetime64[D]')", "np.timedelta64(3)",
    "{'a': 1.0}", "{1.0, 2.0}", "iter([1.0])", "[1.0, 1.0]", "np.array([1.0, np.nan])",
)  # fmt: skip
"""Values of another kind than what is wanted."""
LARGE = ("1e16", "-1e30", "1e150", "-1e154", "1e300", "-1e304", "1e308", "-1.7e308")
"""Finite numbers among plain ones, whose square or product may be none."""
SPIKES = 0.04
LENGTHS = (0, 1, 2, 3, 7, 40, 200)
SERVO = ("proportional", "integral", "derivative", "duty_limit", "supply", "resistance",
         "current_limit")  # fmt: skip
LAWS: dict[str, LawRecord] = {law.name: law for law in st.laws()}
EFFECTS: dict[str, EffectRecord] = {effect.name: effect for effect in st.effects()}


class Draw:
    """Everything that one case draws, from a source of its own.

    Parameters
    ----------
    seed : str
        The same seed draws the same case.
    wild : float, optional
        How often a value is odd; drawn as well without it.
    """

    def __init__(self, seed: str, wild: float | None = None) -> None:
        self.random = random.Random(seed)
        drawn = self.random.choice((0.0, 0.0, 0.02, 0.1, 0.3))
        self.wild = drawn if wild is None else wild
        self.n = self.random.choice(LENGTHS[1:])

    def odd(self) -> bool:
        """Whether the next value is one that nobody would give."""
        return self.random.random() < self.wild

    def odd_one(self) -> str:
        """A value that nobody would give: of another kind, an extreme number, an odd word."""
        return str(self.pick(self.pick((FOREIGN, FOREIGN, EXTREMES, ODD_TEXTS))))

    def chance(self, share: float) -> bool:
        return self.random.random() < share

    def pick(self, values: Sequence[Any]) -> Any:
        return self.random.choice(values)

    # Numbers

    def size(self, low: float = -4.0, high: float = 1.0) -> str:
        """A number above 0, of any decade between these."""
        if self.odd():
            return str(self.pick(EXTREMES if self.chance(0.8) else FOREIGN))
        return f"{10.0 ** self.random.uniform(low, high):.4g}"

    def signed(self, low: float = -4.0, high: float = 1.0) -> str:
        """Of either sign, or 0."""
        if self.chance(0.1):
            return "0.0"
        number = self.size(low, high)
        return f"-{number}" if self.chance(0.5) and number[0].isdigit() else number

    def whole(self, low: int, high: int) -> str:
        if self.odd():
            return str(self.pick(("-1", "0", "2.5", "True", "2**63", "-(2**63)", "10**30", "nan",
                                  "None", "'3'")))  # fmt: skip
        return str(self.random.randint(low, high))

    def within(self, spec: ParameterRecord) -> str:
        """A value of a parameter: about the typical one, at a bound, or beyond it."""
        low, high = spec.bounds
        if self.odd():
            beyond = (low - abs(low) - 1.0, high + abs(high) + 1.0)
            return str(self.pick((*EXTREMES, *FOREIGN[:8], *map(text_of, beyond))))
        if self.chance(0.12):
            return text_of(self.pick((low, high, spec.default)))
        if self.chance(0.1):
            far = abs(spec.typical or 1.0) * 10.0 ** self.random.uniform(-12.0, 12.0)
            return text_of(min(max(self.pick((-far, far)), low), high))
        near = (spec.typical or 1.0) * 10.0 ** self.random.uniform(-1.5, 1.5)
        near = -near if self.chance(0.3) else near
        return f"{min(max(near, low), high):.6g}"

    # Arrays

    def array(self, low: float = -3.0, high: float = 0.5, *, n: int | None = None) -> str:
        """n numbers: the length of the case, nearly always."""
        length = self.n if n is None else n
        if self.odd():
            length = self.pick((*LENGTHS, length + 1, length))
            if self.chance(0.3):
                return str(self.pick(FOREIGN))
        if length <= 4:
            cells = [self.signed(low, high) for _ in range(length)]
            if cells and self.chance(SPIKES):
                cells[self.random.randrange(length)] = str(self.pick(LARGE))
            return f"[{', '.join(cells)}]"
        size = 10.0 ** self.random.uniform(low, high)
        text = f"wave({length}, {self.random.randint(0, 999)}, {size:.3g})"
        if self.chance(SPIKES):
            text = f"spoiled({text}, {self.random.randint(0, length)}, {self.pick(LARGE)})"
        elif self.odd():
            text = f"spoiled({text}, {self.random.randint(0, length)}, {self.size()})"
        elif self.odd():
            text = f"masked({text}, {self.random.randint(0, length)})"
        return text

    def per_sample(self, low: float, high: float) -> str:
        """One number for all samples, or one for each."""
        return self.signed(low, high) if self.chance(0.5) else self.array(low, high)

    def steps(self) -> str:
        """Durations of samples, s: now and then coarse, or one for each."""
        coarse = self.chance(0.15)
        one = self.size(-1.0, 3.0) if coarse else self.size(-6.0, -2.0)
        if self.chance(0.8):
            return one
        return f"positive({self.array(-6.0, -2.0)})"

    def rising(self) -> str:
        count = self.random.randint(0, 5)
        stamps = sorted(10.0 ** self.random.uniform(-4.0, 0.0) for _ in range(count))
        texts = [f"{t:.4g}" for t in stamps]
        if texts and self.odd():
            texts[self.random.randrange(len(texts))] = self.pick(EXTREMES)
        return f"[{', '.join(texts)}]"

    # Words

    def text(self, words: Sequence[str]) -> str:
        if self.odd() or not words:
            return str(self.pick((*ODD_TEXTS, "'nonsense'", *FOREIGN[:6])))
        return repr(self.pick(words))

    def texts(self, words: Sequence[str], most: int = 3) -> str:
        if self.odd() and self.chance(0.3):
            return self.text(words)
        count = self.random.randint(0, min(most, len(words)))
        chosen = self.random.sample(list(words), count)
        texts = [self.text([word]) for word in chosen]
        return f"[{', '.join(texts)}]"

    def table(self, rows: dict[str, str]) -> str:
        return "{" + ", ".join(f"{name!r}: {value}" for name, value in rows.items()) + "}"

    # The package's own

    def law(self, name: str = "", share: float = 0.5, *, effects: bool = False) -> str:
        """A friction model of any law, now and then with effects at the contact."""
        name = name or self.pick(sorted(LAWS))
        record = LAWS[name]
        given = [self.text([name])]
        stated = [p for p in record.parameters if self.chance(share)]
        given += [f"{p.name}={self.within(p)}" for p in stated]
        given += [
            f"{option.name}={self.text([word for word, _ in option.choices])}"
            for option in record.options
            if self.chance(0.5)
        ]
        if effects and self.chance(0.4):
            known = [name for name in sorted(EFFECTS) if EFFECTS[name].at_contact or self.odd()]
            given.append(f"effects={self.effects(known)}")
        if self.odd():
            given.append(f"nonsense={self.size()}")
        return f"st.FrictionModel({', '.join(given)})"

    def effects(self, names: Sequence[str] | None = None) -> str:
        """Effects, singly and in sums."""
        known = sorted(EFFECTS) if names is None else list(names)
        count = self.pick((0, 1, 1, 1, 2, 3, 5))
        rows = {}
        for name in self.random.sample(known, min(count, len(known))):
            record = EFFECTS[name]
            stated = [p for p in record.parameters if self.chance(0.7)]
            rows[name] = self.table({p.name: self.within(p) for p in stated})
        if self.odd():
            rows["nonsense"] = "{}"
        return self.table(rows)

    def servo(self) -> str:
        return self.table({name: self.size(-1.0, 1.5) for name in SERVO if self.chance(0.7)})

    def motor(self, **parts: str) -> str:
        """A motor with any law, effects, drive and body."""
        friction = parts.pop("friction", "") or self.law()
        given = [self.size(-5.0, 1.0)]
        keywords = {"torque_constant": self.signed(-2.0, 2.0), "effects": self.effects(),
                    "gravity_amplitude": self.signed(-2.0, 1.0), "gravity_zero": self.signed(),
                    "weight": self.signed(-2.0, 1.0), "input_limit": self.size(-1.0, 1.0),
                    "servo": self.servo(), "count": self.size(-6.0, -2.0),
                    "integrator": self.text(("fast", "reference"))}  # fmt: skip
        often = {"effects": 0.5, "torque_constant": 0.4, "integrator": 0.3}
        kept = {k: v for k, v in keywords.items() if self.chance(often.get(k, 0.15))} | parts
        given += [f"friction={friction}", *(f"{k}={v}" for k, v in kept.items())]
        return f"st.Motor({', '.join(given)})"

    def numbers_of_plant(self, specs: Sequence[ParameterRecord], share: float) -> dict[str, str]:
        rows = {}
        for spec in specs:
            if self.chance(share):
                value = self.within(spec)
                fixed = self.chance(0.2)
                rows[spec.name] = f"{{'value': {value}, 'fixed': True}}" if fixed else value
        return rows

    def plant_table(self) -> str:
        """The tables of a plant file."""
        law = LAWS[self.pick(sorted(LAWS))]
        rows = {"friction": self.table({"law": self.text([law.name]),
                                        **self.numbers_of_plant(law.parameters, 0.3)})}  # fmt: skip
        linear = self.chance(0.25)
        if linear:
            rows["motion"] = "{'kind': 'linear'}"
        if self.chance(0.9):
            body = {"inertia": self.size(-5.0, 1.0)}
            name = "weight_n" if linear else "gravity_amplitude"
            rows["body"] = self.table(body | ({name: self.signed()} if self.chance(0.2) else {}))
        servo = self.chance(0.15)
        if servo:
            numbers = {"proportional": 3.0, "supply_v": 12.0, "resistance_ohm": 4.0,
                       "torque_constant": 0.8, "current_limit_a": 2.0}  # fmt: skip
            drive = {k: str(v) if self.chance(0.5) else self.size() for k, v in numbers.items()}
            rows["drive"] = self.table({"kind": "'servo'"} | drive)
        elif self.chance(0.6):
            rows["drive"] = self.table({"gain": self.signed(-2.0, 2.0)} | (
                {"limit": self.size()} if self.chance(0.3) else {}))  # fmt: skip
        motion = "linear" if linear else "rotary"
        fit = [e for e in EFFECTS.values() if not e.impossible(motion, servo=servo)]
        if self.chance(0.5):
            chosen = self.random.sample(fit, self.random.randint(1, 3))
            entries = [self.table({"name": self.text([e.name]),
                                   **self.numbers_of_plant(e.parameters, 0.5)})
                       for e in chosen]  # fmt: skip
            rows["effects"] = f"[{', '.join(entries)}]"
        if self.chance(0.3):
            sensor = "count_m" if linear else "counts_per_rev"
            rows["sensor"] = self.table({sensor: self.size(1.0, 5.0)})
        if self.chance(0.2) and not servo:
            kind = self.pick(("pd", "pid", "position_velocity"))
            gains = {"pd": ("kp", "kd"), "pid": ("kp", "ki", "kd")}.get(kind, ("kp", "kv"))
            rows["controller"] = self.table({"kind": self.text([kind])} |
                                            {g: self.signed(-1.0, 1.0) for g in gains})  # fmt: skip
        if self.odd():
            rows["nonsense"] = "{}"
        return self.table(rows)

    def plant(self) -> str:
        if self.odd() and self.chance(0.3):
            return str(self.pick((*FOREIGN, "'plant.toml'")))
        if self.chance(0.3):
            return f"plant({self.pick(sorted(LAWS))!r})"
        return f"st.Plant.from_dict({self.plant_table()})"

    def recording(self) -> str:
        if self.chance(0.4):
            return f"recording({self.random.randint(200, 300)}, {self.random.randint(0, 20)})"
        rows = self.random.randint(200, 260)
        time = f"0.01 * np.arange({rows}.0)"
        arrays = [
            f"spoiled({time}, {self.random.randint(0, rows)}, {self.size()})"
            if self.odd()
            else time,
            self.array(n=rows),
            self.array(-6.0, -1.0, n=rows),
        ]
        channels = [name for name in ("velocity", "reference", "load", "temperature", "enabled")
                    if self.chance(0.1)]  # fmt: skip
        arrays += [f"{name}={self.array(n=rows)}" for name in channels]
        arrays += [f"role={self.text(('train', 'select', 'test'))}"] if self.chance(0.2) else []
        return f"st.Recording({', '.join(arrays)})"

    def session(self) -> str:
        if self.odd() and self.chance(0.3):
            return str(self.pick((*FOREIGN, "'session.toml'")))
        if self.chance(0.5):
            return f"session({self.random.randint(0, 9)}, {self.random.randint(10, 19)})"
        count = self.random.randint(1, 3)
        return f"[{', '.join(self.recording() for _ in range(count))}]"

    # Files

    def damage(self) -> str:
        """What is done to a file."""
        share = f"{self.random.random():.5f}"
        length = str(self.pick((1, 2, 4, 8, 30, 300, 3000)))
        place = str(self.random.randint(0, 3000))
        forms: dict[str, Callable[[], list[str]]] = {
            "cut": lambda: [share],
            "flip": lambda: [share, str(self.random.randint(1, 255))],
            "fill": lambda: [share, length, str(self.pick((0, 255, 32, 128)))],
            "drop": lambda: [share, length],
            "twice": lambda: [share, length],
            "swap": lambda: [share, f"{self.random.random():.5f}", length],
            "put": lambda: [share, self.pick(ODD_TEXTS)],
            "number": lambda: [place, repr(self.pick((*EXTREMES, "1e999", "0x10", "", "1_000")))],
            "word": lambda: [place, self.pick((*ODD_TEXTS, "'friction'", "'law'", "'_'"))],
            "nest": lambda: [place, str(self.pick((1, 50, 5000))),
                             repr(self.pick(("[|]", "{a=|}", '{"a":|}', "(|)")))],
            "line": lambda: [place, str(self.pick((0, 2, 40)))],
        }  # fmt: skip
        name = self.pick(sorted(DAMAGES))
        return f"({', '.join([repr(name), *forms[name]()])},)"

    def file(self, kind: str = "", *, damaged: bool | None = None) -> str:
        """A file of a kind, sound or damaged."""
        kind = kind or self.pick(kinds())
        hurt = self.wild > 0.0 and self.chance(0.8) if damaged is None else damaged
        count = self.pick((1, 1, 1, 2, 4)) if hurt else 0
        damages = [self.damage() for _ in range(count)]
        return f"file({', '.join([repr(kind), str(self.random.randint(0, 59)), *damages])})"

    def experiments(self) -> str:
        return self.texts([experiment.name for experiment in EXPERIMENTS], 1)


def text_of(value: float) -> str:
    """A number as a program writes it."""
    return repr(float(value)) if math.isfinite(value) else str(float(value))
