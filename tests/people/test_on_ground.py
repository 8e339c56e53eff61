"""Feet in pixels to metres on the floor, there and back."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from muybridge.io.boxes import BoxSeries
from muybridge.people.on_ground import on_ground, write_ground
from muybridge.synthetic.rigs import looking_at

CAMERA = looking_at("hall", np.array([-4.0, 0.0, 3.2]), np.array([1.6, 0.0, 0.8]), focal=288.0, size=(320, 240))
PLACES = np.array([[0.0, 0.0], [1.5, -1.0], [3.0, 2.0]])


def boxes() -> BoxSeries:
    """Boxes whose lower sides' middles are where the places are seen; of one more, above the horizon."""
    feet = CAMERA.world_to_pixel(np.column_stack([PLACES, np.zeros(3)])) + 0.5
    feet = np.vstack([feet, [160.0, -60.0]])
    size = np.array([20.0, 60.0])
    rows = np.column_stack([feet - size * (0.5, 1.0), np.tile(size, (4, 1))])
    return BoxSeries(np.arange(4), np.ones(4, np.int64), rows, np.ones(4))


def test_places_come_back() -> None:
    found = on_ground(boxes(), CAMERA)
    np.testing.assert_allclose(found[:3], PLACES, atol=1e-6)
    assert np.isnan(found[3]).all()


def test_the_table(tmp_path: Path) -> None:
    write_ground(tmp_path / "ground.csv", boxes(), on_ground(boxes(), CAMERA))
    lines = (tmp_path / "ground.csv").read_text().splitlines()
    assert lines[0] == "frame,id,x_m,y_m" and lines[2] == "2,1,1.500,-1.000" and len(lines) == 4
