"""What every command prints in the same way."""

from __future__ import annotations

import json as json_format
import math
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Annotated, Any, Protocol

from cyclopts import Parameter

DONE, BAD_INPUT, LOST, INTERRUPTED = 0, 2, 3, 130
"""Exit codes. LOST: it ran to the end, but the person was lost on the way."""


class Progress(Protocol):
    """What the core may call now and then; it never prints itself."""

    def __call__(self, done: int, total: int | None, message: str = "") -> None:
        """So many of `total` are done, None where nobody knows how many; the message stands beside the bar."""
        ...


Switch = Annotated[bool, Parameter(negative=(), show_default=False)]


@Parameter(name="*")
@dataclass(frozen=True)
class Reporting:
    """How much is said."""

    quiet: Switch = False
    """Print nothing but errors (and the line of --json)."""

    json: Switch = False
    """Print one JSON object as the last line of stdout."""

    def say(self, text: str) -> None:
        """A line for people, on stdout."""
        if not self.quiet:
            print(text, flush=True)

    def finish(self, record: Mapping[str, Any]) -> None:
        """The result for programs, on one line."""
        if self.json:
            print(json_format.dumps(plain(record), allow_nan=False), flush=True)

    @contextmanager
    def progress(self, what: str) -> Iterator[Progress]:
        """A bar on stderr while the block runs; nothing where stderr is no terminal or --quiet is given."""
        if self.quiet or not sys.stderr.isatty():
            yield _ignore
            return
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
        from rich.progress import Progress as Bars

        columns = [TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()]
        with Bars(*columns, TextColumn("{task.fields[message]}"), console=Console(stderr=True)) as bars:
            task = bars.add_task(what, total=None, message="")
            yield lambda done, total, message="": bars.update(task, completed=done, total=total, message=message)


def plain(value: Any) -> Any:
    """`value` in JSON's own types: NaN and infinities become null, paths and the like text."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if hasattr(value, "tolist"):  # a numpy array or scalar, without importing numpy to ask
        return plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, bool | int | str) else str(value)


def _ignore(done: int, total: int | None, message: str = "") -> None:
    """Progress that nobody watches."""


DEFAULT_REPORTING = Reporting()
