"""What cannot be used is refused with a sentence, and its good twin is taken."""

import math
import pickle

import numpy as np
import pytest

import stiction as st

from .rigs import INERTIA, contact, motor, same_state

DT = 1e-3
NAN, INF = math.nan, math.inf


def model():
    return contact("hook")


def machine(**keywords):
    return motor("hook", **keywords)


def law(name="hsieh_pan", **keywords):
    return lambda: st.FrictionModel(name, **keywords)


def with_state(make, **changes):
    """Assign a state with changed entries; an Ellipsis takes the entry away."""

    def assign():
        target = make()
        state = target.state | changes
        target.state = {name: value for name, value in state.items() if value is not ...}
        return target

    return assign


def nested(points, spring, direction, **more):
    entries = {
        "reverse_points": np.array(points, dtype=float).reshape(-1, 2),
        "spring": spring,
        "direction": direction,
    }
    return with_state(model, **entries, **more)


def read_only(n):
    array = np.zeros(n)
    array.flags.writeable = False
    return array


# (what is wrong, its good twin, words that the sentence must hold)
REFUSED = {
    # Construction.
    "unknown law": (law("hseih_pan"), law("hsieh_pan"), ["hseih_pan", "did you mean 'hsieh_pan'"]),
    "unknown parameter": (
        law(break_away=0.5),
        law(breakaway=0.5),
        ["break_away", "did you mean 'breakaway'"],
    ),
    "parameter of another law": (
        law("coulomb", damping=0.1),
        law("coulomb", viscous=0.1),
        ["damping", "coulomb"],
    ),
    "unknown option": (
        law(virgin="same"),
        law(virgin_curve="same"),
        ["virgin", "virgin_curve"],
    ),
    "unknown word of an option": (
        law(damper="body"),
        law(damper="hook"),
        ["body", "hook, spring"],
    ),
    "option given as a number": (law(damper=1.0), law(damper="spring"), ["damper"]),
    "parameter given as a word": (law(viscous="0.1"), law(viscous=0.1), ["viscous"]),
    "parameter given as a list": (law(viscous=[0.1]), law(viscous=0.1), ["viscous", "list"]),
    "parameter given as None": (law(viscous=None), law(viscous=0.1), ["viscous", "NoneType"]),
    "parameter not a number": (law(viscous=NAN), law(viscous=0.0), ["viscous", "finite"]),
    "parameter infinite": (law(viscous=INF), law(breakaway=INF), ["viscous", "inf"]),
    "parameter below its bounds": (law(viscous=-1.0), law(viscous=0.0), ["viscous = -1", "0 to"]),
    "parameter above its bounds": (
        law(hardening_exponent=11.0),
        law(hardening_exponent=10.0),
        ["hardening_exponent = 11", "10"],
    ),
    "exponent that gives f a slope at 0": (
        law(hardening_exponent=1.0),
        law(hardening_exponent=1.0001),
        ["hardening_exponent = 1 "],
    ),
    "spring that stiffens": (
        law(initial_stiffness=1.0, final_stiffness=2.0),
        law(initial_stiffness=2.0, final_stiffness=1.0),
        ["final_stiffness = 2", "stay below", "initial_stiffness = 1"],
    ),
    "spring that does not soften": (
        law(initial_stiffness=1.0, final_stiffness=1.0),
        law(initial_stiffness=1.0, final_stiffness=0.99),
        ["final_stiffness", "stay below"],
    ),
    "sliding above break-away": (
        law(coulomb=0.6, breakaway=0.5),
        law(coulomb=0.5, breakaway=0.5),
        ["coulomb = 0.6", "not exceed", "breakaway = 0.5"],
    ),
    "sliding above break-away, dry": (
        law("coulomb", coulomb=0.6, breakaway=0.5),
        law("coulomb", coulomb=0.5, breakaway=0.5),
        ["coulomb = 0.6", "not exceed"],
    ),
    # Steps.
    "velocity not a number": (
        lambda: model().step(NAN, DT),
        lambda: model().step(0.1, DT),
        ["velocity = NaN"],
    ),
    "velocity infinite": (
        lambda: model().step(-INF, DT),
        lambda: model().step(1e5, DT),
        ["velocity = -inf"],
    ),
    "dt zero": (lambda: model().step(0.1, 0.0), lambda: model().step(0.1, 1e-300), ["dt = 0"]),
    "dt negative": (
        lambda: model().step(0.1, -1e-3),
        lambda: model().step(0.1, 1e-3),
        ["dt = -0.001", "positive"],
    ),
    "dt not a number": (
        lambda: model().step(0.1, NAN),
        lambda: model().step(0.1, DT),
        ["dt = NaN"],
    ),
    "dt infinite": (lambda: model().step(0.1, INF), lambda: model().step(0.1, 1e6), ["dt = inf"]),
    "load not a number": (
        lambda: model().step(0.1, DT, load=NAN),
        lambda: model().step(0.1, DT, load=1.0),
        ["load = NaN"],
    ),
    "effort infinite": (
        lambda: model().step(0.1, DT, effort=INF),
        lambda: model().step(0.1, DT, effort=1e300),
        ["effort = inf"],
    ),
    "efforts that cancel to nothing finite": (
        lambda: model().step(0.1, DT, effort=INF, load=-INF),
        lambda: model().step(0.1, DT, effort=1.0, load=-1.0),
        ["load = -inf"],
    ),
    "temperature not a number": (
        lambda: model().step(0.1, DT, temperature=NAN),
        lambda: model().step(0.1, DT, temperature=None),
        ["temperature = NaN"],
    ),
    "trial with a bad velocity": (
        lambda: model().trial(NAN, DT),
        lambda: model().trial(0.1, DT),
        ["velocity"],
    ),
    "trial with a bad dt": (lambda: model().trial(0.1, 0), lambda: model().trial(0.1, 1), ["dt"]),
    "commit of nothing": (
        lambda: model().commit(),
        lambda: (lambda m: (m.trial(0.1, DT), m.commit()))(model()),
        ["trial"],
    ),
    # Arrays.
    "0-d array": (
        lambda: model().simulate(np.array(0.1), DT),
        lambda: model().simulate(np.array([0.1]), DT),
        ["velocity", "single number"],
    ),
    "number for an array": (
        lambda: model().simulate(0.1, DT),
        lambda: model().simulate([0.1], DT),
        ["single number"],
    ),
    "no samples": (
        lambda: model().simulate([], DT),
        lambda: model().simulate([0.0], DT),
        ["velocity is empty"],
    ),
    "no rows": (
        lambda: model().simulate(np.zeros((0, 4)), DT),
        lambda: model().simulate(np.zeros((1, 4)), DT),
        ["empty"],
    ),
    "rows of nothing": (
        lambda: model().simulate(np.zeros((4, 0)), DT),
        lambda: model().simulate(np.zeros((4, 1)), DT),
        ["empty"],
    ),
    "three dimensions": (
        lambda: model().simulate(np.zeros((2, 2, 2)), DT),
        lambda: model().simulate(np.zeros((2, 2)), DT),
        ["[2, 2, 2]", "(batch, n)"],
    ),
    "words in an array": (
        lambda: model().simulate(["a", "b"], DT),
        lambda: model().simulate(["1", "2"], DT),
        ["velocity", "numbers"],
    ),
    "ragged lists": (
        lambda: model().simulate([[1.0], [1.0, 2.0]], DT),
        lambda: model().simulate([[1.0], [2.0]], DT),
        ["velocity", "numbers"],
    ),
    "nothing for an array": (
        lambda: model().simulate(None, DT),
        lambda: model().simulate([0.0], DT),
        ["velocity"],
    ),
    "complex numbers": (
        lambda: model().simulate(np.array([1.0 + 2.0j]), DT),
        lambda: model().simulate(np.array([1.0]), DT),
        ["velocity"],
    ),
    "a gap in an array": (
        lambda: model().simulate([0.1, NAN, 0.1], DT),
        lambda: model().simulate([0.1, 0.1], DT),
        ["velocity[1] = NaN"],
    ),
    "infinity in an array": (
        lambda: model().simulate([0.1, INF], DT),
        lambda: model().simulate([0.1, 1e5], DT),
        ["velocity[1] = inf"],
    ),
    "effort of another length": (
        lambda: model().simulate([0.1, 0.2], DT, effort=[0.1]),
        lambda: model().simulate([0.1, 0.2], DT, effort=[0.1, 0.1]),
        ["effort"],
    ),
    "effort of a row for a batch": (
        lambda: model().simulate(np.zeros((2, 3)), DT, effort=np.zeros(3)),
        lambda: model().simulate(np.zeros((2, 3)), DT, effort=np.zeros((2, 3))),
        ["effort has shape [3]", "[2, 3]"],
    ),
    "load with a gap": (
        lambda: model().simulate([0.1, 0.2], DT, load=[0.1, NAN]),
        lambda: model().simulate([0.1, 0.2], DT, load=[0.1, 0.2]),
        ["load[1] = NaN"],
    ),
    "temperature of another shape": (
        lambda: model().simulate([0.1, 0.2], DT, temperature=[20.0, 20.0, 20.0]),
        lambda: model().simulate([0.1, 0.2], DT, temperature=[20.0, 20.0]),
        ["temperature"],
    ),
    "dt of a friction model zero": (
        lambda: model().simulate([0.1], 0.0),
        lambda: model().simulate([0.1], 1e-9),
        ["dt = 0"],
    ),
    # States.
    "state entry missing": (
        with_state(model, hardening=...),
        with_state(model, hardening=0.0),
        ["hardening", "missing"],
    ),
    "state entry too many": (
        with_state(model, temperature=20.0),
        with_state(model),
        ["temperature", "not part"],
    ),
    "state of another law": (
        lambda: setattr(model(), "state", contact("coulomb").state),
        lambda: setattr(model(), "state", contact("hook").state),
        ["state entry"],
    ),
    "state entry not a number": (
        with_state(model, hardening=NAN),
        with_state(model, hardening=1e-5),
        ["hardening", "finite"],
    ),
    "state entry infinite": (
        with_state(model, spring_force=INF),
        with_state(model, spring_force=0.1),
        ["spring_force", "finite"],
    ),
    "state entry a word": (
        with_state(model, plastic="much"),
        with_state(model, plastic=1e-6),
        ["plastic", "neither number nor array"],
    ),
    "state entry None": (
        with_state(model, plastic=None),
        with_state(model, plastic=0),
        ["plastic"],
    ),
    "number where points belong": (
        with_state(model, reverse_points=1.0),
        with_state(model, reverse_points=np.zeros((0, 2))),
        ["reverse_points"],
    ),
    "points where a number belongs": (
        with_state(model, hardening=np.zeros((1, 2))),
        with_state(model, hardening=np.float64(0.0)),
        ["hardening"],
    ),
    "points of three numbers": (
        with_state(model, reverse_points=np.zeros((2, 3))),
        nested([[1e-4, 0.2]], 5e-5, -1.0),
        ["reverse_points", "(n, 2)"],
    ),
    "points with a gap": (
        nested([[1e-4, NAN]], 5e-5, -1.0),
        nested([[1e-4, 0.2]], 5e-5, -1.0),
        ["reverse_points"],
    ),
    "points that do not nest": (
        nested([[1e-4, 0.2], [-5e-5, -0.1], [3e-4, 0.4]], 1e-5, -1.0),
        nested([[1e-4, 0.2], [-5e-5, -0.1], [5e-5, 0.1]], 1e-5, -1.0),
        ["reverse_points", "nest"],
    ),
    "spring outside its last loop": (
        nested([[1e-4, 0.2], [-5e-5, -0.1]], 2e-4, 1.0),
        nested([[1e-4, 0.2], [-5e-5, -0.1]], 5e-5, 1.0),
        ["nest"],
    ),
    "direction against the last point": (
        nested([[1e-4, 0.2]], 5e-5, 1.0),
        nested([[1e-4, 0.2]], 5e-5, -1.0),
        ["direction"],
    ),
    "no direction although points are remembered": (
        nested([[1e-4, 0.2]], 5e-5, 0.0),
        nested([[1e-4, 0.2]], 5e-5, -1.0),
        ["direction"],
    ),
    "virgin spring that moves back": (
        nested([], 5e-5, -1.0),
        nested([], 5e-5, 1.0),
        ["reverse_points"],
    ),
    "mode that is none": (
        with_state(model, mode=2.0),
        with_state(model, mode=1.0),
        ["mode", "allowed"],
    ),
    "slide of a contact that never slips": (
        with_state(lambda: contact("sticking"), mode=1.0),
        with_state(lambda: contact("sticking"), mode=0.0),
        ["mode"],
    ),
    "half a reversal": (
        with_state(model, reversals=0.5),
        with_state(model, reversals=1.0),
        ["reversals", "whole"],
    ),
    "fewer than no reversals": (
        with_state(model, reversals=-1.0),
        with_state(model, reversals=0.0),
        ["reversals", "whole"],
    ),
    "more reversals than can be counted": (
        with_state(model, reversals=1e300),
        with_state(model, reversals=1e15),
        ["reversals", "whole"],
    ),
    "mode of coulomb that is none": (
        with_state(lambda: contact("coulomb"), mode=0.5),
        with_state(lambda: contact("coulomb"), mode=-1.0),
        ["mode"],
    ),
    "state key not a word": (
        lambda: setattr(model(), "state", model().state | {1: 2.0}),
        lambda: setattr(model(), "state", model().state),
        ["not a word"],
    ),
    # Motors.
    "no friction": (
        lambda: st.Motor(inertia=INERTIA),
        lambda: st.Motor(inertia=INERTIA, friction=model()),
        ["friction is missing"],
    ),
    "no inertia": (lambda: machine(inertia=0.0), lambda: machine(inertia=1e-15), ["inertia = 0"]),
    "inertia not a number": (
        lambda: machine(inertia=NAN),
        lambda: machine(inertia=1.0),
        ["inertia", "finite"],
    ),
    "gain infinite": (
        lambda: machine(torque_constant=INF),
        lambda: machine(torque_constant=-1.0),
        ["gain = inf"],
    ),
    "weight not a number": (
        lambda: machine(weight=NAN),
        lambda: machine(weight=-3.0),
        ["weight"],
    ),
    "limit below zero": (
        lambda: machine(input_limit=-1.0),
        lambda: machine(input_limit=INF),
        ["input_limit = -1"],
    ),
    "count below zero": (
        lambda: machine(count=-1e-3),
        lambda: machine(count=1e-3),
        ["count"],
    ),
    "gravity out of bounds": (
        lambda: machine(gravity_amplitude=1e13),
        lambda: machine(gravity_amplitude=-1e3),
        ["gravity_amplitude"],
    ),
    "gravity zero not a number": (
        lambda: machine(gravity_zero=NAN),
        lambda: machine(gravity_zero=1.0),
        ["gravity_zero"],
    ),
    "unknown integrator": (
        lambda: machine(integrator="euler"),
        lambda: machine(integrator="reference"),
        ["euler", "fast, reference"],
    ),
    "unknown effect": (
        lambda: machine(effects={"coging": {}}),
        lambda: machine(effects={"cogging": {}}),
        ["coging", "did you mean 'cogging'"],
    ),
    "unknown parameter of an effect": (
        lambda: machine(effects={"cogging": {"sin": 0.1}}),
        lambda: machine(effects={"cogging": {"sine": 0.1}}),
        ["sin", "sine"],
    ),
    "effect out of bounds": (
        lambda: machine(effects={"cogging": {"order": 0.0}}),
        lambda: machine(effects={"cogging": {"order": 1.0}}),
        ["order = 0"],
    ),
    "effect given a word": (
        lambda: machine(effects={"cogging": {"sine": "large"}}),
        lambda: machine(effects={"cogging": {"sine": 0}}),
        ["sine", "word"],
    ),
    "effect given no dict": (
        lambda: machine(effects={"torque_bias": 0.1}),
        lambda: machine(effects={"torque_bias": {"bias": 0.1}}),
        ["torque_bias", "dict"],
    ),
    "effect named by a number": (
        lambda: machine(effects={1: {}}),
        lambda: machine(effects={}),
        ["effect name 1"],
    ),
    "current not a number": (
        lambda: machine().step(NAN, DT),
        lambda: machine().step(0.1, DT),
        ["current = NaN"],
    ),
    "motor dt zero": (
        lambda: machine().step(0.1, 0.0),
        lambda: machine().step(0.1, 1e-9),
        ["dt = 0"],
    ),
    "motor load infinite": (
        lambda: machine().step(0.1, DT, load=INF),
        lambda: machine().step(0.1, DT, load=1.0),
        ["load = inf"],
    ),
    "batch of currents": (
        lambda: machine().simulate(np.zeros((2, 3)), DT),
        lambda: machine().simulate(np.zeros(3), DT),
        ["current has 2 dimensions"],
    ),
    "one current for an array": (
        lambda: machine().simulate(0.1, DT),
        lambda: machine().simulate([0.1], DT),
        ["current", "single number"],
    ),
    "no currents": (
        lambda: machine().simulate([], DT),
        lambda: machine().simulate([0.0], DT),
        ["current is empty"],
    ),
    "a gap in the currents": (
        lambda: machine().simulate([0.0, NAN], DT),
        lambda: machine().simulate([0.0, 0.0], DT),
        ["current[1] = NaN"],
    ),
    "one dt too few": (
        lambda: machine().simulate(np.zeros(3), [DT, DT]),
        lambda: machine().simulate(np.zeros(3), [DT, DT, DT]),
        ["dt has shape [2]"],
    ),
    "one dt negative": (
        lambda: machine().simulate(np.zeros(3), [DT, -DT, DT]),
        lambda: machine().simulate(np.zeros(3), [DT, 2 * DT, DT]),
        ["dt", "-0.001"],
    ),
    "one dt not a number": (
        lambda: machine().simulate(np.zeros(2), [DT, NAN]),
        lambda: machine().simulate(np.zeros(2), [DT, DT]),
        ["dt[1] = NaN"],
    ),
    "dt None": (
        lambda: machine().simulate(np.zeros(2), None),
        lambda: machine().simulate(np.zeros(2), DT),
        ["dt"],
    ),
    "motor load of another length": (
        lambda: machine().simulate(np.zeros(3), DT, load=np.zeros(4)),
        lambda: machine().simulate(np.zeros(3), DT, load=np.zeros(3)),
        ["load has shape [4]"],
    ),
    "unknown output": (
        lambda: machine().simulate(np.zeros(3), DT, outputs=["speed"]),
        lambda: machine().simulate(np.zeros(3), DT, outputs=["velocity"]),
        ["speed", "velocity"],
    ),
    "output asked for twice": (
        lambda: machine().simulate(np.zeros(3), DT, outputs=["velocity", "velocity"]),
        lambda: machine().simulate(np.zeros(3), DT, outputs=["velocity"]),
        ["velocity", "twice"],
    ),
    "outputs as one word": (
        lambda: machine().simulate(np.zeros(3), DT, outputs="velocity"),
        lambda: machine().simulate(np.zeros(3), DT, outputs=("velocity",)),
        ["velocity", "sequence"],
    ),
    "out of another length": (
        lambda: machine().simulate(np.zeros(3), DT, out={"velocity": np.zeros(2)}),
        lambda: machine().simulate(np.zeros(3), DT, out={"velocity": np.zeros(3)}),
        ["out['velocity']", "shape [2]"],
    ),
    "out of single precision": (
        lambda: machine().simulate(np.zeros(3), DT, out={"velocity": np.zeros(3, np.float32)}),
        lambda: machine().simulate(np.zeros(3), DT, out={"velocity": np.zeros(3, np.float64)}),
        ["out['velocity']", "float64"],
    ),
    "out with gaps between": (
        lambda: machine().simulate(np.zeros(3), DT, out={"velocity": np.zeros(6)[::2]}),
        lambda: machine().simulate(np.zeros(3), DT, out={"velocity": np.zeros(6)[:3]}),
        ["out['velocity']", "contiguous"],
    ),
    "out read-only": (
        lambda: machine().simulate(np.zeros(3), DT, out={"velocity": read_only(3)}),
        lambda: machine().simulate(read_only(3), DT, out={"velocity": np.zeros(3)}),
        ["out['velocity']", "read-only"],
    ),
    "out a list": (
        lambda: machine().simulate(np.zeros(3), DT, out={"velocity": [0.0] * 3}),
        lambda: machine().simulate(np.zeros(3), DT, out={}),
        ["out['velocity']", "array"],
    ),
    "one array for two outputs": (
        lambda: (lambda a: machine().simulate(np.zeros(3), DT, out={"velocity": a, "position": a}))(
            np.zeros(3)
        ),
        lambda: (
            lambda a, b: machine().simulate(np.zeros(3), DT, out={"velocity": a, "position": b})
        )(np.zeros(3), np.zeros(3)),
        ["out['position']", "twice"],
    ),
    "the input as out": (
        lambda: (lambda a: machine().simulate(a, DT, out={"position": a}))(np.zeros(3)),
        lambda: (lambda a: machine().simulate(a.copy(), DT, out={"position": a}))(np.zeros(3)),
        ["out['position']"],
    ),
    "out by an unknown name": (
        lambda: machine().simulate(np.zeros(3), DT, out={"speed": np.zeros(3)}),
        lambda: machine().simulate(np.zeros(3), DT, out={"measured": np.zeros(3)}),
        ["speed"],
    ),
    "reset to nowhere": (
        lambda: machine().reset(position=NAN),
        lambda: machine().reset(position=1e9),
        ["position = NaN"],
    ),
    "reset at infinite speed": (
        lambda: machine().reset(velocity=INF),
        lambda: machine().reset(velocity=-1.0),
        ["velocity = inf"],
    ),
    "motor state without a position": (
        with_state(machine, position=...),
        with_state(machine, position=3.0),
        ["position", "missing"],
    ),
    "motor state of another law": (
        lambda: setattr(machine(), "state", motor("coulomb").state),
        lambda: setattr(machine(), "state", motor("kept").state),
        ["state entry"],
    ),
    "motor at no speed": (
        with_state(machine, velocity=NAN),
        with_state(machine, velocity=0.5),
        ["velocity", "finite"],
    ),
    "sensitivity by an unknown parameter": (
        lambda: machine().sensitivity(np.zeros(3), DT, ["friction.break"]),
        lambda: machine().sensitivity(np.zeros(3), DT, ["friction.breakaway"]),
        ["friction.break", "friction.breakaway"],
    ),
    "sensitivity over no samples": (
        lambda: machine().sensitivity([], DT, ["friction.breakaway"]),
        lambda: machine().sensitivity([0.1], DT, ["friction.breakaway"]),
        ["empty"],
    ),
    "sensitivity with a bad dt": (
        lambda: machine().sensitivity([0.1], -DT, ["friction.breakaway"]),
        lambda: machine().sensitivity([0.1], DT, []),
        ["dt"],
    ),
    "follow from an unknown start": (
        lambda: machine().follow(st.Motion([0.0, 0.1], [0.1], DT), start={"forces": 0.1}),
        lambda: machine().follow(st.Motion([0.0, 0.1], [0.1], DT), start={"force": 0.1}),
        ["start of hsieh_pan", "did you mean 'force'", "hardening"],
    ),
    "follow from a start of coulomb": (
        lambda: motor("coulomb").follow(st.Motion([0.0, 0.1], [0.1], DT), start={"force": 0.1}),
        lambda: motor("coulomb").follow(st.Motion([0.0, 0.1], [0.1], DT), start={}),
        ["start of coulomb", "known: none"],
    ),
    "follow from negative hardening": (
        lambda: machine().follow(st.Motion([0.0, 0.1], [0.1], DT), start={"hardening": -1e-6}),
        lambda: machine().follow(st.Motion([0.0, 0.1], [0.1], DT), start={"hardening": 1e-6}),
        ["hardening", "out of bounds"],
    ),
    "follow from a start that is a number": (
        lambda: machine().follow(st.Motion([0.0, 0.1], [0.1], DT), start=0.1),
        lambda: machine().follow(st.Motion([0.0, 0.1], [0.1], DT), start=None),
        ["start", "dict"],
    ),
    "derivative by a start that is not given": (
        lambda: machine().follow_sensitivity(st.Motion([0.0, 0.1], [0.1], DT), ["start.force"]),
        lambda: machine().follow_sensitivity(
            st.Motion([0.0, 0.1], [0.1], DT), ["start.force"], start={}
        ),
        ["start.force", "give start"],
    ),
    "derivative by an unknown start": (
        lambda: machine().follow_sensitivity(
            st.Motion([0.0, 0.1], [0.1], DT), ["start.x"], start={}
        ),
        lambda: machine().follow_sensitivity(
            st.Motion([0.0, 0.1], [0.1], DT), ["start.hardening"], start={}
        ),
        ["start.x", "start.hardening"],
    ),
    "signature of an unknown effect": (
        lambda: machine().signatures(st.Motion([0.0, 0.1], [0.1], DT), [("coging", {})]),
        lambda: machine().signatures(st.Motion([0.0, 0.1], [0.1], DT), [("cogging", {})]),
        ["coging", "did you mean 'cogging'"],
    ),
    "signature at a gain": (
        lambda: machine().signatures(
            st.Motion([0.0, 0.1], [0.1], DT), [("cogging", {"sine": 0.1})]
        ),
        lambda: machine().signatures(
            st.Motion([0.0, 0.1], [0.1], DT), [("cogging", {"order": 3.0})]
        ),
        ["sine = 0.1", "gain", "order"],
    ),
    "signature of a name alone": (
        lambda: machine().signatures(st.Motion([0.0, 0.1], [0.1], DT), ["cogging"]),
        lambda: machine().signatures(st.Motion([0.0, 0.1], [0.1], DT), (("cogging", {}),)),
        ["candidates[0]", "cogging"],
    ),
    "signatures of nothing iterable": (
        lambda: machine().signatures(st.Motion([0.0, 0.1], [0.1], DT), 3),
        lambda: machine().signatures(st.Motion([0.0, 0.1], [0.1], DT), []),
        ["candidates is 3"],
    ),
    "signatures on no thread": (
        lambda: machine().signatures(st.Motion([0.0, 0.1], [0.1], DT), [], threads=0),
        lambda: machine().signatures(st.Motion([0.0, 0.1], [0.1], DT), [], threads=1),
        ["threads = 0"],
    ),
    "a kernel with an even number of weights": (
        lambda: st._native.RowKernel([0.5, 0.5], [1.0, -1.0, -1.0, 1.0], 1),
        lambda: st._native.RowKernel([1.0], [1.0, -2.0, 1.0], 1),
        ["odd number"],
    ),
    "a kernel every 0 samples": (
        lambda: st._native.RowKernel([1.0], [1.0, -2.0, 1.0], 0),
        lambda: st._native.RowKernel([1.0], [1.0, -2.0, 1.0], 3),
        ["spacing of 1 or more"],
    ),
}


@pytest.mark.parametrize(("bad", "good", "words"), REFUSED.values(), ids=REFUSED.keys())
def test_bad_input_is_refused_in_words_and_its_good_twin_taken(bad, good, words):
    good()
    with pytest.raises(st.InputError) as caught:
        bad()
    sentence = str(caught.value)
    for word in words:
        assert word in sentence
    # What was given, what is allowed or what to do: one sentence, no traceback, no Rust.
    assert "\n" not in sentence
    assert "Number(" not in sentence
    assert "Pairs(" not in sentence
    assert isinstance(caught.value, ValueError)


WRONG_TYPES = {
    "law not a word": lambda: st.FrictionModel(3),
    "no law": lambda: st.FrictionModel(),
    "velocity a word": lambda: model().step("fast", DT),
    "velocity an array": lambda: model().step(np.zeros(2), DT),
    "no dt": lambda: model().step(0.1),
    "dt a list": lambda: model().simulate([0.1], [DT]),
    "load by position": lambda: model().step(0.1, DT, 0.3),
    "unknown keyword": lambda: model().step(0.1, DT, torque=0.3),
    "state not a dict": lambda: setattr(model(), "state", [1.0]),
    "state deleted": lambda: delattr(model(), "state"),
    "friction not a model": lambda: st.Motor(inertia=1.0, friction="hsieh_pan"),
    "effects not a dict": lambda: machine(effects=["cogging"]),
    "outputs of numbers": lambda: machine().simulate([0.1], DT, outputs=[1]),
    "out not a dict": lambda: machine().simulate([0.1], DT, out=[np.zeros(1)]),
    "out keyed by numbers": lambda: machine().simulate([0.1], DT, out={1: np.zeros(1)}),
    "integrator a number": lambda: machine(integrator=1),
}


@pytest.mark.parametrize("call", WRONG_TYPES.values(), ids=WRONG_TYPES.keys())
def test_wrong_types_raise_ordinary_errors(call):
    with pytest.raises((TypeError, ValueError, AttributeError)):
        call()


def test_a_refused_step_changes_nothing():
    contact_, body = model(), machine()
    contact_.simulate(np.full(50, 0.01), DT)
    body.simulate(np.full(50, 0.4), DT)
    before, body_before = contact_.state, body.state
    for bad in ([0.01, NAN], [], [[[0.1]]]):
        with pytest.raises(st.InputError):
            contact_.simulate(bad, DT)
        with pytest.raises(st.InputError):
            body.simulate(bad, DT)
    with pytest.raises(st.InputError):
        body.simulate([0.1, 0.1], [DT, -DT])
    with pytest.raises(st.InputError):
        contact_.state = before | {"hardening": NAN}
    with pytest.raises(st.InputError):
        body.state = body_before | {"hardening": NAN, "position": 5.0}
    assert same_state(contact_.state, before)
    assert same_state(body.state, body_before)


def test_a_refused_step_leaves_the_trial_standing():
    tried, plain = model(), model()
    tried.trial(0.05, DT)
    with pytest.raises(st.InputError):
        tried.step(NAN, DT)
    tried.commit()
    plain.step(0.05, DT)
    assert tried == plain


HUGE = [1e30, 1e150, 1e300, 1.7e308, -1.7e308]


@pytest.mark.parametrize("kind", ["coulomb", "stribeck", "sticking", "hook", "spring damper"])
def test_a_huge_velocity_never_leaves_a_model_that_cannot_be_pickled(kind):
    for value in HUGE:
        for dt in (1e-9, 1.0, 1e30):
            target = contact(kind)
            for v in (value, -value, 0.0, 1.0, value):
                try:
                    target.step(v, dt)
                except st.InputError:
                    break
            assert isinstance(target.copy(), st.FrictionModel)
            assert pickle.loads(pickle.dumps(target)) == target


def test_a_sample_far_too_long_for_the_machine_is_refused():
    body = motor("elastic")
    for call in (
        lambda: body.simulate(np.full(5, 0.3), 1e4),
        lambda: body.step(0.3, 1e4),
        lambda: body.simulate(np.full(5, 0.3), np.array([1e-3, 1e-3, 1e4, 1e-3, 1e-3])),
    ):
        with pytest.raises(st.InputError, match="too long for this machine"):
            call()
    body.simulate(np.full(5, 0.3), 1e-3)


def test_a_motor_that_ran_away_says_so_and_can_still_be_copied_and_reset():
    body = motor("elastic")
    run = body.simulate(np.full(5, 1e308), 1e-3)
    assert not run.success
    assert "ran away" in run.message
    assert repr(body)
    assert isinstance(body.copy(), st.Motor)
    body.reset()
    assert body == motor("elastic")
