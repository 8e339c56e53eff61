"""TOML: read with one clear line where it cannot be; written with the few kinds of values that a job has."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from muybridge.errors import InputError


def load(path: Path, what: str) -> dict[str, Any]:
    """The tables of a file that should hold `what`, such as "a job"."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(str(path), expected=f"{what} file", got=error.strerror or str(error)) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(str(path), expected=f"{what} in TOML", got=str(error)) from error


def dumps(table: Mapping[str, Any]) -> str:
    """A TOML document of nested tables, lists of tables, lists, strings, numbers and booleans; None is left out.

    Examples
    --------
    >>> print(dumps({"seed": 1, "filter": {"name": "guided"}}))
    seed = 1
    <BLANKLINE>
    [filter]
    name = "guided"
    <BLANKLINE>
    """
    return "\n".join(_lines(table, "")).strip("\n") + "\n"


def _lines(table: Mapping[str, Any], prefix: str) -> Iterator[str]:
    filled = {key: value for key, value in table.items() if value is not None}
    for key, value in filled.items():
        if not _is_table(value) and not _is_table_list(value):
            yield f"{_key(key)} = {_value(value)}"
    for key, value in filled.items():
        name = f"{prefix}{_key(key)}"
        if _is_table(value):
            yield from ("", f"[{name}]", *_lines(value, f"{name}."))
        elif _is_table_list(value):
            for row in value:
                yield from ("", f"[[{name}]]", *_lines(row, f"{name}."))


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping)


def _is_table_list(value: Any) -> bool:
    return isinstance(value, list | tuple) and len(value) > 0 and all(_is_table(row) for row in value)


def _key(key: str) -> str:
    bare = key.replace("_", "").replace("-", "")
    return key if bare.isascii() and bare.isalnum() else _quoted(key)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    return _quoted(str(value))


def _quoted(text: str) -> str:
    """JSON's escapes are TOML's too, as long as no character beyond the basic plane is split in two."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
