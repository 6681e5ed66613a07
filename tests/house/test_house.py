"""The house: stubs, wheel, and that the one-place rule reaches Python."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import venv
from pathlib import Path

import pytest

import stiction as st

REPOSITORY = Path(__file__).parents[2]


def test_every_public_name_is_importable_and_documented() -> None:
    for name in st.__all__:
        value = getattr(st, name)
        if name != "__version__":
            assert (value.__doc__ or "").strip(), f"{name} has no docstring"


def test_the_version_is_that_of_the_workspace() -> None:
    text = (REPOSITORY / "Cargo.toml").read_text()
    assert st.__version__ == re.search(r'^version = "(.*)"', text, re.MULTILINE)[1]  # type: ignore[index]


def test_laws_and_effects_of_the_core_reach_python() -> None:
    folder = REPOSITORY / "crates" / "stiction-core" / "src"
    for part, records in (("friction", st.laws()), ("plant/effects", st.effects())):
        files = {path.stem for path in (folder / part).glob("*.rs")} - {"mod"}
        # One of several files is a folder; shared pieces are one too.
        files |= {path.parent.name for path in (folder / part).glob("*/mod.rs")} - {"elements"}
        assert files == {record.name for record in records}


@pytest.mark.slow
def test_a_wheel_installs_without_rust(tmp_path: Path) -> None:
    if shutil.which("cargo") is None:
        pytest.skip("no cargo to build a wheel with")
    # What is asked is whether a wheel has all it needs: the profile that is built anyway will do.
    build = [sys.executable, "-m", "maturin", "build", "--quiet", "--release"]
    subprocess.run([*build, "--out", str(tmp_path)], cwd=REPOSITORY, check=True)
    (wheel,) = tmp_path.glob("*.whl")
    assert "abi3" in wheel.name
    fresh = tmp_path / "fresh"
    venv.create(fresh, with_pip=True)
    python = fresh / ("Scripts" if os.name == "nt" else "bin") / "python"
    # A path without cargo and rustc: nothing can be compiled.
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "VIRTUAL_ENV")}
    environment["PATH"] = os.pathsep.join(
        part for part in environment["PATH"].split(os.pathsep)
        if not (Path(part) / "cargo").exists() and not (Path(part) / "rustc").exists()
    )  # fmt: skip
    assert shutil.which("cargo", path=environment["PATH"]) is None
    pip = [str(python), "-m", "pip", "--quiet", "install", "--only-binary=:all:", str(wheel)]
    subprocess.run(pip, check=True, env=environment)
    code = (
        "import stiction as st; m = st.Motor(0.0076, friction=st.FrictionModel('hsieh_pan')); "
        "x, v = m.step(0.2, 1e-4); assert x > 0"
    )
    subprocess.run([str(python), "-c", code], check=True, env=environment, cwd=tmp_path)
    laws = [str(python), "-m", "stiction", "laws"]
    listing = subprocess.run(laws, check=True, env=environment, cwd=tmp_path, capture_output=True)
    assert b"hsieh_pan" in listing.stdout
