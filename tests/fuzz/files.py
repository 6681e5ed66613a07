"""Files of every format: good ones written here, and the damage that is done to them."""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from stiction.recording.formats import FORMATS

ROWS = 220
PLANT = """\
[motion]
kind = "rotary"
[drive]
input = "torque_nm"
gain = 1.0
[body]
inertia = { value = 0.01, min = 1e-4, max = 1.0 }
[friction]
law = "hsieh_pan"
breakaway = 0.2
viscous = 0.05
virgin_curve = "same"
[[effects]]
name = "cogging"
order = 7.0
sine = 0.01
[sensor]
counts_per_rev = 4096
[controller]
kind = "pid"
kp = 2.0
ki = 0.1
"""
SERVO = """\
[drive]
kind = "servo"
proportional = 3.0
supply_v = 12.0
resistance_ohm = 4.0
torque_constant = 0.8
current_limit_a = 2.0
[body]
inertia = 0.01
payload_kg = 0.5
payload_m = 0.1
[friction]
law = "coulomb"
coulomb = 0.1
"""
BAM = {
    "model": "m5",
    "actuator": "xl330",
    "kt": 0.36,
    "R": 2.8,
    "armature": 0.0018,
    "friction_base": 0.004,
    "friction_stribeck": 0.005,
    "load_friction_motor": 0.27,
    "load_friction_external": 0.01,
    "load_friction_motor_stribeck": 0.02,
    "load_friction_external_stribeck": 0.08,
    "dtheta_stribeck": 2.8,
    "alpha": 1.7,
    "friction_viscous": 0.005,
}
SESSION = """\
plant = "plant.toml"
[columns]
time = "t"
input = { name = "u", unit = "Nm", scale = 1.0, offset = 0.0 }
position = { name = "q", unit = "rad" }
[[recordings]]
file = "run.csv"
kind = "sine"
start_s = 0.0
[[recordings]]
file = "run.npz"
role = "test"
cold = true
replicate_of = "run.csv"
"""
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?(?![\w.])")
WORD = re.compile(r"[A-Za-z_]{1,20}")

Writer = Callable[[Path, int], None]
Damage = Sequence[Any]


def columns(seed: int) -> dict[str, np.ndarray]:
    """A shaft that swings; the seed says what is odd about the arrays."""
    rng = np.random.default_rng(seed)
    t = 1e-2 * np.arange(ROWS)
    q = 0.4 * np.sin(5.0 * t + seed) + 1e-5 * rng.standard_normal(ROWS)
    u = np.sign(np.cos(5.0 * t + seed)) * 0.2
    return {"t": t, "u": u, "q": q}


def odd(seed: int) -> dict[str, Any]:
    """Columns among which something is no plain vector."""
    plain: dict[str, Any] = dict(columns(seed))
    t = plain["t"]
    kinds: list[Any] = [
        t.astype(np.float32), (1000 * t).astype(np.int64), t > 1.0, t + 0j, t.reshape(-1, 1),
        t.reshape(2, -1), t[:5], np.array(3.0), np.array([]), t.astype(str), t.astype(np.float16),
        np.full(ROWS, np.nan), np.array(["a", "b"]), t.astype(">f8"), t.astype(np.uint8),
    ]  # fmt: skip
    name = ("t", "u", "q", "more")[seed % 4]
    plain[name] = kinds[(seed // 4) % len(kinds)]
    return plain


def write_delimited(path: Path, seed: int) -> None:
    table, sign = columns(seed), ",;\t"[seed % 3]
    names = list(table) if seed % 2 else ["time_s", "torque_nm", "position_rad"]
    rows = [sign.join(map(repr, map(float, row))) for row in zip(*table.values(), strict=True)]
    head = [sign.join(names)] + ([sign.join(("s", "Nm", "rad"))] if seed % 5 == 0 else [])
    path.write_text("\n".join([*head, *rows, ""]), encoding="utf-8")


def write_lvm(path: Path, seed: int) -> None:
    sign, times = "\t,"[seed % 2], seed % 3 > 0
    head = [["LabVIEW Measurement"], ["Writer_Version", "2"],
            ["Separator", ("Tab", "Comma")[seed % 2]], ["X_Columns", ("No", "One")[times]],
            ["***End_of_Header***"], [], ["Channels", "2"], ["Delta_X", "0.01"],
            ["***End_of_Header***"], ["X_Value", "u", "q", "Comment"]]  # fmt: skip
    rows = [
        [repr(float(t)) if times else "", repr(float(u)), repr(float(q))]
        for t, u, q in zip(*columns(seed).values(), strict=True)
    ]
    path.write_text("\r\n".join(map(sign.join, [*head, *rows, []])), encoding="utf-8")


def write_npz(path: Path, seed: int) -> None:
    (np.savez_compressed if seed % 2 else np.savez)(path, **(odd(seed) if seed % 3 else columns(0)))


def write_mat(path: Path, seed: int) -> None:
    table = odd(seed) if seed % 3 else columns(seed)
    if seed % 2:
        _write_hdf5(path, seed, table)
        return
    from scipy.io import savemat

    savemat(path, {"log": table} if seed % 5 == 0 else table, do_compression=seed % 4 == 0)
    content = path.read_bytes()
    # The header holds the time of day.
    path.write_bytes(b"MATLAB 5.0 MAT-file".ljust(116) + content[116:])


def _write_hdf5(path: Path, seed: int, table: dict[str, Any]) -> None:
    import h5py

    with h5py.File(path, "w", userblock_size=512, libver=("earliest", "latest")) as file:
        for name, values in table.items():
            array = np.asarray(values)
            if array.dtype.kind != "U":
                file[name] = array[np.newaxis] if array.ndim == 1 else array
        if seed % 7 == 1:
            file["link"] = h5py.ExternalLink("/etc/passwd", "/x")
        if seed % 7 == 3:
            file["soft"] = h5py.SoftLink("/nowhere")
        if seed % 7 == 5:
            file["again"] = file["/"]
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")


def write_json(path: Path, seed: int) -> None:
    table = {name: values.tolist() for name, values in columns(seed).items()}
    rows = [dict(zip(table, row, strict=True)) for row in zip(*table.values(), strict=True)]
    forms: list[Any] = [rows, table, {"data": rows}, {"meta": {"gain": 1}, **table}]
    if seed % 5 == 4:
        path.write_text("\n".join(map(json.dumps, rows)), encoding="utf-8")
        return
    path.write_text(json.dumps(forms[seed % 4]), encoding="utf-8")


def write_parquet(path: Path, seed: int) -> None:
    import pyarrow
    from pyarrow import parquet

    table = odd(seed) if seed % 3 else columns(seed)
    fit = {k: v for k, v in table.items() if np.shape(v) == (ROWS,) and v.dtype.kind != "c"}
    fit = {k: v.astype(v.dtype.newbyteorder("=")) for k, v in fit.items()}
    parquet.write_table(pyarrow.table(fit), path, compression=("snappy", "none", "zstd")[seed % 3])


def write_arrow(path: Path, seed: int) -> None:
    import pyarrow
    from pyarrow import feather

    table = columns(seed)
    lists = pyarrow.array(np.column_stack([table["q"], table["u"]]).tolist())
    stored = pyarrow.table({**table, "x": lists})
    feather.write_feather(stored, path, compression=("uncompressed", "lz4")[seed % 2])


def write_hdf5(path: Path, seed: int) -> None:
    import h5py

    with h5py.File(path, "w", libver=("earliest", "latest")) as file:
        for name, values in columns(seed).items():
            file[f"log/{name}"] = values
        file["log/x"] = np.column_stack(list(columns(seed).values()))


def write_mcap(path: Path, seed: int) -> None:
    from mcap.writer import Writer as Log

    with path.open("wb") as file:
        writer = Log(file, chunk_size=1000)
        writer.start()
        schema = writer.register_schema("Axis", "jsonschema", b"{}")
        channel = writer.register_channel("/axis", "json", schema)
        for k, row in enumerate(zip(*columns(seed).values(), strict=True)):
            data = json.dumps(dict(zip("tuq", map(float, row), strict=True))).encode()
            writer.add_message(channel, 10**7 * k, data, 10**7 * k)
        writer.finish()


def write_first_bag(path: Path, seed: int) -> None:
    """Of ROS 1: two topics of numbers."""
    from rosbags.rosbag1 import Writer as Bag
    from rosbags.typesys import Stores, get_typestore

    store, kind = get_typestore(Stores.ROS1_NOETIC), "std_msgs/msg/Float64"
    path.unlink(missing_ok=True)
    with Bag(path) as bag:
        topics = {name: bag.add_connection(f"/{name}", kind, typestore=store) for name in "uq"}
        for k in range(ROWS):
            for name, topic in topics.items():
                bag.write(topic, 10**7 * (k + 1), columns(seed)[name][k].tobytes())


def write_bag(path: Path, seed: int) -> None:
    """Of ROS 2, and of nothing but numbers: the tables of SQLite are what is damaged."""
    import sqlite3

    path.unlink(missing_ok=True)
    bag = sqlite3.connect(path)
    bag.execute("CREATE TABLE topics (id, name, type, serialization_format)")
    bag.execute("CREATE TABLE messages (topic_id, timestamp, data)")
    for topic, name in enumerate("uq"):
        kind = (topic, f"/{name}", "std_msgs/msg/Float64", "cdr")
        bag.execute("INSERT INTO topics VALUES (?, ?, ?, ?)", kind)
        for k, value in enumerate(columns(seed)[name]):
            data = b"\0\1\0\0" + np.float64(value).tobytes()
            bag.execute("INSERT INTO messages VALUES (?, ?, ?)", (topic, 10**7 * k, data))
    bag.commit()
    bag.close()


def write_ulog(path: Path, seed: int) -> None:
    def record(kind: bytes, content: bytes) -> bytes:
        return struct.pack("<Hc", len(content), kind) + content

    content = b"ULog\x01\x12\x35\x01" + bytes(8) + record(b"B", bytes(40))
    content += record(b"F", b"axis:uint64_t timestamp;double u;double q;")
    content += record(b"A", struct.pack("<BH", 0, 0) + b"axis")
    for t, u, q in zip(*columns(seed).values(), strict=True):
        content += record(b"D", struct.pack("<HQdd", 0, round(1e6 * float(t)), u, q))
    path.write_bytes(content)


def write_tdms(path: Path, seed: int) -> None:
    from nptdms import ChannelObject, TdmsWriter

    own = {"wf_increment": 0.01}
    with TdmsWriter(path) as writer:
        writer.write_segment([ChannelObject("bench", k, v, own) for k, v in columns(seed).items()])


def write_mdf(path: Path, seed: int) -> None:
    """No more than begins one: the library that writes it is not among those of the tests."""
    path.write_bytes(b"MDF     4.10    " + bytes(2000))


def write_checkpoint(path: Path, seed: int) -> None:
    import stiction as st

    motor = st.Motor(0.0076, friction=st.FrictionModel(("coulomb", "hsieh_pan")[seed % 2]))
    chunks = [np.full(5, 0.4), np.full(5, -0.3)]
    list(st.stream(motor, chunks, 1e-3, checkpoint=path))


def write_plant(path: Path, seed: int) -> None:
    path.write_text((PLANT, SERVO)[seed % 2], encoding="utf-8")


def write_session(path: Path, seed: int) -> None:
    write_plant(path.with_name("plant.toml"), 0)
    write_delimited(path.with_name("run.csv"), 1)
    write_npz(path.with_name("run.npz"), 6)
    path.write_text(SESSION, encoding="utf-8")


def write_parameters(path: Path, seed: int) -> None:
    models = ("m1", "m2", "m3", "m4", "m5", "m6")
    own = {"model": models[seed % 6], "actuator": ("xl330", "erob80_50", "mine")[seed % 3]}
    path.write_text(json.dumps({**BAM, **own}), encoding="utf-8")


def write_fit(path: Path, seed: int) -> None:
    """Numbers of a fit, its plant beside it."""
    write_plant(path.with_name("plant.toml"), 0)
    number = {"value": 0.2, "stderr": 0.01, "ci95": [0.18, 0.22], "unit": "N·m", "at_bound": ""}
    path.write_text(json.dumps({"parameters": {"friction.breakaway": number}}), encoding="utf-8")


URDF = """<robot name="one"><link name="a"/><link name="b"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="turn" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
</robot>"""


def write_urdf(path: Path, seed: int) -> None:
    path.write_text(URDF, encoding="utf-8")


def write_robot(path: Path, seed: int) -> None:
    """A robot of one joint, its URDF beside it."""
    write_urdf(path.with_name("one.urdf"), seed)
    path.write_text(
        '[robot]\nurdf = "one.urdf"\n[[robot.joints]]\nname = "turn"\n'
        'columns = { position = "q", input = "u" }\ndrive = { input = "torque_nm" }\n',
        encoding="utf-8",
    )


def write_robot_session(path: Path, seed: int) -> None:
    """A recording of that robot."""
    write_robot(path.with_name("robot.toml"), seed)
    write_npz(path.with_name("arm.npz"), seed)
    path.write_text(
        'plant = "robot.toml"\n[columns]\ntime = "t"\n[[recordings]]\nfile = "arm.npz"\n',
        encoding="utf-8",
    )


WRITERS: dict[str, Writer] = {
    ".csv": write_delimited,
    ".lvm": write_lvm,
    ".mat": write_mat,
    ".npz": write_npz,
    ".json": write_json,
    ".parquet": write_parquet,
    ".arrow": write_arrow,
    ".h5": write_hdf5,
    ".mcap": write_mcap,
    ".bag": write_first_bag,
    ".db3": write_bag,
    ".ulg": write_ulog,
    ".tdms": write_tdms,
    ".mf4": write_mdf,
    "checkpoint": write_checkpoint,
    "plant.toml": write_plant,
    "session.toml": write_session,
    "params.json": write_parameters,
    "fit.json": write_fit,
    "one.urdf": write_urdf,
    "robot.toml": write_robot,
    "robot-session.toml": write_robot_session,
}


NAMED = {
    ".lvm": ("X_Value", "u", "q"),
    ".h5": ("log.t", "log.u", "log.q"),
    ".mcap": ("axis.t", "axis.u", "axis.q"),
    ".bag": ("u.time", "u.data", "q.data"),
    ".db3": ("u.time", "u.data", "q.data"),
    ".ulg": ("axis.time", "axis.u", "axis.q"),
    ".tdms": ("time", "u", "q"),
}
"""What time, input and position are called where that is not t, u and q."""


def names_in(kind: str) -> tuple[str, str, str]:
    """What time, input and position are called in good files of a kind."""
    alike = next((known.suffixes for known in FORMATS if kind in known.suffixes), ())
    return next((NAMED[each] for each in alike if each in NAMED), ("t", "u", "q"))


def kinds() -> list[str]:
    """Every kind of file: endings of recordings, and the names of the others."""
    endings = [suffix for known in FORMATS for suffix in known.suffixes]
    return [*endings, *(kind for kind in WRITERS if kind not in endings)]


def writer(kind: str) -> Writer:
    """What writes good files of a kind; of an ending that nobody knows, text."""
    if kind in WRITERS:
        return WRITERS[kind]
    alike = next((known for known in FORMATS if kind in known.suffixes), None)
    endings = () if alike is None else alike.suffixes
    return next((WRITERS[each] for each in endings if each in WRITERS), write_delimited)


class Shelf:
    """A folder in which programs find the files that they name."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def file(self, kind: str, seed: int = 0, *damages: Damage) -> str:
        """A good file of a kind, then damaged; its path."""
        path = self._folder / (kind if "." in kind[1:] else f"{seed % 97}{kind}")
        writer(kind)(path, seed)
        content = path.read_bytes()
        for name, *how in damages:
            content = DAMAGES[name](content, *how)
        path.write_bytes(content)
        return str(path)


def at(content: bytes, share: float) -> int:
    return min(int(share * len(content)), len(content))


def cut(content: bytes, share: float) -> bytes:
    return content[: at(content, share)]


def flip(content: bytes, share: float, bits: int) -> bytes:
    k = at(content, share)
    return content[:k] + bytes(b ^ bits for b in content[k : k + 1]) + content[k + 1 :]


def fill(content: bytes, share: float, length: int, byte: int) -> bytes:
    k = at(content, share)
    return content[:k] + bytes([byte]) * len(content[k : k + length]) + content[k + length :]


def drop(content: bytes, share: float, length: int) -> bytes:
    k = at(content, share)
    return content[:k] + content[k + length :]


def twice(content: bytes, share: float, length: int) -> bytes:
    k = at(content, share)
    return content[: k + length] + content[k:]


def swap(content: bytes, one: float, other: float, length: int) -> bytes:
    """Splice a piece from elsewhere in."""
    k, j = at(content, one), at(content, other)
    return content[:k] + content[j : j + length] + content[k + length :]


def put(content: bytes, share: float, text: str) -> bytes:
    k = at(content, share)
    return content[:k] + _bytes(text) + content[k:]


def number(content: bytes, place: int, text: str) -> bytes:
    """Another text where a number stands."""
    return _instead(content, NUMBER, place, lambda old: text)


def word(content: bytes, place: int, text: str) -> bytes:
    """Another text where a word stands."""
    return _instead(content, WORD, place, lambda old: text)


def nest(content: bytes, place: int, depth: int, brackets: str) -> bytes:
    """A number within many brackets."""
    left, right = brackets.split("|")
    return _instead(content, NUMBER, place, lambda old: left * depth + old + right * depth)


def line(content: bytes, place: int, times: int) -> bytes:
    """A line that is left out, or there several times."""
    lines = content.split(b"\n")
    k = place % len(lines)
    return b"\n".join([*lines[:k], *[lines[k]] * times, *lines[k + 1 :]])


def _instead(
    content: bytes, pattern: re.Pattern[str], place: int, new: Callable[[str], str]
) -> bytes:
    text = content.decode("utf-8", "surrogateescape")
    found = list(pattern.finditer(text))
    if not found:
        return content
    hit = found[place % len(found)]
    return _bytes(text[: hit.start()] + new(hit[0]) + text[hit.end() :])


def _bytes(text: str) -> bytes:
    return text.encode("utf-8", "surrogatepass" if any("\ud800" <= c < "\udc80" for c in text)
                       else "surrogateescape")  # fmt: skip


DAMAGES: dict[str, Callable[..., bytes]] = {
    each.__name__: each
    for each in (cut, flip, fill, drop, twice, swap, put, number, word, nest, line)
}
