"""Long runs in chunks: the same bits, wherever they are cut and however often they are killed."""

from __future__ import annotations

import io
import os
import signal
import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stiction as st
from stiction.recording.expansion import VARIABLE

DT = 2e-4
# A generator of its own process, killed while it works.
WORKER = """
import sys
import numpy as np
from tests.core.test_streaming import DT, chunks, motor
import stiction as st

with open(sys.argv[2], "ab") as out:
    for part in st.stream(motor(), chunks(400), DT, every=7, checkpoint=sys.argv[1]):
        out.write(part.position.tobytes())
        out.flush()
        print(len(part.position), flush=True)
"""


def motor() -> st.Motor:
    friction = st.FrictionModel("hsieh_pan", breakaway=0.4, viscous=0.02)
    return st.Motor(0.0076, friction=friction, effects={"cogging": {"order": 7.0, "sine": 0.02}})


def chunks(number: int) -> Iterator[np.ndarray]:
    """Chunks of uneven lengths of one long input."""
    source = np.random.default_rng(3)
    done = 0
    for length in source.integers(50, 1500, number):
        time_s = (done + np.arange(length)) * DT
        yield 0.45 * np.sin(17.0 * time_s) * np.sin(0.9 * time_s)
        done += int(length)


def whole(number: int) -> st.Trajectory:
    return motor().simulate(np.concatenate(list(chunks(number))), DT)


@pytest.mark.parametrize("every", [1, 7, 5000])
def test_rows_do_not_depend_on_where_chunks_end(every: int) -> None:
    parts = list(st.stream(motor(), chunks(20), DT, every=every))
    run = whole(20)
    for name in ("position", "velocity"):
        rows = np.concatenate([part[name] for part in parts])
        assert np.array_equal(rows, run[name][every - 1 :: every])
    stamps = np.concatenate([part.time for part in parts])
    assert np.allclose(stamps, run.time[every - 1 :: every], rtol=1e-12)


def test_a_run_goes_on_from_its_checkpoint_to_the_bit(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    rows = []
    for stop in (3, 1, 8, None):
        going = st.stream(motor(), chunks(20), DT, every=7, checkpoint=path)
        for number, part in enumerate(going, 1):
            if stop is not None and number > stop:
                # Seen, not taken over: it comes again.
                going.close()
                break
            rows.append(part.position)
    assert np.array_equal(np.concatenate(rows), whole(20).position[6::7])


def test_a_killed_run_goes_on_to_the_bit(tmp_path: Path) -> None:
    path, out = tmp_path / "run.npz", tmp_path / "rows.bin"
    command = [sys.executable, "-c", WORKER, str(path), str(out)]
    repository = Path(__file__).parents[2]
    worker = subprocess.Popen(command, cwd=repository, stdout=subprocess.PIPE, text=True)
    assert worker.stdout is not None
    for _ in range(12):
        worker.stdout.readline()
    os.kill(worker.pid, signal.SIGKILL)
    worker.wait()
    worker.stdout.close()
    with np.load(path) as kept:
        done = int(kept["done"])
    assert 0 < done < sum(len(chunk) for chunk in chunks(400))
    # What was written after the checkpoint is written again.
    with out.open("r+b") as file:
        file.truncate(8 * (done // 7))
    subprocess.run(command, cwd=repository, check=True, stdout=subprocess.DEVNULL)
    rows = np.frombuffer(out.read_bytes())
    assert np.array_equal(rows, whole(400).position[6::7])


def test_a_checkpoint_of_another_run_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    list(st.stream(motor(), chunks(2), DT, checkpoint=path))
    with pytest.raises(st.InputError, match="another motor"):
        list(st.stream(motor(), chunks(2), 2 * DT, checkpoint=path))
    path.write_bytes(b"nothing of the kind")
    with pytest.raises(st.InputError, match="delete it"):
        list(st.stream(motor(), chunks(2), DT, checkpoint=path))


def changed(**entries: object) -> Callable[[dict[str, Any]], dict[str, Any]]:
    """Entries of a checkpoint as they are not; an Ellipsis takes one away."""
    new = {name.replace("__", "."): value for name, value in entries.items()}
    return lambda kept: {name: x for name, x in (kept | new).items() if x is not ...}


DAMAGES: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
    "done below 0": changed(done=-5),
    "done a fraction": changed(done=2.5),
    "done a row": changed(done=[1, 2]),
    "done a word": changed(done="many"),
    "done missing": changed(done=...),
    "start not a number": changed(start=np.nan),
    "start a word": changed(start="soon"),
    "identity missing": changed(identity=...),
    "identity numbers": changed(identity=np.zeros(3)),
    "position missing": changed(state__position=...),
    "position not a number": changed(state__position=np.inf),
    "position a word": changed(state__position="here"),
    "position in single precision": changed(state__position=np.float32(1.0)),
    "reverse points without rows": changed(state__reverse_points=np.zeros(3)),
    "a state too many": changed(state__colour=1.0),
}


@pytest.mark.parametrize("name", sorted(DAMAGES))
def test_a_damaged_checkpoint_is_refused_in_a_sentence(name: str, tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    list(st.stream(motor(), chunks(2), DT, checkpoint=path))
    with np.load(path) as file:
        kept = {key: file[key] for key in file.files}
    np.savez(path, **DAMAGES[name](kept))
    machine = motor()
    with pytest.raises(st.InputError, match=r"run\.npz: .*delete it") as told:
        list(st.stream(machine, chunks(4), DT, checkpoint=path))
    assert "\n" not in str(told.value)
    assert machine == motor()


def test_no_bytes_in_a_checkpoint_raise_anything_but_a_sentence(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    list(st.stream(motor(), chunks(2), DT, checkpoint=path))
    whole_file = path.read_bytes()
    source = np.random.default_rng(5)
    refused = 0
    for _ in range(150):
        damaged = bytearray(whole_file)
        for place in source.integers(0, len(damaged), source.integers(1, 4)):
            damaged[place] = source.integers(0, 256)
        if source.random() < 0.3:
            del damaged[source.integers(0, len(damaged)) :]
        path.write_bytes(damaged)
        machine = motor()
        try:
            next(st.stream(machine, chunks(4), DT, checkpoint=path))
        except st.InputError:
            refused += 1
            assert machine == motor()
    assert refused > 50, "hardly any damage was met"


def test_a_checkpoint_beyond_the_chunks_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    list(st.stream(motor(), chunks(3), DT, checkpoint=path))
    assert list(st.stream(motor(), chunks(3), DT, checkpoint=path)) == []
    with pytest.raises(st.InputError, match="the chunks end after"):
        list(st.stream(motor(), chunks(2), DT, checkpoint=path))


def test_memory_does_not_grow_with_the_run() -> None:
    resource = pytest.importorskip("resource")
    constant = np.full(200_000, 0.1)
    machine = motor()

    def run(number: int) -> int:
        for _ in st.stream(machine, (constant for _ in range(number)), DT, every=1000):
            pass
        return int(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)

    before = run(2)
    assert run(20) - before < 20_000, "KB"


@pytest.mark.parametrize("change", [{"every": 0}, {"every": True}, {"outputs": "position"}])
def test_what_cannot_be_streamed_is_refused_at_once(change: dict) -> None:
    with pytest.raises(st.InputError):
        st.stream(motor(), chunks(1), DT, **change)


def test_time_goes_on_where_the_motor_was() -> None:
    machine = motor()
    machine.simulate(np.zeros(100), DT)
    (part,) = st.stream(machine, [np.zeros(50)], DT, every=10)
    assert part.time[0] == pytest.approx(110 * DT)


def test_a_checkpoint_that_expands_beyond_the_ceiling_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "run.npz"
    list(st.stream(motor(), chunks(2), DT, checkpoint=path))
    with np.load(path) as file:
        kept = dict(file)
    np.savez_compressed(path, **kept, more=np.zeros(100_000))
    monkeypatch.setenv(VARIABLE, "100000")
    with pytest.raises(st.InputError, match=f"expands to .* {VARIABLE}"):
        list(st.stream(motor(), chunks(4), DT, checkpoint=path))


def test_a_checkpoint_whose_header_asks_for_more_than_is_there_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    list(st.stream(motor(), chunks(2), DT, checkpoint=path))
    array = io.BytesIO()
    header = {"descr": "<f8", "fortran_order": False, "shape": (10**14,)}
    np.lib.format.write_array_header_1_0(array, header)
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("more.npy", array.getvalue())
    with pytest.raises(st.InputError, match="array 'more' is longer than what is stored"):
        list(st.stream(motor(), chunks(4), DT, checkpoint=path))
