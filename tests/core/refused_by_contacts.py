"""What a contact refuses: laws, steps, arrays, states."""

import math

import numpy as np

import stiction as st

from .rigs import contact, motor

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
CONTACTS = {
    # Construction.
    "unknown law": (law("hseih_pan"), law("hsieh_pan"), ["hseih_pan", "did you mean 'hsieh_pan'"]),
    "truth for a number": (
        law("coulomb", coulomb=True),
        law("coulomb", coulomb=1.0),
        ["coulomb of coulomb is a bool", "allowed is a number"],
    ),
    "a number of three hundred digits": (
        law("coulomb", coulomb=-1e300),
        law("coulomb", coulomb=1e3),
        ["coulomb = -1e300 is out of bounds"],
    ),
    "masked samples": (
        lambda: model().simulate(np.ma.array([0.1, 0.2], mask=[0, 1]), DT),
        lambda: model().simulate(np.ma.array([0.1, 0.2], mask=[0, 0]), DT),
        ["velocity is masked in places", "leave them out"],
    ),
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
        lambda: model().simulate([1, 2.0], DT),
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
}
