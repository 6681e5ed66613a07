"""What a motor refuses: definitions, samples, what goes along a measured motion."""

import numpy as np

import stiction as st
from stiction import _native

from .refused_by_contacts import DT, INF, NAN, machine, model, read_only, with_state
from .rigs import INERTIA, motor

ROWS = _native.RowKernel([0.25, 0.5, 0.25], [0.25, 0.0, -0.5, 0.0, 0.25], 2)

# (what is wrong, its good twin, words that the sentence must hold)
MOTORS = {
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
    "signature of rows that do not rise": (
        lambda: machine().signature_columns(
            st.Motion(np.zeros(60), np.zeros(59), DT), [("cogging", {})], ROWS, kept=[3, 2]
        ),
        lambda: machine().signature_columns(
            st.Motion(np.zeros(60), np.zeros(59), DT), [("cogging", {})], ROWS, kept=[2, 3]
        ),
        ["kept", "rise", "from 0 to below"],
    ),
    "signatures on no thread": (
        lambda: machine().signatures(st.Motion([0.0, 0.1], [0.1], DT), [], threads=0),
        lambda: machine().signatures(st.Motion([0.0, 0.1], [0.1], DT), [], threads=1),
        ["threads = 0"],
    ),
    "a kernel with an even number of weights": (
        lambda: _native.RowKernel([0.5, 0.5], [1.0, -1.0, -1.0, 1.0], 1),
        lambda: _native.RowKernel([1.0], [1.0, -2.0, 1.0], 1),
        ["odd number"],
    ),
    "a kernel every 0 samples": (
        lambda: _native.RowKernel([1.0], [1.0, -2.0, 1.0], 0),
        lambda: _native.RowKernel([1.0], [1.0, -2.0, 1.0], 3),
        ["spacing of 1 or more"],
    ),
}
