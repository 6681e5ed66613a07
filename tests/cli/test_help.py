"""Help, version, completion and the manual page: at once, with examples that can be typed."""

from __future__ import annotations

import inspect
import json
import os
import shlex
import shutil
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import cyclopts
import pytest
from tests.cli.desk import Desk

import stiction as st
from stiction import cli
from stiction.cli import run
from stiction.cli.app import VERBS, Verb, build

NAMES = [verb.name for verb in VERBS]
WITHOUT_PROGRESS = {"import", "laws", "effects", "completion", "bench"}
"""They are done at once; of the bench each verb below it has the option."""


def implemented(verb: Verb) -> object:
    module, _, name = verb.where.partition(":")
    return getattr(import_module(f"{cli.__name__}.{module}"), name)


@pytest.mark.parametrize("verb", VERBS, ids=NAMES)
def test_a_summary_is_what_the_verb_says_itself(verb: Verb) -> None:
    own = implemented(verb)
    said = own.help if isinstance(own, cyclopts.App) else inspect.getdoc(own) or ""
    assert said.splitlines()[0] == verb.summary


@pytest.mark.parametrize("verb", VERBS, ids=NAMES)
def test_examples_are_shown_and_can_be_typed(
    verb: Verb, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run([verb.name, "--help"]) == 0
    shown = capsys.readouterr().out
    assert ("--quiet" in shown) is (verb.name not in WITHOUT_PROGRESS)
    assert 1 <= len(verb.examples) <= 3
    for words, meaning in verb.examples:
        assert meaning
        assert f"stiction {words}" in shown
        typed = shlex.split(words.partition(" > ")[0])
        build(verb.name).parse_args(typed, exit_on_error=False, print_error=False)


HEAVY = ("numpy", "scipy", "matplotlib", "stiction.plant", "stiction.diagnosis.pipeline")


def imported_for(*words: str) -> tuple[str, list[str]]:
    """What a command prints, and what of it that takes long was imported on the way."""
    code = (
        f"import sys\nfrom stiction.cli import run\nrun({list(words)})\n"
        f"print(*sorted({set(HEAVY)} & sys.modules.keys()), file=sys.stderr)"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return ended.stdout, ended.stderr.split()


@pytest.mark.parametrize(
    "words", [("--help",), ("--version",), *((name, "--help") for name in NAMES)], ids=" ".join
)
def test_help_imports_nothing_that_takes_long(words: tuple[str, ...]) -> None:
    shown, heavy = imported_for(*words)
    assert heavy == []
    assert words != ("--help",) or all(f" {name} " in shown for name in NAMES)


def test_the_version_says_which_build_this_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["--version"]) == 0
    first, build_of, threads, stands_on, *extras = capsys.readouterr().out.splitlines()
    assert first == f"stiction {st.__version__}"
    assert build_of.startswith(("build: release", "build: debug"))
    assert threads.partition(": ")[2].isdigit()
    assert stands_on.startswith("python 3.")
    assert "dev" not in " ".join(extras).replace(",", " ").split()


@pytest.mark.skipif(shutil.which("bash") is None, reason="asks bash")
def test_bash_completes_verbs_and_options(tmp_path: Path) -> None:
    assert run(["completion", "bash", "--out", str(tmp_path)]) == 0
    script = tmp_path / "stiction"
    for line, wanted in (("stiction dia", "diagnose"), ("stiction diagnose --su", "--surrogates")):
        words = line.split()
        asked = (
            f"source {shlex.quote(str(script))}; COMP_WORDS=({line}); "
            f"COMP_CWORD={len(words) - 1}; COMP_LINE='{line}'; COMP_POINT={len(line)}; "
            "f=$(complete -p stiction | sed 's/.*-F \\([^ ]*\\).*/\\1/'); "
            f"$f stiction {words[-1]} {words[-2]}; echo ${{COMPREPLY[@]}}"
        )
        done = subprocess.run(["bash", "-c", asked], capture_output=True, text=True, check=True)
        assert done.stdout.split() == [wanted], done


@pytest.mark.parametrize("shell", ["zsh", "fish", "powershell"])
def test_other_shells_get_a_script_with_every_verb(
    shell: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["completion", shell, "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["shell"] == shell
    assert all(name in said["text"] for name in NAMES)


def test_the_manual_page_has_every_verb_with_its_options(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run(["completion", "man"]) == 0
    page = capsys.readouterr().out
    assert page.startswith(".TH STICTION 1")
    assert all(f"\nstiction {name}\n" in page for name in NAMES)
    assert "\\-\\-surrogates" in page
    assert "EXIT STATUS" in page
    if shutil.which("groff"):
        done = subprocess.run(
            ["groff", "-man", "-Tutf8", "-ww", "-K", "utf8"], input=page, capture_output=True,
            text=True, encoding="utf-8", check=True,
        )  # fmt: skip
        assert "Fit the plant of a session" in " ".join(done.stdout.split())


def test_quiet_ends_progress(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("stiction.cli.progress.SELDOM", 0.003)
    desk = Desk(tmp_path)
    words = ["fit", str(desk.session), "-o", str(tmp_path / "out")]
    assert run(words) == 0
    assert capsys.readouterr().err
    assert run([*words, "--quiet"]) == 0
    assert capsys.readouterr().err == ""
    assert os.path.exists(tmp_path / "out" / "plant.toml")
