"""Nested tables of a settings file -> frozen structs, with errors that a person can act on.

A `Table` with a field `settings` is open: keys that it does not know are gathered there, for somebody else to check.
"""

from __future__ import annotations

import dataclasses
import difflib
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar, get_args, get_type_hints

import msgspec

from muybridge.errors import InputError

Converted = TypeVar("Converted")


class Table(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """A table of the file; what it does not name keeps its default."""


def convert(table: Mapping[str, Any], kind: type[Converted], folder: Path, source: str) -> Converted:
    """`table` as a `kind`; relative paths start from `folder`, errors from `source`."""
    try:
        return msgspec.convert(_gathered(table, kind, source, ""), kind, dec_hook=lambda _, value: _path(value, folder))
    except msgspec.ValidationError as error:
        raise _explain(error, kind, source) from error


def replaced(config: Converted, settings: Mapping[str, Any], source: str) -> Converted:
    """A frozen dataclass with some of its fields replaced; the settings' names and types are checked."""
    known = [field.name for field in dataclasses.fields(config)]  # type: ignore[arg-type]
    for key in settings:
        if key not in known:
            raise unknown(source, key, known)
    try:
        typed = msgspec.convert(dict(settings), type(config))
    except msgspec.ValidationError as error:
        raise _explain(error, type(config), source) from error
    return dataclasses.replace(config, **{key: getattr(typed, key) for key in settings})  # type: ignore[type-var]


def unknown(source: str, name: str, known: Sequence[str]) -> InputError:
    """The error for a name that is none of the known ones; it names the nearest."""
    near = difflib.get_close_matches(name.rpartition(".")[2], known, n=1, cutoff=0.5)
    remedy = f"did you mean {near[0]}?" if near else ""
    return InputError(f"{source}: unknown {name}", expected="one of " + ", ".join(known), remedy=remedy)


def copied(value: Any) -> Any:
    """Nested tables and lists as new dicts and lists."""
    if isinstance(value, Mapping):
        return {key: copied(item) for key, item in value.items()}
    return [copied(item) for item in value] if isinstance(value, list | tuple) else value


def override(table: dict[str, Any], text: str) -> None:
    """Set `a.b=value` in nested tables. The value is read as TOML; what is not TOML is a string."""
    dotted, equals, value_text = (part.strip() for part in text.partition("="))
    keys = dotted.split(".")
    if not equals or not all(keys):
        raise InputError("--set", expected="KEY=VALUE such as filter.particles=1000", got=text)
    try:
        value = tomllib.loads(f"value = {value_text}")["value"]
    except tomllib.TOMLDecodeError:
        value = value_text
    here: Any = table
    for key in keys[:-1]:
        here = _row(here, key) if isinstance(here, list) else here.setdefault(key, {})
        if not isinstance(here, dict | list):
            raise InputError(f"--set {dotted}", expected=f"{key} to be a table", got=repr(here))
    if not isinstance(here, dict):
        raise InputError(f"--set {dotted}", expected="a key of one row, such as camera.NAME.frame_rate", got=text)
    here[keys[-1]] = value


def _row(rows: list[Any], key: str) -> Any:
    """The row of that name, or of that number counted from 0."""
    names = [str(row.get("name")) if isinstance(row, dict) else "" for row in rows]
    if key in names:
        return rows[names.index(key)]
    if key.isdecimal() and int(key) < len(rows):
        return rows[int(key)]
    raise unknown("--set", key, names)


def _gathered(value: Any, kind: Any, source: str, place: str) -> Any:
    """`value` with the keys of open tables gathered; raises at the first key that a closed one does not have."""
    if isinstance(value, list):
        return [_gathered(row, kind, source, f"{place[:-1]}[{index}].") for index, row in enumerate(value)]
    table_kind = _table_kind(kind)
    if table_kind is None or not isinstance(value, Mapping):
        return value
    fields = {item.encode_name: item.type for item in msgspec.structs.fields(table_kind)}
    is_open = fields.pop("settings", None) is not None
    result: dict[str, Any] = {}
    for key, item in value.items():
        if key in fields:
            result[key] = _gathered(item, fields[key], source, f"{place}{key}.")
        elif is_open:
            result.setdefault("settings", {})[key] = item
        else:
            raise unknown(source, f"{place}{key}", list(fields))
    return result


def _table_kind(kind: Any) -> type[Table] | None:
    """The table type inside an optional, annotated or repeated one; None where there is none."""
    if isinstance(kind, type) and issubclass(kind, Table):
        return kind
    return next((found for part in get_args(kind) if (found := _table_kind(part)) is not None), None)


def _path(value: Any, folder: Path) -> Path:
    if not isinstance(value, str):
        raise ValueError(f"expected a path, got {value!r}")
    return folder / Path(value).expanduser()


def _explain(error: msgspec.ValidationError, kind: Any, source: str) -> InputError:
    """msgspec says "Expected `int`, got `str` - at `$.camera[0].frame_rate`": put the place first."""
    problem, _, place = str(error).partition(" - at ")
    place = place.strip("`").removeprefix("$").removeprefix(".")
    where = f"{source}: {place}" if place else source
    problem = problem.replace("`", "").replace(" | null", "")
    if problem.startswith("Invalid enum value"):
        return InputError(where, expected=" or ".join(_choices(kind, place)), got=problem[len("Invalid enum value ") :])
    expected, comma, got = problem.removeprefix("Expected ").partition(", got ")
    if problem.startswith("Expected ") and comma:
        return InputError(where, expected=expected, got=got)
    return InputError(f"{where}: {problem[:1].lower()}{problem[1:]}")


def _choices(kind: Any, place: str) -> list[str]:
    """The strings that the field at `place` may be."""
    for key in place.split("."):
        hints = get_type_hints(_table_kind(kind) or kind)
        kind = hints.get(key.partition("[")[0], hints.get(key.partition("[")[0] + "s"))
    return [str(choice) for part in (kind, *get_args(kind)) for choice in get_args(part) if isinstance(choice, str)]
