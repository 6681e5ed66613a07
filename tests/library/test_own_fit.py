"""Has this machine changed? A later session beside a fit of an earlier one, as a user goes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction import library
from stiction.cli import run

from .test_library import recorded

PLANT = """\
[drive]
input = "torque_nm"
gain = 1.0
[body]
inertia = 0.01
[friction]
law = "coulomb"
coulomb = 0.3
viscous = 0.02
"""


def laid(where: Path, coulomb: float, seed: int) -> Path:
    """A session of the machine, with this much friction."""
    where.mkdir()
    (where / "plant.toml").write_text(PLANT)
    truth = st.Plant.load(where / "plant.toml").with_values({"friction.coulomb": coulomb})
    rows = np.column_stack(recorded(truth, seed=seed))
    head = "time_s,torque_nm,position_rad"
    np.savetxt(where / "run.csv", rows, delimiter=",", header=head, comments="", fmt="%.10g")
    session = where / "session.toml"
    session.write_text('plant = "plant.toml"\n[[recordings]]\nfile = "run.csv"\n')
    return session


@pytest.fixture(scope="module")
def march(tmp_path_factory: pytest.TempPathFactory) -> Path:
    where = tmp_path_factory.mktemp("machine")
    session = laid(where / "march", 0.3, 1)
    assert run(["fit", str(session), "-o", str(where / "march-fit"), "--quiet"]) == 0
    return where / "march-fit"


@pytest.mark.parametrize(("coulomb", "changed"), [(0.3, []), (0.36, ["friction.coulomb"])])
def test_a_later_session_says_what_has_changed(march, coulomb, changed, tmp_path, capsys):
    later = laid(tmp_path / "june", coulomb, 2)
    out = ["-o", str(tmp_path / "beside"), "--quiet"]
    assert run(["library", str(march), "--session", str(later), *out]) == 0
    told = json.loads((tmp_path / "beside" / "comparison.json").read_text())
    assert told["differing"] == changed
    said = f"differs from {march}: friction.coulomb" if changed else f"agrees with {march} in 2"
    assert said in capsys.readouterr().out


def test_a_fit_is_an_entry_by_its_folder_or_a_file_in_it(march: Path) -> None:
    entry = library.entry_of_fit(march)
    fit = json.loads((march / "fit.json").read_text())["parameters"]
    assert entry.numbers["friction.coulomb"].ci95 == tuple(fit["friction.coulomb"]["ci95"])
    assert entry.plant.friction.parameters["coulomb"].value == pytest.approx(0.3, rel=0.01)
    assert library.entry_of_fit(march / "plant.toml").numbers == entry.numbers


def test_what_is_no_fit_is_refused_in_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "plant.toml").write_text(PLANT)
    with pytest.raises(st.InputError, match=r"there is no fit\.json in it"):
        library.entry_of_fit(tmp_path)
    for content in ("{", "[]", '{"parameters": {"a": {"value": null}}}', "[" * 10_000):
        (tmp_path / "fit.json").write_text(content)
        with pytest.raises(st.InputError, match="is not what stiction fit writes"):
            library.entry_of_fit(tmp_path)
