"""The command line: one file a command, and the only place that prints.

| module | what |
|---|---|
| `app` | the table of commands, and what each exit code means |
| `reporting` | what all commands print the same way: lines, the `--json` line, the progress bar |
| others | one command each, of the same name |

Commands are imported when they are called, so that `muybridge --help` does not wait for numba.
"""

from __future__ import annotations

from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command that `arguments` (those of the process where absent) ask for, and exit with its code."""
    import sys

    from muybridge.cli.app import run

    sys.exit(run(sys.argv[1:] if arguments is None else list(arguments)))
