"""The paper's dynamic tests: Experiments 1, 2 and 3 (section 2.1.1).

The paper states the inputs: a ramp of current that is cut (1) or held (2) once a position is
reached, and pulses at 10 Hz with a duty cycle of 20 % (3). It leaves open the rate of the ramp,
the period of the controller and the pauses; those values are ours.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .._support.arrays import FloatArray
from ..errors import InputError
from .arguments import check_arguments
from .bench import Bench, fits, whole_samples
from .result import Known, MotionResult, Number, arcsec, enumerate_values
from .rig import ARC_SECOND, RigLike, is_illustrative

__all__ = [
    "PulseTrains",
    "RampAndCut",
    "RampAndHold",
    "experiment_1",
    "experiment_2",
    "experiment_3",
]

STEP = 5e-5  # s; resolves the ring of 100 Hz in detail
CONTROL_PERIOD = 1e-3  # s
RAMP_RATE = 0.25  # N·m/s
PATIENCE = 20.0  # s; a ramp that has not reached its target by then never will
READ_AFTER = (0.25, 0.5, 1.0, 2.0, 3.0)  # s after the hold of experiment 2 starts
PULSE_SIZES = (0.15, 0.2, 0.15, -0.15)  # N·m
# Swings below this are no longer told apart from the creep beneath them.
_LEAST_SWING = 0.5 * ARC_SECOND


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class RampAndCut(MotionResult):
    """Experiment 1. One entry a cut.

    Attributes
    ----------
    target : float
        Position at which the torque is cut, rad.
    cut_time, cut_torque : numpy.ndarray, shape (ramps,)
        s and N·m.
    rest_time, rest_position : numpy.ndarray, shape (rests,)
        End of each complete pause (s), and the position read there (rad).
    ring_time, ring_position : numpy.ndarray, shape (extremes,)
        Extremes of the position in the ring after the first cut, s and rad.
    ring_centre : float
        Position at the end of the first pause, rad.
    """

    target: float
    cut_time: FloatArray
    cut_torque: FloatArray
    rest_time: FloatArray
    rest_position: FloatArray
    ring_time: FloatArray
    ring_position: FloatArray
    ring_centre: float

    @property
    def ring_frequency(self) -> FloatArray:
        """Frequency of each half cycle of the first ring, Hz."""
        return 0.5 / np.diff(self.ring_time)

    @property
    def half_cycle_ratio(self) -> FloatArray:
        """Ratio of consecutive excursions from where the first ring comes to rest."""
        excursion = np.abs(self.ring_position - self.ring_centre)
        return np.asarray(excursion[1:] / excursion[:-1])


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class RampAndHold(MotionResult):
    """Experiment 2.

    Attributes
    ----------
    target : float
        Position at which the ramp stops, rad.
    hold_time, held_torque : float
        Instant from which the torque is held (s), and that torque (N·m).
    read_time, read_position : numpy.ndarray, shape (readings,)
        Instants at which the position is read (s), and the readings (rad); the first is one
        period of the controller after the hold starts.
    """

    target: float
    hold_time: float
    held_torque: float
    read_time: FloatArray
    read_position: FloatArray


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class PulseTrains(MotionResult):
    """Experiment 3. One entry a pulse.

    Attributes
    ----------
    sizes : tuple of float
        Torque of the pulses of each train, N·m.
    pulses : int
        Pulses in a train.
    pulse_torque : numpy.ndarray, shape (periods,)
        N·m.
    rest_time, rest_position : numpy.ndarray, shape (periods,)
        End of each period (s), and the position read there (rad).
    rest_hardening : numpy.ndarray, shape (periods,)
        Work hardening at the end of each period, rad; empty where the law has none.
    """

    sizes: tuple[float, ...]
    pulses: int
    pulse_torque: FloatArray
    rest_time: FloatArray
    rest_position: FloatArray
    rest_hardening: FloatArray


@check_arguments
def experiment_1(
    *,
    target: float = 24.0 * ARC_SECOND,
    ramp_rate: float = RAMP_RATE,
    duration: float = 5.0,
    pause: float = 0.25,
    rig: RigLike = None,
    integrator: str = "reference",
    dt: float = STEP,
    encoder_count: float = 0.0,
) -> RampAndCut:
    """Ramp the torque, cut it once the target is reached, pause, and repeat for 5 s.

    The controller samples every millisecond: where the encoder reads less than the target it
    applies ``ramp_rate`` times the time since the ramp began until the next sample, otherwise it
    cuts. Targets are absolute: the position is never set to zero again.

    Parameters
    ----------
    target : float
        rad; 24 arc-seconds in the paper.
    ramp_rate : float
        N·m/s; ours.
    duration : float
        Length of the experiment, s; 5 s in the paper.
    pause : float
        Time from a cut to the next ramp, s; ours.
    rig : mapping, FrictionModel or Motor, optional
        What is tested; the illustrative rig, or overrides of its parameters.
    integrator : {"reference", "fast"}
    dt : float
        Duration of a sample, s; must divide a millisecond.
    encoder_count : float
        Count of the encoder that controller and experimenter read, rad; 0 for the position itself.

    Returns
    -------
    RampAndCut
        The ring is taken from the position itself, whatever the encoder.

    Raises
    ------
    InputError
        A rig that cannot be built, a `dt` that does not divide a millisecond, or a ramp that
        never reaches the target.

    Source
    ------
    Hsieh, Pan, Wear 242 (2000), §2.1.1, Figs. 2 and 15a.

    Examples
    --------
    >>> run = experiment_1()
    >>> round(run.numbers["torque at cut 1"].value, 3)
    0.215
    """
    bench = Bench(rig, integrator, dt, encoder_count)
    cut_time, cut_torque, rest_time, rest_position = [], [], [], []
    first_pause = slice(0, 0)
    end = whole_samples(duration, dt)
    while bench.samples < end:
        torque = _ramp(bench, target, ramp_rate, end)
        if bench.samples >= end:
            break
        cut_time.append(bench.time)
        cut_torque.append(torque)
        start = bench.samples
        paused = min(whole_samples(pause, dt), end - start)
        bench.apply(np.zeros(paused))
        if paused == whole_samples(pause, dt):
            rest_time.append(bench.time)
            rest_position.append(bench.reading)
        if len(cut_time) == 1:
            first_pause = slice(start, bench.samples)
    record = bench.record()
    ring_time, ring_position = _extremes(
        record["time"][first_pause], record["position"][first_pause]
    )
    run = RampAndCut(
        title=f"Experiment 1: ramp of torque, cut at {target / ARC_SECOND:g} arc-seconds",
        source="Wear 242 (2000), Figs. 2 and 15a",
        shows="Cut loose, the rotor rings like a mass on a spring, and does not come back to "
        "where it was: a nonlinear spring and a permanent displacement that grows with "
        "every ramp.",
        target=target,
        cut_time=np.array(cut_time),
        cut_torque=np.array(cut_torque),
        rest_time=np.array(rest_time),
        rest_position=np.array(rest_position),
        ring_time=ring_time,
        ring_position=ring_position,
        ring_centre=float(record["position"][first_pause][-1]) if cut_time else math.nan,
        **record,
    )
    standard = is_illustrative(rig) and (target, ramp_rate, pause, encoder_count) == (
        24.0 * ARC_SECOND,
        RAMP_RATE,
        0.25,
        0.0,
    )
    return replace(run, numbers=_numbers_1(run, standard))


def _numbers_1(run: RampAndCut, standard: bool) -> dict[str, Number]:
    def known(*figures: Known) -> tuple[Known, ...]:
        return figures if standard else ()

    numbers = enumerate_values(
        "torque at cut",
        (Number(float(torque), "N·m") for torque in run.cut_torque),
        known(0.215, 0.200, 0.192, 0.188),
    )
    numbers |= enumerate_values(
        "rest position", map(arcsec, run.rest_position.tolist()), known(6.1, 7.6, 8.3)
    )
    if run.ring_frequency.size:
        frequency = run.ring_frequency
        slowest, fastest = (95.0, 100.0) if standard else (None, None)
        numbers["ring frequency, first half cycle"] = Number(float(frequency[0]), "Hz", slowest)
        numbers["ring frequency, last half cycle"] = Number(float(frequency[-1]), "Hz", fastest)
    ratio = run.half_cycle_ratio
    for index, word, figure in ((1, "second", 0.78), (9, "tenth", 0.845)):
        if ratio.size > index:
            numbers[f"half-cycle ratio, {word}"] = Number(
                float(ratio[index]), "1", figure if standard else None
            )
    return numbers


@check_arguments
def experiment_2(
    *,
    target: float = 12.0 * ARC_SECOND,
    ramp_rate: float = RAMP_RATE,
    hold: float = 3.0,
    rig: RigLike = None,
    integrator: str = "reference",
    dt: float = STEP,
    encoder_count: float = 0.0,
) -> RampAndHold:
    """Ramp the torque until the target is reached, then hold it: creep that slows and stops.

    The controller is that of :func:`experiment_1`; at the first sample that reads the target it
    holds the value which the ramp has at that instant.

    Parameters
    ----------
    target : float
        rad; 12 arc-seconds in the paper.
    ramp_rate : float
        N·m/s; ours.
    hold : float
        Length of the hold, s; ours.
    rig, integrator, dt, encoder_count
        As in :func:`experiment_1`.

    Returns
    -------
    RampAndHold

    Raises
    ------
    InputError
        As :func:`experiment_1`.

    Source
    ------
    Hsieh, Pan, Wear 242 (2000), §2.1.1, Figs. 3 and 15b.

    Examples
    --------
    >>> run = experiment_2()
    >>> round(run.numbers["position after 3 s"].value, 1)
    16.3
    """
    bench = Bench(rig, integrator, dt, encoder_count)
    torque = _ramp(bench, target, ramp_rate)
    hold_time, start = bench.time, bench.samples
    bench.hold(torque, hold)
    record = bench.record()
    instants = [CONTROL_PERIOD, *(t for t in READ_AFTER if t <= hold)]
    at = [start + whole_samples(t, dt) - 1 for t in instants]
    read_position = record["measured"][at]
    standard = is_illustrative(rig) and (target, ramp_rate, encoder_count) == (
        12.0 * ARC_SECOND,
        RAMP_RATE,
        0.0,
    )
    figures: Sequence[Known] = (12.05, 13.7, 14.8, 15.7, 16.25, 16.32) if standard else ()
    numbers = {"torque held": Number(torque, "N·m", 0.134 if standard else None)}
    for index, (t, position) in enumerate(zip(instants, read_position, strict=True)):
        name = "position one period after" if index == 0 else f"position after {t:g} s"
        numbers[name] = arcsec(position, figures[index] if figures else None)
    return RampAndHold(
        title=f"Experiment 2: ramp of torque, held at {target / ARC_SECOND:g} arc-seconds",
        source="Wear 242 (2000), Figs. 3 and 15b",
        shows="Under a held torque the rotor creeps, ever more slowly, and stops: work hardening.",
        numbers=numbers,
        target=target,
        hold_time=hold_time,
        held_torque=torque,
        read_time=record["time"][at],
        read_position=read_position,
        **record,
    )


@check_arguments
def experiment_3(
    *,
    sizes: Sequence[float] = PULSE_SIZES,
    pulses: int = 20,
    rig: RigLike = None,
    integrator: str = "reference",
    dt: float = STEP,
    encoder_count: float = 0.0,
) -> PulseTrains:
    """Trains of torque pulses at 10 Hz, on for the first 20 ms of each 100 ms.

    Every pulse rings and leaves a little permanent displacement, until the junctions have
    hardened to the level of the pulse; a larger pulse, or one of the other direction, starts
    anew from the hardening that is there.

    Parameters
    ----------
    sizes : sequence of float
        Torque of the pulses of each train, N·m; the paper's "varying magnitude", the values ours.
    pulses : int
        Pulses in a train; ours.
    rig, integrator, dt, encoder_count
        As in :func:`experiment_1`.

    Returns
    -------
    PulseTrains

    Raises
    ------
    InputError
        A rig that cannot be built, no pulses, or a `dt` that does not divide 20 ms.

    Source
    ------
    Hsieh, Pan, Wear 242 (2000), §2.1.1, Figs. 4 and 15c.

    Examples
    --------
    >>> run = experiment_3()
    >>> round(run.numbers["hardening after train 4"].value, 1)
    14.6
    """
    if pulses < 1 or not len(sizes):
        raise InputError(f"experiment_3: {len(sizes)} trains of {pulses} pulses; give at least one")
    sizes = tuple(sizes)
    bench = Bench(rig, integrator, dt, encoder_count)
    on, off = whole_samples(0.02, dt), whole_samples(0.08, dt)
    fits(float(on + off) * pulses * len(sizes), f"{len(sizes)} trains of {pulses} pulses")
    for size in sizes:
        bench.apply(np.tile(np.concatenate([np.full(on, size), np.zeros(off)]), pulses))
    record = bench.record()
    ends = np.arange(1, len(sizes) * pulses + 1) * (on + off) - 1
    hardening = record["states"].get("hardening", np.empty(0))
    rest_hardening = hardening[ends] if hardening.size else np.empty(0)
    standard = is_illustrative(rig) and (sizes, pulses) == (PULSE_SIZES, 20)
    figures: Sequence[Known] = (5.4, 12.6, 13.7, 14.6) if standard else ()
    numbers = enumerate_values(
        "hardening after train", map(arcsec, rest_hardening[pulses - 1 :: pulses].tolist()), figures
    )
    rest_position = record["measured"][ends]
    numbers |= enumerate_values(
        "rest position after train", map(arcsec, rest_position[pulses - 1 :: pulses].tolist())
    )
    return PulseTrains(
        title="Experiment 3: pulses of torque at 10 Hz",
        source="Wear 242 (2000), Figs. 4 and 15c",
        shows="Creep and hardening go on under pulses; smaller ones then move nothing for "
        "good, and neither do those of the other sign.",
        numbers=numbers,
        sizes=sizes,
        pulses=pulses,
        pulse_torque=np.repeat(sizes, pulses),
        rest_time=record["time"][ends],
        rest_position=rest_position,
        rest_hardening=rest_hardening,
        **record,
    )


def _ramp(bench: Bench, target: float, rate: float, end: float = math.inf) -> float:
    """Ramp until the encoder reads the target or sample `end` is reached; the torque by then."""
    block = whole_samples(CONTROL_PERIOD, bench.dt)
    for period in range(whole_samples(PATIENCE, CONTROL_PERIOD) + 1):
        torque = rate * period * CONTROL_PERIOD
        if bench.reading >= target or bench.samples >= end:
            return torque
        bench.apply(np.full(int(min(block, end - bench.samples)), torque))
    raise InputError(
        f"the ramp of {rate:g} N·m/s has not reached {target / ARC_SECOND:g} arc-seconds after "
        f"{PATIENCE:g} s; give a nearer target or a steeper ramp"
    )


def _extremes(time: FloatArray, position: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Extremes of a ring, each by a parabola through three samples, while it still swings."""
    if position.size < 3:
        return np.empty(0), np.empty(0)
    before, here, after = position[:-2], position[1:-1], position[2:]
    at = np.flatnonzero((here - before) * (after - here) < 0.0) + 1
    # After the cut the rotor may still move on for a moment; that is not part of the ring.
    at = at[time[at] - time[0] > 2.0 * CONTROL_PERIOD]
    if at.size < 2:
        return np.empty(0), np.empty(0)
    lean = position[at + 1] - position[at - 1]
    curvature = position[at + 1] - 2.0 * position[at] + position[at - 1]
    peak_time = time[at] - (time[1] - time[0]) * lean / (2.0 * curvature)
    peak = position[at] - lean**2 / (8.0 * curvature)
    faint = np.abs(np.diff(peak)) < _LEAST_SWING
    swinging = 1 + int(np.argmax(faint)) if faint.any() else at.size
    return peak_time[:swinging], peak[:swinging]
