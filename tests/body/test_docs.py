"""The page on bodies lists the bodies there are, with their sizes, and every key of the format."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from muybridge.body import catalogue, load, named_body

PAGE = (Path(__file__).resolve().parents[2] / "docs/bodies.md").read_text(encoding="utf-8")


def test_the_table_lists_the_catalogue() -> None:
    rows = dict(re.findall(r"^\| `([\w-]+)` \| ([^|]*\| \d+) \|", PAGE, re.MULTILINE))
    assert set(rows) == set(catalogue())
    for name, sizes in rows.items():
        body = named_body(name)
        segments, freedoms = re.fullmatch(r"(\d+).*\| (\d+)", sizes).groups()  # type: ignore[union-attr]
        assert (int(segments), int(freedoms)) == (len(body.arrays.shaped) + _links(name), len(body.dof_names))


def _links(name: str) -> int:
    """Segments without a shape that the page counts: the person's clavicles."""
    body = named_body(name)
    return 0 if name == "bodytrack" else len(body.segments) - len(body.arrays.shaped)


@pytest.mark.parametrize(
    ("heading", "keys"),
    [
        ("The format", load._BODY_KEYS[:3]),
        ("`[[segment]]`, one for each part", load._SEGMENT_KEYS),
        ("A rotation", load._ROTATION_KEYS),
        ("A shape", load._SHAPE_KEYS),
        ("`[joints]`, the points that are reported", load._JOINT_KEYS),
    ],
)
def test_tables_name_every_key_and_no_other(heading: str, keys: tuple[str, ...]) -> None:
    section = PAGE.split(f"# {heading}\n")[1].split("\n#")[0]
    assert set(re.findall(r"^\| `(\w+)` \|", section, re.MULTILINE)) == set(keys)
