"""What happens once before the first frame: how much pictures are reduced."""

from __future__ import annotations

from pathlib import Path

import pytest

from muybridge.body import named_body
from muybridge.cameras.model import Rig
from muybridge.io.job import from_table
from muybridge.tracking.prepare import reductions_of
from tracking.made import ring

TABLE = {"calibration": {"file": "c.json"}, "camera": [{"name": "a", "pictures": "a.mp4"}]}


@pytest.mark.parametrize(("method", "rows"), [("guided", 230), ("agp-pf", 115)])
def test_the_person_has_the_rows_that_the_filter_needs(method: str, rows: int) -> None:
    """To whole factors of 2 and more: off by a quarter at most."""
    body = named_body("person")
    rig = Rig(tuple(camera.scaled(12.0) for camera in ring()))
    seen = [camera.matrix[1, 1] * body.height / camera.world_to_camera([0.0, 0.0, 1.0])[2] for camera in rig]
    job = from_table({**TABLE, "filter": {"name": method}}, Path())
    for tall, factor in zip(seen, reductions_of(job, rig, body), strict=True):
        assert factor >= 2
        assert tall / factor == pytest.approx(rows, rel=0.25)
    given = from_table({**TABLE, "filter": {"name": method}, "likelihood": {"reduction": 3}}, Path())
    assert reductions_of(given, rig, body) == (3,) * len(rig)
