"""How sure recordings are that causes help, and what one more of them says."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction.cli import run
from stiction.diagnosis.findings.bets import Bet, Bets

DT = 2e-3
PLANT = """\
[drive]
input = "torque_nm"
[friction]
law = "coulomb"
[sensor]
counts_per_rev = 65536
"""


def bets(*payoffs: float) -> Bets:
    """Recordings with these payoffs."""
    # (1 - b²)/(1 + b²) = payoff.
    return Bets(tuple(Bet(f"{k}", 1.0, np.sqrt((1 - p) / (1 + p))) for k, p in enumerate(payoffs)))


def test_a_payoff_goes_from_minus_one_to_one() -> None:
    assert Bet("a", 2.0, 0.0).payoff == 1.0
    assert Bet("a", 0.0, 2.0).payoff == -1.0
    assert Bet("a", 2.0, 2.0).payoff == 0.0
    assert Bet("a", 0.0, 0.0).payoff == 0.0
    assert Bet("a", 2.0, 1.0).gain == pytest.approx(0.75)
    assert Bet("a", 0.0, 1.0).gain is None


@pytest.mark.parametrize("number", [1, 2, 7, 10])
def test_recordings_that_win_all_are_worth_what_the_integral_says(number: int) -> None:
    # ∫(1 + λ)ⁿ dλ from 0 to 1.
    exact = (2.0 ** (number + 1) - 1.0) / (number + 1)
    assert bets(*[1.0] * number).value == pytest.approx(exact, rel=1e-3)


def test_order_does_not_matter_and_a_loss_costs() -> None:
    assert bets(0.9, -0.5, 0.8).value == pytest.approx(bets(-0.5, 0.8, 0.9).value)
    assert bets(0.9, 0.8, -0.5).value < bets(0.9, 0.8).value
    assert bets().value == 1.0


def test_by_chance_it_reaches_a_hundred_less_often_than_it_says() -> None:
    source = np.random.default_rng(4)
    reached = 0
    for _ in range(2000):
        payoffs = source.uniform(-1.0, 1.0, 30)
        grown = np.cumsum(np.log1p(0.5 * payoffs))
        assert np.isfinite(grown).all()
        # However often one looks: after each recording.
        reached += any(bets(*payoffs[: k + 1]).value >= 10.0 for k in range(0, 30, 3))
    assert reached / 2000 <= 0.1


def test_how_many_more_it_takes_is_what_it_takes() -> None:
    found = bets(0.9, 0.7)
    assert found.more is not None
    mean = 0.8
    assert bets(0.9, 0.7, *[mean] * found.more).value >= 100.0
    assert bets(0.9, 0.7, *[mean] * (found.more - 1)).value < 100.0
    assert bets(0.5, -0.6).more is None
    assert "would not tell" in bets(0.5, -0.6).words


def recorded(file: Path, seed: int, *, bias: float = 0.1, coulomb: float = 0.3) -> None:
    """Pushed by a few sines, read by an encoder of 65 536 counts."""
    source = np.random.default_rng(seed)
    time = DT * np.arange(3000)
    effort = sum(
        source.uniform(0.2, 0.5) * np.sin(source.uniform(2.0, 12.0) * time + source.uniform(0, 6))
        for _ in range(4)
    )
    friction = st.FrictionModel("coulomb", coulomb=coulomb, viscous=0.02)
    motor = st.Motor(0.01, friction=friction, effects={"torque_bias": {"bias": bias}})
    position = motor.simulate(effort, DT, outputs=["position"]).position
    count = 2.0 * np.pi / 65536
    before = np.concatenate([[0.0], position[:-1]])
    np.savez(file, time_s=time, torque_nm=effort, position_rad=np.round(before / count) * count)


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a session, its diagnosis in out, and recordings that are not in it."""
    folder = tmp_path_factory.mktemp("added")
    (folder / "plant.toml").write_text(PLANT, encoding="utf-8")
    entries = "".join(f'[[recordings]]\nfile = "r{k}.npz"\n' for k in range(6))
    text = 'plant = "plant.toml"\n[columns]\ntime = "time_s"\ninput = "torque_nm"\n'
    text += f'position = "position_rad"\n{entries}'
    (folder / "session.toml").write_text(text, encoding="utf-8")
    for k in range(8):
        recorded(folder / f"r{k}.npz", k)
    recorded(folder / "none.npz", 8, bias=0.0)
    recorded(folder / "stiff.npz", 9, coulomb=0.6)
    assert run(["diagnose", str(folder / "session.toml"), "-o", str(folder / "out")]) == 0
    return folder


def test_one_more_recording_is_told_and_kept(
    diagnosed: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = diagnosed / "out" / "findings.json"
    first = json.loads(file.read_text(encoding="utf-8"))
    assert [cause["name"] for cause in first["effects"]] == ["torque_bias"]
    tested = [each["recording"] for each in first["evidence"]["recordings"]]
    assert tested == ["r2.npz", "r5.npz"]
    words = ["diagnose", str(diagnosed / "session.toml"), "-o", str(diagnosed / "out")]
    capsys.readouterr()
    assert run([*words, "--add", str(diagnosed / "r6.npz")]) == 0
    told = capsys.readouterr().out
    assert told.startswith("r6.npz: adding torque_bias removes 9")
    assert "it helps in 3 of 3 recordings held out" in told
    second = json.loads(file.read_text(encoding="utf-8"))
    assert second["evidence"]["e_value"] > first["evidence"]["e_value"]
    assert [each["added"] for each in second["evidence"]["recordings"]] == [False, False, True]
    changed = {key for key in second if key not in first or second[key] != first[key]}
    assert changed == {"evidence", "added"}
    # What a recording is worth does not hang on when it was seen: it was held out either way.
    assert run([*words, "--add", str(diagnosed / "r7.npz"), "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["added"]) == 2


@pytest.mark.parametrize(
    ("file", "said"),
    [
        ("none.npz", "speaks against torque_bias"),
        ("stiff.npz", "something more is missing here"),
    ],
)
def test_a_recording_of_another_machine_is_told(
    diagnosed: Path, file: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["diagnose", str(diagnosed / "session.toml"), "-o", str(diagnosed / "out")]
    capsys.readouterr()
    assert run([*words, "--add", str(diagnosed / file)]) == 0
    assert said in capsys.readouterr().out


@pytest.mark.parametrize("lost", ["effects", "extended", "evidence", "schema", "data.through"])
def test_findings_that_somebody_damaged_are_refused_in_a_sentence(
    diagnosed: Path, lost: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = json.loads((diagnosed / "out" / "findings.json").read_text(encoding="utf-8"))
    first, _, then = lost.partition(".")
    if then:
        found[first][then] = {"horizon": 0.3, "nonsense": 1}
    else:
        found[first] = 7
    (tmp_path / "findings.json").write_text(json.dumps(found), encoding="utf-8")
    for plant in ("base.toml", "plant.toml"):
        (tmp_path / plant).write_bytes((diagnosed / "out" / plant).read_bytes())
    words = ["diagnose", str(diagnosed / "session.toml"), "-o", str(tmp_path)]
    capsys.readouterr()
    assert run([*words, "--add", str(diagnosed / "none.npz")]) == 2
    error = capsys.readouterr().err
    assert "run stiction diagnose" in error
    assert error.count("\n") == 1


def test_what_cannot_be_added_is_refused_in_a_sentence(
    diagnosed: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    session, out = str(diagnosed / "session.toml"), diagnosed / "out"
    new = str(diagnosed / "r7.npz")
    (tmp_path / "bad").mkdir()
    (tmp_path / "bad" / "findings.json").write_text("{}", encoding="utf-8")
    short = tmp_path / "short.npz"
    row = np.arange(4.0)
    np.savez(short, time_s=DT * row, torque_nm=row, position_rad=row)
    capsys.readouterr()
    for words, said in (
        (["--add", str(diagnosed / "r0.npz"), "-o", str(out)], "is part of this diagnosis already"),
        (["--add", new, "-o", str(tmp_path / "nowhere")], "there is no diagnosis; run stiction"),
        (["--add", new, "-o", str(tmp_path / "bad")], "there is no diagnosis"),
        (["--add", str(tmp_path / "no.npz"), "-o", str(out)], "there is no such file"),
        (["--add", str(short), "-o", str(out)], "short.npz"),
    ):
        before = (out / "findings.json").read_bytes()
        assert run(["diagnose", session, *words]) == 2
        error = capsys.readouterr().err
        assert said in error
        assert error.count("\n") == 1
        assert (out / "findings.json").read_bytes() == before
