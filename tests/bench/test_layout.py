"""A bench is laid out whole, the same of one seed, and tells nothing of its truth."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path

import pytest

import stiction as st
from stiction._support.atomic_files import new_folder
from stiction.bench import CASES, make
from stiction.bench import layout as layout_module
from stiction.bench.deal import deal
from stiction.bench.ordinary.hidden import HIDDEN

SMALL = {"seconds": (4.0, 6.0), "seed": 2}
EVERY = tuple(CASES)


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Eight sessions, two of every case; all formats are among those of this seed."""
    where = tmp_path_factory.mktemp("benches") / "bench"
    make(where, number=8, cases=EVERY, **SMALL)
    return where


def contents(folder: Path) -> dict[str, bytes]:
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def truth_of(bench: Path, k: int) -> dict:
    return json.loads((bench / "truth" / f"session_{k:04d}.json").read_text())


def test_one_seed_gives_the_same_bytes_and_another_one_others(bench: Path, tmp_path: Path) -> None:
    # A MAT file would hold the time of day, to a second.
    time.sleep(1.0)
    make(tmp_path / "again", number=8, cases=EVERY, **SMALL)
    assert contents(tmp_path / "again") == contents(bench)
    make(tmp_path / "other", number=1, cases=EVERY, **SMALL | {"seed": 99})
    assert contents(tmp_path / "other" / "session_0001") != contents(bench / "session_0001")


def test_every_session_reads_and_every_case_is_there(bench: Path) -> None:
    manifest = json.loads((bench / "bench.json").read_text())
    assert manifest["number"] == len(manifest["sessions_sha256"]) == 8
    assert manifest["licence"] == "CC0-1.0"
    assert manifest["version"] == st.__version__
    cases = [truth_of(bench, k)["case"] for k in range(1, 9)]
    assert sorted(cases) == sorted(2 * EVERY)
    suffixes = set()
    for name in manifest["sessions_sha256"]:
        session = st.load(bench / name / "session.toml", keep_faulty=True)
        suffixes |= {Path(str(recording.path)).suffix for recording in session}
        assert min(len(recording.time) for recording in session) >= 200
    assert suffixes == {".npz", ".csv", ".mat", ".json"}


def test_nothing_but_the_truth_tells_the_truth(bench: Path) -> None:
    recipe = json.loads((bench / "truth" / "recipe.json").read_text())
    make(other := bench.parent / "sealed", number=2, **SMALL | {"seed": 918273645546372819})
    assert recipe["seed"] == 2
    words = re.compile(
        "|".join((*HIDDEN, "hidden", "untestable", "918273645546372819", r"\bseed\b"))
    )
    for name, content in contents(other).items():
        if name.startswith("truth/") or name in ("bench.json", "README.txt", "answer.schema.json"):
            continue
        assert not words.search(content.decode("latin-1")), name
    manifest = json.loads((other / "bench.json").read_text())
    assert "918273645546372819" not in json.dumps(manifest)
    assert "seed" not in manifest
    # Nor do seeds of sessions, names of files or their order.
    seeds = {str(truth_of(other, k)["spec"]["seed"]) for k in (1, 2)}
    public = "".join(v.decode("latin-1") for k, v in contents(other).items() if "truth" not in k)
    assert not [seed for seed in seeds if seed in public]


def test_names_in_the_truth_are_those_of_the_catalogue(bench: Path) -> None:
    families = {record.name: record.family for record in st.effects()}
    assert set(HIDDEN) <= families.keys()
    for k in range(1, 9):
        truth = truth_of(bench, k)
        assert (truth["hidden"] is not None) == (truth["case"] == "hidden")
        own = truth["spec"]["law"] == truth["own_law"]
        assert own == (truth["case"] != "law")
        if truth["hidden"]:
            assert truth["hidden"]["class"] == families[truth["hidden"]["name"]]
            # A lag that meets steps is wrong by their whole height for as long as it lasts.
            assert 0.0 < truth["hidden"]["size"] < 20.0


def test_cases_are_as_frequent_and_their_order_tells_nothing() -> None:
    laws = [law.name for law in st.laws()]
    dealt = deal(400, 5, ("null", "hidden"), (20.0, 40.0), laws)
    assert {each.spec.hidden for each in dealt} == {"", *HIDDEN}
    assert [each.case for each in dealt].count("null") == 200
    pairs = [(a.case, b.case) for a, b in pairwise(dealt)]
    # Half of the neighbours are alike, give or take three standard deviations.
    assert 170 < sum(a == b for a, b in pairs) < 230
    assert len({each.spec.seed for each in dealt}) == 400


def test_an_interrupted_layout_goes_on_to_the_same_files(
    bench: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, calls = layout_module.write, []

    def stops(made, folder):
        calls.append(folder)
        if len(calls) == 4:
            (folder / "session.toml").write_text("half of it")
            raise KeyboardInterrupt
        return real(made, folder)

    where = tmp_path / "bench"
    monkeypatch.setattr(layout_module, "write", stops)
    with pytest.raises(KeyboardInterrupt):
        make(where, number=8, cases=EVERY, **SMALL)
    assert sorted(p.name for p in where.iterdir()) == [
        "session_0001", "session_0002", "session_0003", "truth"
    ]  # fmt: skip
    make(where, number=8, cases=EVERY, **SMALL)
    assert len(calls) == 9
    assert contents(where) == contents(bench)
    # All of it is there: nothing is drawn again.
    make(where, number=8, cases=EVERY, **SMALL)
    assert len(calls) == 9


@pytest.mark.skipif(os.name != "posix", reason="kills as POSIX does")
def test_what_a_kill_leaves_of_a_folder_is_cleared_away(tmp_path: Path) -> None:
    code = (
        "import sys, time; from pathlib import Path\n"
        "from stiction._support.atomic_files import new_folder\n"
        "with new_folder(Path(sys.argv[1]) / 'one') as draft:\n"
        "    (draft / 'part').write_text('half'); print('at work', flush=True); time.sleep(60)"
    )
    started = subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path)], stdout=subprocess.PIPE, text=True
    )
    assert started.stdout is not None
    assert started.stdout.readline() == "at work\n"
    (left,) = tmp_path.iterdir()
    # What is still written by somebody stays.
    with new_folder(tmp_path / "two"):
        assert left.is_dir()
    started.send_signal(signal.SIGKILL)
    started.wait()
    started.stdout.close()
    with new_folder(tmp_path / "three") as draft:
        (draft / "whole").write_text("all of it")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["three", "two"]


def test_a_folder_that_is_there_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "one").mkdir()
    with pytest.raises(FileExistsError), new_folder(tmp_path / "one"):
        pass
    with pytest.raises(OSError, match="nowhere"), new_folder(tmp_path / "nowhere" / "one"):
        pass


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"number": 0}, "number = 0 is out of bounds"),
        ({"number": 10000}, "from 1 to 9999"),
        ({"number": 1.5}, "number = 1.5 is out of bounds"),
        ({"seed": -1}, "seed = -1 is out of bounds"),
        ({"seconds": (1.0, 5.0)}, "from 4 to 3600 s"),
        ({"seconds": (9.0, 8.0)}, "is out of bounds"),
        ({"seconds": 9.0}, "seconds = 9.0 is out of bounds"),
        ({"seconds": (float("nan"), 9.0)}, "is out of bounds"),
        ({"cases": ("nul",)}, "there is no case 'nul'; there are null, hidden"),
        ({"cases": ()}, "give each case once"),
        ({"cases": ("null", "null")}, "give each case once"),
        ({"cases": "null"}, "is a word; give a sequence"),
    ],
)
def test_what_cannot_be_laid_out_is_refused(given: dict, sentence: str, tmp_path: Path) -> None:
    with pytest.raises(st.InputError, match=re.escape(sentence)):
        make(tmp_path / "bench", **{"number": 1, **SMALL, **given})
    assert not (tmp_path / "bench").exists()


def test_a_folder_of_something_else_is_left_alone(bench: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(st.InputError, match=r"mine\.txt is there and no bench"):
        make(tmp_path, number=1, **SMALL)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
    with pytest.raises(st.InputError, match="another bench is there"):
        make(bench, number=9, cases=EVERY, **SMALL)
