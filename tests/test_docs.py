"""The documentation says what is so: marked blocks run, links lead somewhere, keys and commands exist.

A block is run where the line before it is `<!-- run -->`. Of a console block the lines that begin with `$ ` are run by
the shell, one after another, in an empty folder; a Python block is run as a script.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import msgspec
import pytest

from muybridge.cli.app import COMMANDS
from muybridge.io import job
from muybridge.io._tables import Table
from muybridge.tracking.motion import motion_of

ROOT = Path(__file__).resolve().parents[1]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "papers").rglob("*.md")])
MARKED = re.compile(r"^<!-- run -->\n+```(console|python)\n(.*?)^```", re.MULTILINE | re.DOTALL)
MOTION_ROW = r"^\| `(\w+)`" + 4 * r" \| ([\d.]+)"
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")


class Block(NamedTuple):
    """A piece of a page that is run."""

    page: str
    language: str
    text: str


def marked_blocks() -> Iterator[Block]:
    for page in PAGES:
        for language, text in MARKED.findall(page.read_text(encoding="utf-8")):
            yield Block(page.name, language, text)


def code_of(text: str) -> str:
    """Everything in backticks or fences: what a reader would type."""
    return "\n".join(re.findall(r"```.*?```|`[^`\n]+`", text, re.DOTALL))


@pytest.mark.parametrize("block", list(marked_blocks()), ids=lambda block: f"{block.page}-{block.text.split()[-1]}")
def test_marked_blocks_run(block: Block, tmp_path: Path) -> None:
    (tmp_path / "muybridge").write_text(f'#!/bin/sh\nexec "{sys.executable}" -m muybridge "$@"\n')
    (tmp_path / "muybridge").chmod(0o755)
    (tmp_path / "empty").mkdir()
    environment = {
        **os.environ,
        "PATH": f"{tmp_path}:{Path(sys.executable).parent}:{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT / "src"),
    }
    if block.language == "console":
        lines = [line[2:] for line in block.text.splitlines() if line.startswith("$ ")]
        command = ["sh", "-e", "-c", "\n".join(lines)]
    else:
        command = [sys.executable, "-c", block.text]
    result = subprocess.run(command, cwd=tmp_path / "empty", env=environment, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    for target in LINK.findall(page.read_text(encoding="utf-8")):
        if not target.startswith(("https://", "#")):
            assert (page.parent / target.partition("#")[0]).exists(), target


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_and_targets_exist(page: Path) -> None:
    code = code_of(page.read_text(encoding="utf-8"))
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    assert set(re.findall(r"\bmake ([a-z-]+)", code)) <= targets
    assert set(re.findall(r"\bmuybridge ([a-z][a-z-]*)(?![\w./=-])", code)) <= set(COMMANDS)


def tables_of(kind: type[Table]) -> Iterator[type[Table]]:
    """A table and all tables inside it."""
    yield kind
    for name in dir(job):
        inner = getattr(job, name)
        if isinstance(inner, type) and issubclass(inner, Table) and inner not in (Table, kind):
            yield inner


def test_the_job_page_names_every_key_and_no_other() -> None:
    page = (ROOT / "docs/job.md").read_text(encoding="utf-8")
    documented = set(re.findall(r"^\| `(\w+)` \|", page, re.MULTILINE))
    keys = {field.encode_name for kind in tables_of(job.Job) for field in msgspec.structs.fields(kind)}
    tables = {"calibration", "camera", "body", "start", "guess", "filter", "motion", "likelihood", "reference"}
    tables |= {"settings"}
    assert documented == keys - tables
    assert all(re.search(rf"^## `\[+{table}\]", page, re.MULTILINE) for table in tables - {"settings"})


def test_the_job_page_has_the_defaults_of_motion() -> None:
    """Columns: guided, with one camera, others, with one camera."""
    section = (ROOT / "docs/job.md").read_text(encoding="utf-8").split("## `[motion]`")[1].split("\n## ")[0]
    rows = {row[0]: [float(value) for value in row[1:]] for row in re.findall(MOTION_ROW, section, re.MULTILINE)}
    ours = [motion_of(method, cameras) for method in ("guided", "annealed") for cameras in (3, 1)]
    assert rows == {field: [getattr(motion, field) for motion in ours] for field in vars(ours[0])}


def test_the_first_screen_says_what_to_type() -> None:
    first_screen = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()[:25]
    for words in ("make demo", "make test", "Python >= 3.11", "docs/images/demo.png"):
        assert any(words in line for line in first_screen), words
