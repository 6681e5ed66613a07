"""One recording in every format, by the format's own writer: the same as the CSV, and damaged."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from stiction.cli import run
from stiction.errors import InputError
from stiction.recording import Recording, read_table
from stiction.recording.expansion import VARIABLE
from stiction.recording.joints import joints_of

# Of a file that cannot be opened asammdf leaves an object that cannot be taken down.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")

ROWS = 400
START = 1_700_000_000
TIME = 0.01 * np.arange(ROWS)
Q = 0.5 * np.sin(3.0 * TIME)
U = np.sign(np.cos(3.0 * TIME)) + 0.1 * np.sin(11.0 * TIME)
OTHER = np.cos(TIME)
PLAIN = {
    "time": "t",
    "position": {"name": "q", "unit": "rad"},
    "input": {"name": "u", "unit": "Nm"},
}
JOINT = {
    "time": "joint_states.time",
    "position": {"name": "joint_states.elbow.position", "unit": "rad"},
    "input": {"name": "joint_states.elbow.effort", "unit": "Nm"},
}
Made = tuple[Path, dict[str, Any]]


def csv(folder: Path) -> Made:
    path = folder / "run.csv"
    rows = [f"{t!r},{q!r},{u!r}" for t, q, u in np.column_stack([TIME, Q, U]).tolist()]
    path.write_text("\n".join(["t,q,u", *rows]))
    return path, PLAIN


def hdf5(folder: Path) -> Made:
    h5py = pytest.importorskip("h5py")
    path = folder / "run.h5"
    with h5py.File(path, "w") as file:
        file["log/t"] = TIME
        file.create_dataset("log/x", data=np.column_stack([Q, OTHER]), compression="gzip")
        file["log/u"] = U[:, np.newaxis]
    return path, _called(t="log.t", q="log.x[0]", u="log.u")


def _called(**names: str) -> dict[str, Any]:
    return {
        "time": names["t"],
        "position": {"name": names["q"], "unit": "rad"},
        "input": {"name": names["u"], "unit": "Nm"},
    }


def arrow(folder: Path) -> Made:
    pyarrow = pytest.importorskip("pyarrow")
    feather = pytest.importorskip("pyarrow.feather")
    path = folder / "run.feather"
    lists = pyarrow.array(np.column_stack([OTHER, Q]).tolist())
    feather.write_feather(pyarrow.table({"t": TIME, "x": lists, "u": U}), path)
    return path, _called(t="t", q="x[1]", u="u")


def parquet_lists(folder: Path) -> Made:
    """As LeRobot writes an episode."""
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    path = folder / "episode_000000.parquet"
    state, action = (
        pyarrow.FixedSizeListArray.from_arrays(pyarrow.array(np.column_stack(each).ravel()), 2)
        for each in ([OTHER, Q], [OTHER, U])
    )
    table = {"observation.state": state, "action": action, "timestamp": TIME,
             "frame_index": np.arange(ROWS)}  # fmt: skip
    parquet.write_table(pyarrow.table(table), path)
    return path, _called(t="timestamp", q="observation.state[1]", u="action[1]")


def stamps_in_parquet(folder: Path) -> Made:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    path = folder / "run.parquet"
    stamps = (START * 10**9 + 10**7 * np.arange(ROWS)).astype("datetime64[ns]")
    parquet.write_table(pyarrow.table({"t": stamps, "q": Q, "u": U}), path)
    return path, PLAIN


def tdms(folder: Path) -> Made:
    nptdms = pytest.importorskip("nptdms")
    path = folder / "run.tdms"
    own = {"wf_increment": 0.01, "wf_start_offset": 0.0}
    with nptdms.TdmsWriter(path) as writer:
        writer.write_segment([
            nptdms.ChannelObject("bench", "q", Q, {**own, "unit_string": "rad"}),
            nptdms.ChannelObject("bench", "u", U, own),
        ])  # fmt: skip
    return path, _called(t="time", q="q", u="u")


def mdf(folder: Path) -> Made:
    asammdf = pytest.importorskip("asammdf")
    path = folder / "run.mf4"
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(Q, TIME, name="q", unit="rad"),
                     asammdf.Signal(U, TIME, name="u", unit="Nm")])  # fmt: skip
        file.save(path, overwrite=True)
    return path, _called(t="time", q="q", u="u")


def ulog(folder: Path) -> Made:
    """As PX4's logger writes it, byte by byte: `pyulog` writes what it has read alone."""
    pytest.importorskip("pyulog")
    import struct

    def record(kind: bytes, content: bytes) -> bytes:
        return struct.pack("<Hc", len(content), kind) + content

    path = folder / "run.ulg"
    content = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)
    content += record(b"B", bytes(40))
    content += record(b"F", b"axis:uint64_t timestamp;double q;double u;")
    content += record(b"A", struct.pack("<BH", 0, 0) + b"axis")
    for k in range(ROWS):
        content += record(b"D", struct.pack("<HQdd", 0, 10_000 * k, Q[k], U[k]))
    path.write_bytes(content)
    return path, _called(t="axis.time", q="axis.q", u="axis.u")


def _states(store: Any, k: int, *, first: bool) -> Any:
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"](sec=START + k // 100, nanosec=10**7 * (k % 100))
    header = types["std_msgs/msg/Header"](**({"seq": k} if first else {}), stamp=stamp, frame_id="")
    return types["sensor_msgs/msg/JointState"](
        header=header,
        name=["hand", "elbow"],
        position=np.array([OTHER[k], Q[k]]),
        velocity=np.array([]),
        effort=np.array([0.5 * OTHER[k], U[k]]),
    )


def bag_of_ros_1(folder: Path) -> Made:
    rosbags = pytest.importorskip("rosbags.rosbag1")
    types = pytest.importorskip("rosbags.typesys")
    store = types.get_typestore(types.Stores.ROS1_NOETIC)
    path = folder / "run.bag"
    with rosbags.Writer(path) as writer:
        kind = "sensor_msgs/msg/JointState"
        topic = writer.add_connection("/joint_states", kind, typestore=store)
        for k in range(ROWS):
            data = store.serialize_ros1(_states(store, k, first=True), kind)
            writer.write(topic, START * 10**9 + 10**7 * k, data)
    return path, JOINT


def _bag_of_ros_2(folder: Path, plugin: str) -> Path:
    rosbags = pytest.importorskip("rosbags.rosbag2")
    types = pytest.importorskip("rosbags.typesys")
    store = types.get_typestore(types.Stores.ROS2_HUMBLE)
    kind, bag = "sensor_msgs/msg/JointState", folder / "bag"
    with rosbags.Writer(bag, version=9, storage_plugin=rosbags.StoragePlugin[plugin]) as writer:
        topic = writer.add_connection("/joint_states", kind, typestore=store)
        image = writer.add_connection("/camera", "sensor_msgs/msg/Image", typestore=store)
        for k in range(ROWS):
            at = START * 10**9 + 10**7 * k
            writer.write(image, at, b"\0\1\0\0" + bytes(100))
            data = store.serialize_cdr(_states(store, k, first=False), kind)
            writer.write(topic, at, data)
    return next(file for file in bag.iterdir() if file.suffix in (".db3", ".mcap"))


def bag_of_ros_2(folder: Path) -> Made:
    return _bag_of_ros_2(folder, "SQLITE3"), JOINT


def mcap_of_ros_2(folder: Path) -> Made:
    pytest.importorskip("mcap_ros2")
    return _bag_of_ros_2(folder, "MCAP"), JOINT


def mcap_of_json(folder: Path) -> Made:
    """As Foxglove's tools write it, in chunks that are packed."""
    pytest.importorskip("mcap_ros2")
    writers = pytest.importorskip("mcap.writer")
    path = folder / "json.mcap"
    with path.open("wb") as file:
        writer = writers.Writer(file, chunk_size=2000)
        writer.start()
        schema = writer.register_schema("Axis", "jsonschema", b'{"type": "object"}')
        channel = writer.register_channel("/axis", "json", schema)
        for k in range(ROWS):
            data = json.dumps({"q": Q[k], "u": U[k], "note": "x"}).encode()
            at = START * 10**9 + 10**7 * k
            writer.add_message(channel, at, data, at)
        writer.finish()
    return path, _called(t="axis.time", q="axis.q", u="axis.u")


MAKERS: list[Callable[[Path], Made]] = [
    hdf5, arrow, parquet_lists, stamps_in_parquet, tdms, mdf, ulog, bag_of_ros_1, bag_of_ros_2,
    mcap_of_ros_2, mcap_of_json,
]  # fmt: skip


@pytest.mark.parametrize("make", MAKERS)
def test_one_recording_is_the_same_in_every_format(
    tmp_path: Path, make: Callable[[Path], Made]
) -> None:
    wanted = Recording.load(*csv(tmp_path))
    path, columns = make(tmp_path)
    found = Recording.load(path, columns)
    np.testing.assert_array_equal(found.position, wanted.position)
    np.testing.assert_array_equal(found.input, wanted.input)
    np.testing.assert_allclose(found.time, wanted.time, atol=2e-7)


@pytest.mark.parametrize("make", MAKERS)
def test_a_file_cut_short_or_full_of_noise_is_a_table_or_a_sentence(
    tmp_path: Path, make: Callable[[Path], Made]
) -> None:
    path, _ = make(tmp_path)
    content = path.read_bytes()
    rng = np.random.default_rng(0)
    cuts = [content[: int(share * len(content))] for share in (0.001, 0.3, 0.7, 0.999)]
    noisy = []
    for _k in range(6):
        spoiled = bytearray(content)
        for place in rng.integers(0, len(content), 20):
            spoiled[place] ^= int(rng.integers(1, 256))
        noisy.append(bytes(spoiled))
    refused = 0
    for each in (*cuts, *noisy, content[:64] + rng.bytes(2000)):
        path.write_bytes(each)
        sentence = refusal(path)
        refused += bool(sentence)
        assert not sentence or sentence.startswith(f"{path}: ")
        assert "\n" not in sentence
    assert refused


def refusal(path: Path) -> str:
    """Why a file is refused, "" where it is read."""
    try:
        read_table(path)
    except InputError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("make", MAKERS)
def test_what_would_take_too_much_room_is_refused(
    tmp_path: Path, make: Callable[[Path], Made], monkeypatch: pytest.MonkeyPatch
) -> None:
    path, _ = make(tmp_path)
    monkeypatch.setenv(VARIABLE, "4000")
    with pytest.raises(InputError, match=r"GiB are allowed|cannot be read"):
        read_table(path)


LIBRARIES = {
    "run.h5": (b"\x89HDF\r\n\x1a\n", "h5py", "mat73"),
    "run.arrow": (b"ARROW1", "pyarrow", "parquet"),
    "run.mcap": (b"\x89MCAP0\r\n", "mcap.reader", "mcap"),
    "run.bag": (b"#ROSBAG V2.0\n", "rosbags.typesys", "ros"),
    "run.db3": (b"SQLite format 3\0", "rosbags.typesys", "ros"),
    "run.ulg": (b"ULog\x01\x12\x35", "pyulog", "ulog"),
    "run.tdms": (b"TDSm", "nptdms", "tdms"),
    "run.mf4": (b"MDF     ", "asammdf", "mdf"),
}


@pytest.mark.parametrize("name", LIBRARIES)
def test_without_its_library_the_extra_is_named(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys

    start, library, extra = LIBRARIES[name]
    path = tmp_path / name
    path.write_bytes(start + bytes(50))
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(InputError, match=rf"pip install 'stiction\[{extra}\]'"):
        read_table(path)
    path.write_bytes(b"t,q\n0,1\n")
    with pytest.raises(InputError, match=r"this is not an? "):
        read_table(path)


@pytest.mark.parametrize("make", [bag_of_ros_1, bag_of_ros_2, mcap_of_ros_2])
def test_init_drafts_a_joint_of_a_bag(
    tmp_path: Path, make: Callable[[Path], Made], capsys: pytest.CaptureFixture[str]
) -> None:
    path, _ = make(tmp_path)
    table = read_table(path)
    found = joints_of([table])
    assert found is not None
    assert found.labels == ("hand", "elbow")
    if make is not bag_of_ros_1:
        assert "holds sensor_msgs/msg/Image" in table.unusable["/camera"]
    assert table.begins["joint_states.time"] == pytest.approx(START)
    out = tmp_path / "out"
    assert run(["init", str(path), "--joint", "elbow", "-o", str(out), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert {one["role"]: one["column"] for one in answer["columns"] if one["role"]} == {
        "time": "joint_states.time",
        "position": "joint_states.elbow.position",
        "input": "joint_states.elbow.effort",
    }
    assert answer["to_do"] == []
