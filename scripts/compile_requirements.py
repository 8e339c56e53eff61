"""Write requirements.txt: every package with its version and the hashes of all its files, for every platform.

    make requirements

Resolves pyproject.toml's dependencies and its extra `dev` once for all Pythons from 3.11 on (packages that only some
platform or Python needs carry a marker), with `uv` in a throw-away environment. The build backend is included, because
the package itself is installed without build isolation. Only names, versions, markers and hashes are written.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BUILD_BACKEND = "setuptools>=77\n"
HEADER = "# Written by `make requirements`; do not edit. Names, versions and hashes of every file of each package.\n"


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        venv.create(folder, with_pip=True)
        python = Path(folder, "bin", "python")
        subprocess.run([python, "-m", "pip", "install", "--quiet", "uv"], check=True)
        backend = Path(folder, "backend.in")
        backend.write_text(BUILD_BACKEND)
        lines = compile_requirements(python, backend)
    (ROOT / "requirements.txt").write_text(HEADER + lines)
    print(f"requirements.txt: {lines.count('==')} packages, {lines.count('--hash')} hashes", file=sys.stderr)


def compile_requirements(python: Path, backend: Path) -> str:
    """The resolved lines, without a header, an index or a comment on where they come from."""
    command = [python, "-m", "uv", "pip", "compile", "pyproject.toml", backend, "--extra", "dev", "--no-cache"]
    command += ["--universal", "--python-version", "3.11", "--generate-hashes", "--no-header", "--no-annotate"]
    command += ["--no-emit-index-url", "--no-emit-find-links", "--quiet"]
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    main()
