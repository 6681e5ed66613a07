"""Which residual the recordings of a session are seen through: the one place that chooses."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.workers import side_by_side
from ..plant import Plant
from ..plant.overlap import REMEMBERS
from ..plant.parameter import Parameter
from ..recording import Recording
from ..recording.motion import SUPPORTS_S, Kernel, noise_of
from ..recording.session_clock import ages_of, starts_of
from ..residual.finite import finite
from ..residual.loop_form import LoopForm
from ..residual.shooting import MOST_OVERLAP, ShootingForm
from ..residual.weak_form import WeakForm
from .readings import MATTERS, ROUNDED, counts_in_reach, residual_of_readings, step_of
from .rows import Nuisances, Rows

__all__ = [
    "EVERY_S",
    "KERNELS",
    "LEAST_LEFT",
    "Through",
    "as_session",
    "astray",
    "can_be_shot",
    "followable",
    "forms_of",
    "horizon_of",
    "residual_sentence",
    "restore_bounds",
    "ringing_horizon",
    "shows_its_ring",
    "soften",
    "stiffen",
    "wider_of",
    "windows_of",
]

EVERY_S: Final = (0.005, 0.010)
"""Spacing of the weak-form residual: at the least one the kernel leaves nothing between, and at the
greatest, a third of the narrowest kernel, little."""
MOST_ROWS: Final = 200_000
"""Rows of a session from which on they are spaced further: those of a thousand seconds tell more
than enough, and every row costs its share of every score."""
FEWEST_COUNTS: Final = 4.0
"""Counts in the pre-sliding reach F_c/k below which friction driven by readings is wrong: a count
more or less is then a quarter of its rise."""
LEAST_LEFT: Final = 0.03
"""Share of the measured effort that the weak form must leave: less, and it does not matter. It also
keeps out a reach that is short only because the data do not tell the stiffness."""
HORIZONS_S: Final = (0.100, 0.300)
"""Shortest and longest window: shorter ones see the rounding, longer ones average fast causes away
and let a motion that hangs on a break-away run away."""
BEYOND_SHOWN: Final = 2.0
"""A contact simulated over windows may become so many times stiffer than samples show."""
RINGS: Final = 3.0
"""Periods of its ring on the pre-sliding stiffness that a window holds: a start that is wrong by a
count sets a machine ringing, and of a ring three times as fast as itself the kernel leaves 1 %."""
MOST_WINDOWS: Final = 1_200
"""Windows of a session up to which they overlap as far as their kernel tells anything: those of a
minute and a half. Longer sessions tell more than enough, and each window costs a simulation."""
LONGEST_SHOT_S: Final = 150.0
"""Duration of a session, s, up to which a contact that yields is searched over windows: that is ten
times as dear as along a motion, and minutes beyond."""
LEAST_WINDOWS: Final = 4.0
"""Windows that the shortest recording must hold."""
MUCH_LEFT: Final = 0.1
"""Share of the measured effort from which on what is left may come from accelerations that are
wrong."""
ASTRAY: Final = 0.6
"""Share of what the readings alone make, of what is left along them, and of the motion itself,
that a simulation may leave at most for a rigid contact to have been led astray: with more it is
noise of the effort that is left either way, and the weak form sees what is fast; or the plant
stands still."""
SHOWS: Final = 0.01
"""Share of the measured effort that accelerations must take for windows to be counted by them."""
NARROW: Final = 1.5
"""Kernels that are wider by no more than this show nothing else."""
ALIKE: Final = 1e-3
"""Share by which counts and sampling times of one sensor differ."""

_Each = Callable[[Callable[[Recording], WeakForm], Sequence[Recording]], list[WeakForm]]


@dataclass(frozen=True)
class Through:
    """What recordings are seen through; kernels as narrow as their noise allows without anything.

    Attributes
    ----------
    support : float, optional
        Width of the kernels of the weak form, s.
    horizon : float, optional
        Length of the windows of a shooting residual, s.
    loop : bool
        Simulate the loop of a servo over whole recordings.
    """

    support: float | None = None
    horizon: float | None = None
    loop: bool = False


KERNELS: Final = Through()


def forms_of(
    plant: Plant, recordings: Sequence[Recording], each: _Each, through: Through = KERNELS
) -> list[WeakForm]:
    """Recordings through kernels, or simulated; their clocks are not set yet.

    Parameters
    ----------
    plant : Plant
    recordings : sequence of Recording
    each : callable
        What goes over them: ``lambda work, items: list(map(work, items))``.
    through : Through, optional
    """

    def form(recording: Recording) -> WeakForm:
        if through.loop:
            return LoopForm(plant, recording)
        if through.horizon is None:
            return WeakForm(plant, recording, support=through.support, every=every)
        return ShootingForm(plant, recording, horizon=through.horizon, overlap=overlap)

    overlap = _overlap(recordings, through.horizon)
    lasted = sum(recording.duration for recording in recordings)
    every = float(np.clip(lasted / MOST_ROWS, *EVERY_S))
    return each(form, recordings)


def _overlap(recordings: Sequence[Recording], horizon: float | None) -> float:
    """Windows of a session at any moment: no sample is left out, and few are simulated often."""
    if horizon is None:
        return MOST_OVERLAP
    alone = sum(recording.duration for recording in recordings) / horizon
    return float(np.clip(MOST_WINDOWS / alone, 1.0, MOST_OVERLAP))


def as_session(
    forms: Sequence[WeakForm], recordings: Sequence[Recording], sealed: Collection[int] = ()
) -> None:
    """Tells each recording what the others know: how noisy the sensor is, session clock and path.

    Clock and path run on from one recording to the next, and begin anew from cold. Of ``sealed``
    recordings, which nobody may look at yet, only the length in time is taken: their path is what
    others of their kind travel in that time, or any other where there is none.
    """
    _share_noise(forms, sealed)
    starts, ages = starts_of(recordings), ages_of(recordings)
    travelled = {
        k: float(np.sum(np.abs(np.diff(form.position))))
        for k, form in enumerate(forms)
        if k not in sealed
    }

    def usual(index: int) -> float:
        kind = recordings[index].kind
        alike = [k for k in travelled if recordings[k].kind == kind] or list(travelled)
        lasted = sum(recordings[k].duration for k in alike)
        own = sum(travelled[k] for k in alike)
        return own * recordings[index].duration / lasted if lasted > 0.0 else 0.0

    path = 0.0
    for index in sorted(range(len(forms)), key=lambda k: starts[k]):
        path = 0.0 if recordings[index].cold else path
        forms[index].clock, forms[index].path = ages[index], path
        path += travelled[index] if index in travelled else usual(index)


def _share_noise(forms: Sequence[WeakForm], sealed: Collection[int]) -> None:
    """Lets no recording take its sensor for a quiet one where in most of them it flickers.

    Readings hardly flicker while a machine rests, and where one rests most of the time they seem to
    have no noise, or not even counts; friction of a rigid contact then takes each of the few that
    do for a motion. What yields follows them without harm, and smooths no further than its motion
    allows. Readings without counts are left alone: what seems to be their noise is the motion.
    """
    seen = [form for k, form in enumerate(forms) if k not in sealed]
    for quiet in [form for form in forms if not form.flickers]:
        alike = [form for form in seen if np.isclose(form.dt, quiet.dt, rtol=ALIKE)]
        noisy = [form for form in alike if form.flickers and form.count > 0.0]
        if 2 * len(noisy) <= len(alike):
            continue
        count = float(np.median([form.count for form in noisy]))
        if quiet.count == 0.0 or np.isclose(quiet.count, count, rtol=ALIKE):
            quiet.count = count
            quiet.denoise(float(np.median([form.noise for form in noisy])))


def horizon_of(
    plant: Plant, nuisances: Nuisances, rows: Sequence[Rows], forms: Sequence[WeakForm]
) -> float | None:
    """How long the plant should be simulated to be compared with a session, None for not at all.

    The weak form is kept unless the readings are too coarse for it: the pre-sliding reach that it
    found holds but a few counts (or as much noise), and it leaves more than noise of the effort
    would. Then the horizon is the time in which the noise of the effort moves the position by the
    noise of its readings, or three periods of the ring in pre-sliding where that is longer; within
    0.1 to 0.3 s.

    Parameters
    ----------
    plant : Plant
        Fitted to the rows.
    nuisances : Nuisances
    rows : sequence of Rows
        That were fitted, of the weak form.
    forms : sequence of WeakForm
        Of all recordings.

    Returns
    -------
    float or None
        s; the same for all recordings of a session.
    """
    friction = plant.friction.parameters
    shortest = min(form.dt * len(form.readings) for form in forms)
    if any(form.prescribed for form in forms) or shortest < LEAST_WINDOWS * HORIZONS_S[1]:
        return None
    if plant.friction.random or not {"coulomb", "initial_stiffness"} <= friction.keys():
        return None
    if _fine(plant, [each.form for each in rows]) or not shows_its_ring(plant, forms):
        return None
    left = [each.residual(plant, nuisances)[each.mask] for each in rows]
    measured = [each.form.measured_effort(plant)[each.mask] for each in rows]
    if _size(left) < LEAST_LEFT * _size(measured):
        return None
    return ringing_horizon(plant, rows)


def ringing_horizon(plant: Plant, rows: Sequence[Rows]) -> float:
    """How long a contact that yields is simulated, s (see ``horizon_of``)."""
    drifts = float(np.median([_time(plant, each.form) for each in rows]))
    stiffness = plant.friction.parameters["initial_stiffness"].value
    rings = RINGS * 2.0 * np.pi * float(np.sqrt(plant.inertia / stiffness))
    return float(np.clip(max(drifts, rings), *HORIZONS_S))


def windows_of(
    plant: Plant, forms: Sequence[WeakForm], rows: Sequence[Rows], *, yielding: bool = False
) -> float | None:
    """Over how long a rigid contact should be simulated beside the weak form, None for not at all.

    It turns round with the reading, whatever that is off by: whether that matters is known once
    both residuals were tried (see ``astray``). The window is the longest one: the state at its
    start comes from the readings too, and the longer the window is the less hangs on it.

    Parameters
    ----------
    plant : Plant
        Fitted through kernels.
    forms : sequence of WeakForm
        Of all recordings.
    rows : sequence of Rows
        That it was fitted to.
    yielding : bool
        Also of a contact that yields, where a session is not too long for it.

    Returns
    -------
    float or None
        s; the same for all recordings of a session. None also where the inertia hardly shows: what
        is counted by it tells nothing, and a machine that follows from one sample to the next is
        slow to simulate.
    """
    if not can_be_shot(plant, forms):
        return None
    if yielding and plant.friction.springy:
        known = {"coulomb", "initial_stiffness"} <= plant.friction.parameters.keys()
        lasted = sum(form.dt * len(form.readings) for form in forms)
        able = known and lasted <= LONGEST_SHOT_S and shows_its_ring(plant, forms)
        return ringing_horizon(plant, rows) if able else None
    if not plant.friction.sticks:
        return None
    if any(REMEMBERS in effect.record.law_terms for effect in plant.effects):
        # The contact yields by its effect.
        return None
    moved = [plant.inertia * each.form.acceleration[each.mask] for each in rows]
    if _size(moved) < SHOWS * _size([each.form.measured_effort(plant)[each.mask] for each in rows]):
        return None
    return HORIZONS_S[1]


def can_be_shot(plant: Plant, forms: Sequence[WeakForm]) -> bool:
    """Whether a plant along a measured motion can be simulated over the longest windows as well.

    Not one whose contact is drawn: in which window which place breaks is no fit's to find.
    """
    if (
        plant.servo
        or plant.friction.random
        or any(form.prescribed or form.simulated for form in forms)
    ):
        return False
    shortest = min(form.dt * len(form.readings) for form in forms)
    return plant.inertia > 0.0 and shortest >= LEAST_WINDOWS * HORIZONS_S[1]


def astray(
    plant: Plant,
    nuisances: Nuisances,
    rows: Sequence[Rows],
    other: tuple[Plant, Nuisances],
    windows: Sequence[Rows],
) -> bool:
    """Whether friction that is led along the readings leaves much that its own motion does not.

    Both residuals are the same effort but for the friction; both are compared through the kernel of
    the windows. A contact at rest hides whatever else is missing, so that a simulation leaves less
    for other reasons as well. Asked is whether it leaves clearly less than the readings alone make
    of a plant that is right: they are then most of what is left along them, and more than what is
    missing. Readings that are exact, or an arm far below break-away, make a hundredth of it. And
    it has to leave less than a machine that goes on as it set out: beside an inertia that was lost
    in the fit nothing counts that the plant does.

    Parameters
    ----------
    plant : Plant
        Fitted to ``rows``.
    nuisances : Nuisances
    rows : sequence of Rows
        Of the weak form.
    other : (Plant, Nuisances)
        Fitted to ``windows``.
    windows : sequence of Rows
        Of the same recordings, simulated.
    """
    led: list[FloatArray] = []
    made: list[FloatArray] = []
    own, measured, inertial = [], [], []
    simulated = {each.index: each for each in windows}
    for each in rows:
        shot = simulated.get(each.index)
        spacing = each.form.dt * each.form.stride
        if shot is None or shot.form.kernel.support > len(each.form) * spacing:
            continue
        weights = Kernel(shot.form.kernel.support, spacing).weights
        left = finite(each.residual(plant, nuisances))
        read = residual_of_readings(each.form, plant, nuisances.start(each.index))
        inside = slice(len(weights) // 2, len(left) - len(weights) // 2)
        time = each.form.time[inside]
        counted = shot.mask & (shot.form.time >= time[0]) & (shot.form.time <= time[-1])
        if read is None:
            continue
        for efforts, found in ((left, led), (finite(read), made)):
            wide = np.convolve(efforts, weights, "valid")
            found.append(np.interp(shot.form.time[counted], time, wide))
        own.append(finite(shot.residual(*other))[counted])
        measured.append(shot.form.measured_effort(plant)[counted])
        inertial.append(plant.inertia * shot.form.acceleration[counted])
    if not led or _size(led) < MATTERS * _size(measured):
        return False
    return _size(own) < ASTRAY * min(map(_size, (made, led, inertial)))


def wider_of(
    plant: Plant, nuisances: Nuisances, rows: Sequence[Rows], forms: Sequence[WeakForm]
) -> float | None:
    """How wide kernels should be tried where narrow ones leave much, None for not at all.

    A kernel is as narrow as the white noise of the readings allows. Errors that go with the angle
    or with uneven stamps are no such noise: through a narrow kernel they make accelerations of
    their own, in which the inertia drowns, and with it whatever balances it. A quick torque that
    the plant misses does the same.

    Parameters
    ----------
    plant : Plant
        Fitted to the rows.
    nuisances : Nuisances
    rows : sequence of Rows
        That were fitted, of the weak form.
    forms : sequence of WeakForm
        Of all recordings.

    Returns
    -------
    float or None
        s.
    """
    widest = SUPPORTS_S[1]
    shortest = min(form.dt * len(form.readings) for form in forms)
    if any(form.simulated or form.prescribed for form in forms):
        return None
    if shortest < LEAST_WINDOWS * widest:
        return None
    if NARROW * min(form.kernel.support for form in forms) > widest:
        return None
    left = [each.residual(plant, nuisances)[each.mask] for each in rows]
    measured = [each.form.measured_effort(plant)[each.mask] for each in rows]
    return widest if _size(left) > MUCH_LEFT * _size(measured) else None


def followable(plant: Plant, forms: Sequence[WeakForm]) -> Plant:
    """The plant with a contact that can be simulated again and again; what is fixed stays.

    A loop is simulated whole, with a contact no stiffer than its samples show (see
    ``shows_its_ring``). Windows may come somewhat further, to where they are given up: without an
    end a contact that is rigid would be simulated stiffer and stiffer, each time for longer. Nor is
    it damped more than critically where it ends: what stops a machine within a small part of a
    sample is no other for stopping it in a smaller one, and is simulated in as many steps more.
    """
    # What is moved as its recording says rings with nothing, however stiff it is.
    if "initial_stiffness" not in plant.friction.parameters or plant.prescribed_motion:
        return plant
    shown = np.pi / max(form.dt for form in forms)
    loops = all(isinstance(form, LoopForm) for form in forms)
    beyond, start = (1.0, 0.5) if loops else (BEYOND_SHOWN, 1.0)
    ends = {
        "initial_stiffness": beyond * plant.inertia * shown**2,
        "damping": 2.0 * float(np.sqrt(beyond)) * plant.inertia * shown,
    }
    parameters = dict(plant.friction.parameters)
    for name in ends.keys() & parameters.keys():
        own = parameters[name]
        if not own.fixed:
            most = max(min(own.max or ends[name], ends[name]), own.min or 0.0)
            parameters[name] = replace(own, value=min(own.value, start * most), max=most)
    begun = plant.friction.parameters["initial_stiffness"].value
    softer = parameters["initial_stiffness"].value / begun if begun > 0.0 else 1.0
    if softer < 1.0:
        parameters = {
            **soften(parameters, softer),
            "initial_stiffness": parameters["initial_stiffness"],
        }
    return replace(plant, friction=replace(plant.friction, parameters=parameters))


def soften(parameters: Mapping[str, Parameter], softer: float) -> dict[str, Parameter]:
    """Parameters of a law with all stiffnesses that many times as large, without their bounds.

    A law that ends at a stiffness of its own ends below the one that it begins with.
    """
    return {
        name: replace(each, value=softer * each.value, min=None, max=None)
        if name.endswith("_stiffness")
        else each
        for name, each in parameters.items()
    }


def restore_bounds(plant: Plant, given: Plant) -> Plant:
    """The plant with the bounds of body and friction that were given.

    Those that ``followable`` and ``clock.bounded_plants`` set are ends of what can be simulated,
    and say nothing of the machine.
    """

    def part(
        fitted: Mapping[str, Parameter], given: Mapping[str, Parameter]
    ) -> dict[str, Parameter]:
        none = Parameter(0.0)
        stated = {name: given.get(name, none) for name in fitted}
        return {
            name: replace(own, min=stated[name].min, max=stated[name].max)
            for name, own in fitted.items()
        }

    friction = part(plant.friction.parameters, given.friction.parameters)
    return replace(
        plant,
        body=part(plant.body, given.body),
        friction=replace(plant.friction, parameters=friction),
    )


def shows_its_ring(plant: Plant, forms: Sequence[WeakForm]) -> bool:
    """Whether samples follow a machine that rings on its pre-sliding stiffness.

    Of a faster ring no reading tells, and each sample would be simulated in thousands of parts.
    """
    stiffness = plant.friction.parameters.get("initial_stiffness")
    if stiffness is None:
        return True
    ring = float(np.sqrt(stiffness.value / plant.inertia))
    return ring * max(form.dt for form in forms) < np.pi


def stiffen(forms: Sequence[WeakForm], plant: Plant) -> None:
    """Counts what simulations miss as efforts of a plant that was fitted, not of its start."""

    def counted(form: WeakForm) -> None:
        if isinstance(form, LoopForm):
            form.stiffen(plant)
        elif isinstance(form, ShootingForm):
            form.go_by(plant)

    # Each is simulated several times over, by itself.
    for _ in side_by_side(counted, forms):
        pass


def residual_sentence(forms: Sequence[WeakForm], plant: Plant) -> str:
    """Which residual was used and why, in one sentence; ``plant`` is the one that was fitted."""
    if isinstance(forms[0], LoopForm):
        return (
            "The servo was simulated from its goal over whole recordings (closed loop), because "
            "nobody measured its effort: residuals are the efforts by which it would pull the "
            "simulated position to the measured one."
        )
    supports = [1e3 * form.kernel.support for form in forms]
    if isinstance(forms[0], ShootingForm):
        return (
            f"The plant was simulated from the measured state over windows of {supports[0]:.0f} ms "
            "(shooting), because the readings of the position are too coarse to drive friction: "
            + (
                f"pre-sliding is over within {FEWEST_COUNTS:.0f} of their steps."
                if plant.friction.springy and not _fine(plant, forms)
                else "led along them, it leaves much that it does not leave along a motion of its "
                "own."
            )
        )
    width = f"{min(supports):.0f}"
    if max(supports) > min(supports) + 0.5:
        width += f" to {max(supports):.0f}"
    led = f"The plant was led along the measured motion, averaged over {width} ms (weak form)"
    if any(form.widened for form in forms):
        return (
            f"{led}: wider than noise asks for, because through narrower kernels the inertia "
            "drowned in what they show more, as where an encoder errs with the angle, or stamps "
            "are not the times of the samples; what is over sooner is averaged away."
        )
    if any(form.leads for form in forms):
        return (
            f"The plant was led along motions that it makes near the readings by itself, averaged "
            f"over {width} ms (weak form), because counts are steps of its pre-sliding."
        )
    if _fine(plant, forms):
        return f"{led}, because the readings of the position are fine enough to drive friction."
    over = (
        f"pre-sliding is over within {FEWEST_COUNTS:.0f} of the steps in which positions are read"
    )
    # What is moved does not ring.
    if any(form.prescribed for form in forms) or shows_its_ring(plant, forms):
        return f"{led}; {over}, so that it shows little."
    return (
        f"{led}, because the contact rings faster than it was sampled and cannot be simulated "
        f"instead; {over}, so that it shows little."
    )


def _fine(plant: Plant, forms: Sequence[WeakForm]) -> bool:
    """Whether readings resolve the reach of pre-sliding, so that friction can be driven by them."""
    return counts_in_reach(plant, forms) >= FEWEST_COUNTS


def _size(parts: Sequence[FloatArray]) -> float:
    return float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))


def _time(plant: Plant, form: WeakForm) -> float:
    """Time in which noise of the effort moves the position by the noise of its readings, s.

    White noise of size σ_u per sample moves a mass J by σ_u·√(dt/3)·t^(3/2)/J (rms).
    """
    effort = abs(plant.gain) * noise_of(form.effort)
    if effort <= 0.0:
        return HORIZONS_S[1]
    moved = plant.inertia * step_of(form) / ROUNDED
    return float((moved / (effort * np.sqrt(form.dt / 3.0))) ** (2.0 / 3.0))
