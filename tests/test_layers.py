"""Imports run downwards only, and the guard that says so still bites."""

from __future__ import annotations

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
KERNEL_IMPORTS = {"__future__", "math", "numba", "numpy", "muybridge._kernels"}


def lint(folder: Path) -> subprocess.CompletedProcess[str]:
    """import-linter over the sources in `folder`, with the configuration in it."""
    command = [sys.executable, "-c", "from importlinter.cli import lint_imports_command as c; c()", "--no-cache"]
    environment = {**os.environ, "PYTHONPATH": str(folder / "src"), "COLUMNS": "300"}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """A copy of the sources that a test may spoil."""
    ignored = shutil.ignore_patterns("__pycache__", "*.npz")
    shutil.copytree(ROOT / "src" / "muybridge", tmp_path / "src" / "muybridge", ignore=ignored)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def test_contracts_are_kept(copy: Path) -> None:
    result = lint(copy)
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.parametrize(
    ("lower", "upward", "contract"),
    [
        ("filters/spoilt.py", "import muybridge.cameras", "downwards"),
        ("io/spoilt.py", "from muybridge import cli", "downwards"),
        ("cameras/spoilt.py", "def late():\n    from muybridge.segmentation import Segmenter\n", "downwards"),
        ("_kernels/spoilt.py", "from muybridge.errors import InputError", "arrays and scalars"),
        ("io/spoilt.py", "from rich import print", "only it prints"),
        ("newcomer/__init__.py", "", "downwards"),
    ],
)
def test_the_guard_bites(copy: Path, lower: str, upward: str, contract: str) -> None:
    spoilt = copy / "src" / "muybridge" / lower
    spoilt.parent.mkdir(exist_ok=True)
    spoilt.write_text(upward + "\n")
    result = lint(copy)
    assert result.returncode != 0
    broken = [line for line in result.stdout.splitlines() if " BROKEN" in line]
    assert len(broken) == 1 and contract in broken[0], result.stdout


def imported(source: str) -> set[str]:
    """The packages that a module imports; of muybridge's own, the first two names."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add("muybridge._kernels" if node.level else str(node.module))
    return {".".join(name.split(".")[: 2 if name.startswith("muybridge") else 1]) for name in names}


def test_kernels_import_only_what_compiles() -> None:
    for path in sorted((ROOT / "src/muybridge/_kernels").glob("*.py")):
        assert imported(path.read_text(encoding="utf-8")) <= KERNEL_IMPORTS, path.name


def test_what_a_module_imports_is_seen() -> None:
    source = "import numpy.linalg\nfrom muybridge.io import job\nfrom . import bits\ndef f():\n    import cv2"
    assert imported(source) == {"numpy", "muybridge.io", "muybridge._kernels", "cv2"}


@pytest.mark.parametrize("module", ["numpy", "numba", "cv2", "av", "scipy", "matplotlib", "sklearn", "rich"])
def test_the_package_itself_imports_nothing_heavy(module: str) -> None:
    """A count of modules stands for the time, which another process on the machine may take."""
    code = f"import sys, muybridge; sys.exit({module!r} in sys.modules)"
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    assert subprocess.run([sys.executable, "-c", code], env=environment).returncode == 0
