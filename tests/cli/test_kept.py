"""What somebody wrote is kept: no command replaces a plant or session file that was there."""

from __future__ import annotations

from pathlib import Path
from typing import NoReturn

import pytest
from tests.cli.desk import Desk

import stiction as st
from stiction.cli import run
from stiction.plan import plan


def never(*_: object, **__: object) -> NoReturn:
    raise AssertionError("works for nothing")


@pytest.mark.parametrize("name", ["session.toml", "plant.toml"])
def test_a_plan_leaves_what_was_filled_in(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    machine = tmp_path / "machine.toml"
    machine.write_text(
        '[drive]\ninput = "torque_nm"\n[body]\ninertia = 0.01\n'
        '[friction]\nlaw = "coulomb"\ncoulomb = 0.2\n',
        encoding="utf-8",
    )
    where = tmp_path / "out"
    arguments = ["plan", str(machine), "--only", "turns", "-o", str(where)]
    assert run(arguments) == 0
    capsys.readouterr()
    for other in {"session.toml", "plant.toml"} - {name}:
        (where / other).unlink()
    (where / name).write_text("# mine\n", encoding="utf-8")
    before = {file: file.stat().st_mtime_ns for file in where.rglob("*")}
    with monkeypatch.context() as patched:
        patched.setattr("stiction.plan.plan", never)
        assert run(arguments) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err == (
        f"stiction: {where / name}: is there already and is not overwritten; move it away, or give "
        "another folder with --out\n"
    )
    made = plan(st.Plant.load(machine), only=["turns"])
    with pytest.raises(st.InputError, match=f"{name}: is there already and is not overwritten"):
        made.save(where)
    assert (where / name).read_text(encoding="utf-8") == "# mine\n"
    assert {file: file.stat().st_mtime_ns for file in where.rglob("*")} == before


@pytest.mark.parametrize(
    ("verb", "work"), [("fit", "fitting.fit"), ("diagnose", "diagnosis.diagnose")]
)
def test_results_are_not_written_over_the_plant_that_was_read(
    verb: str,
    work: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    desk = Desk(tmp_path)
    before = desk.plant.read_text(encoding="utf-8")
    monkeypatch.setattr(f"stiction.{work}", never)
    monkeypatch.chdir(tmp_path)
    assert run([verb, "session.toml", "-o", "."]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err == (
        "stiction: plant.toml: is the plant file of this session and is not overwritten; give "
        "another folder with --out\n"
    )
    assert desk.plant.read_text(encoding="utf-8") == before


def test_a_fit_goes_beside_a_plant_file_of_another_name(tmp_path: Path) -> None:
    desk = Desk(tmp_path)
    desk.plant.rename(tmp_path / "machine.toml")
    desk.edit(desk.session, '"plant.toml"', '"machine.toml"')
    before = (tmp_path / "machine.toml").read_text(encoding="utf-8")
    assert run(["fit", str(desk.session), "-o", str(tmp_path)]) == 0
    assert (tmp_path / "machine.toml").read_text(encoding="utf-8") == before
    assert (tmp_path / "plant.toml").exists()
