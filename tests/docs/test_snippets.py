"""The documentation does what it says: snippets, commands, examples, links, quoted names."""

from __future__ import annotations

import contextlib
import io
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import stiction as st

REPOSITORY = Path(__file__).parents[2]
README = REPOSITORY / "README.md"
PAGES = sorted([README, *REPOSITORY.glob("*.md"), *(REPOSITORY / "docs").rglob("*.md")])
PAGES = list(dict.fromkeys(PAGES))
EXAMPLES = sorted((REPOSITORY / "examples").glob("*.py"))
LONGEST_EXAMPLE = 60  # lines
LARGEST_FIGURE = 150_000  # bytes
# Languages of blocks that nothing runs; any other word is a typing error.
QUIET = {"text", "rust", "toml"}


def name_of(path: Path) -> str:
    return path.relative_to(REPOSITORY).as_posix()


def blocks(page: Path, language: str) -> list[str]:
    found = re.findall(r"^```(\w*)\n(.*?)^```$", page.read_text("utf-8"), re.M | re.S)
    return [body for word, body in found if word == language]


def pages_with(language: str) -> list[Path]:
    return [page for page in PAGES if blocks(page, language)]


def printed(code: str, namespace: dict[str, object], name: str) -> str:
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(code, name, "exec"), namespace)
    return out.getvalue()


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_every_block_says_its_language(page: Path) -> None:
    words = set(re.findall(r"^```(\w*)\n.*?^```$", page.read_text("utf-8"), re.M | re.S))
    assert words <= QUIET | {"python", "console"}


@pytest.mark.parametrize("page", pages_with("python"), ids=name_of)
def test_python_blocks_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    namespace: dict[str, object] = {}
    for block in blocks(page, "python"):
        # Silent but for what a reader sees it print: nothing in the library talks.
        assert bool(printed(block, namespace, name_of(page))) == ("print(" in block)


def test_the_readme_prints_what_it_shows() -> None:
    code, shown = re.findall(
        r"^```python\n(.*?)^```\n\n^```text\n(.*?)^```$", README.read_text("utf-8"), re.M | re.S
    )[0]
    assert printed(code, {}, "README.md") == shown
    assert len(code.splitlines()) <= 15


@pytest.fixture
def desk(tmp_path: Path) -> Path:
    """A folder with the files that the commands of the documentation name."""
    (tmp_path / "plant.toml").write_text(blocks(README, "toml")[0], encoding="utf-8")
    time = 1e-3 * np.arange(1001)
    current = 1.5 * np.sin(2 * np.pi * 2.0 * time)
    run = st.Plant.load(tmp_path / "plant.toml").simulate(current[:-1], 1e-3)
    table = np.column_stack([time, current, np.concatenate([[0.0], run.position])])
    head = "time_s,current_a,position_rad"
    np.savetxt(tmp_path / "run.csv", table, delimiter=",", header=head, comments="")
    return tmp_path


@pytest.mark.parametrize("page", pages_with("console"), ids=name_of)
def test_commands_run(page: Path, desk: Path) -> None:
    lines = "\n".join(blocks(page, "console")).splitlines()
    commands = [line.removeprefix("$ ") for line in lines if line.startswith("$ ")]
    assert commands
    for command in commands:
        words = command.split()
        assert words[0] == "stiction"
        ended = subprocess.run(
            [sys.executable, "-m", "stiction", *words[1:]],
            cwd=desk,
            capture_output=True,
            text=True,
            check=False,
            env={**os.environ, "PYTHONIOENCODING": "utf-8"},
        )
        assert ended.returncode == 0, f"{command}: {ended.stderr}"
        assert ended.stdout.strip()


@pytest.mark.parametrize("example", EXAMPLES, ids=name_of)
def test_examples_run_and_write_only_when_asked(example: Path, tmp_path: Path) -> None:
    assert len(example.read_text("utf-8").splitlines()) <= LONGEST_EXAMPLE
    environment = {**os.environ, "MPLBACKEND": "Agg", "PYTHONDONTWRITEBYTECODE": "1"}
    environment["PYTHONIOENCODING"] = "utf-8"

    def run(*arguments: str) -> str:
        return subprocess.run(
            [sys.executable, "-W", "error", str(example), *arguments],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=True,
            env=environment,
        ).stdout

    run()
    assert not list(tmp_path.iterdir())
    if "figure.png" in example.read_text("utf-8"):
        run("figure.png")
        assert [path.name for path in tmp_path.iterdir()] == ["figure.png"]


def anchors(page: Path) -> set[str]:
    """The names that headings of a page can be linked by."""
    heads = re.findall(r"^#+ (.*)$", page.read_text("utf-8"), re.M)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_lead_somewhere(page: Path) -> None:
    text = re.sub(r"^```.*?^```$", "", page.read_text("utf-8"), flags=re.M | re.S)
    for link in re.findall(r"\]\(((?:[^()\s]|\([^()\s]*\))+)\)", text):
        if link.startswith(("http://", "https://")):
            continue
        target, _, anchor = link.partition("#")
        path = (page.parent / target).resolve() if target else page
        assert path.exists(), f"{name_of(page)}: {link}"
        assert not anchor or anchor in anchors(path), f"{name_of(page)}: {link}"


def test_every_page_is_on_the_map() -> None:
    index = (REPOSITORY / "docs" / "index.md").read_text("utf-8")
    for page in (REPOSITORY / "docs").rglob("*.md"):
        relative = page.relative_to(REPOSITORY / "docs").as_posix()
        assert relative == "index.md" or f"({relative})" in index


CORE = REPOSITORY / "crates" / "stiction-core" / "src"


@pytest.mark.parametrize(
    ("page", "folder", "trait"),
    [
        ("adding-a-law.md", "friction", "FrictionLaw"),
        ("adding-an-effect.md", "plant/effects", "Effect"),
    ],
)
def test_quoted_rust_implements_the_trait_as_it_is(page: str, folder: str, trait: str) -> None:
    source = "\n".join(file.read_text("utf-8") for file in sorted((CORE / folder).rglob("*.rs")))
    body = re.search(rf"^pub trait {trait}<.*?^}}$", source, re.M | re.S)
    assert body is not None
    members = r"^    (?:fn|const|type) (\w+)"
    known = set(re.findall(members, body[0], re.M))
    # What has no default has to be written by whoever follows the page.
    needed = {
        re.match(members, item)[1]  # type: ignore[index]
        for item in re.split(r"\n(?=    (?:fn|const|type) )", body[0])
        if re.match(members, item) and not re.search(r"^    }|\{ *\n|\{\}$| = ", item, re.M)
    }
    quoted = "\n".join(blocks(REPOSITORY / "docs" / page, "rust"))
    written = re.search(rf"^impl<S: Scalar> {trait}<S> for .*?^}}$", quoted, re.M | re.S)
    assert written is not None
    names = set(re.findall(members, written[0], re.M))
    assert names <= known
    assert needed <= names
    modules = re.findall(r"^use crate::(\w+)::(\w+)", quoted, re.M)
    assert modules
    for room, module in modules:
        assert (CORE / room / f"{module}.rs").exists() or room == "friction"


def test_catalogue_names_in_the_documentation_exist() -> None:
    tables = re.findall(
        r"^\| (law|effect) \|.*\n\|[-|]+\n((?:\|.*\n)+)", README.read_text("utf-8"), re.M
    )
    known = {"law": {r.name for r in st.laws()}, "effect": {r.name for r in st.effects()}}
    assert [kind for kind, _ in tables] == ["law", "effect"]
    for kind, rows in tables:
        assert set(re.findall(r"^\| `(\w+)`", rows, re.M)) == known[kind]


def test_parameter_tables_of_the_theory_match_the_catalogue() -> None:
    for record in st.laws():
        page = REPOSITORY / "docs" / "theory" / f"{record.name.replace('_', '-')}.md"
        if not page.exists():
            continue
        rows = re.findall(
            r"^\| [^|]+ \| `(\w+)` \| ([^|;]+)(?:; ([^|]+))? \|", page.read_text("utf-8"), re.M
        )
        assert [name for name, _, _ in rows] == [p.name for p in record.parameters]
        for (_, unit, linear), parameter in zip(rows, record.parameters, strict=True):
            assert (unit.strip(), (linear or unit).strip()) == (
                parameter.unit,
                parameter.linear_unit,
            )


def test_files_quoted_as_complete_are_the_files() -> None:
    quoted = 0
    for page in sorted((REPOSITORY / "docs").glob("*.md")):
        for path, code in re.findall(
            r"`([\w/.-]+\.rs)`, complete:\n\n```rust\n(.*?)```", page.read_text("utf-8"), re.S
        ):
            if (REPOSITORY / path).exists():
                assert code == (REPOSITORY / path).read_text("utf-8"), f"{page.name}: {path}"
                quoted += 1
    assert quoted


def test_the_figure_is_small() -> None:
    for figure in re.findall(r"!\[.*?\]\((.*?)\)", README.read_text("utf-8")):
        assert (REPOSITORY / figure).stat().st_size < LARGEST_FIGURE


def test_licences_are_whole() -> None:
    for name, words in (("LICENSE-MIT", 150), ("LICENSE-APACHE", 1500)):
        text = (REPOSITORY / name).read_text("utf-8")
        assert len(text.split()) > words
        assert re.search(r"Copyright (\(c\) )?2026 The stiction developers", text)
