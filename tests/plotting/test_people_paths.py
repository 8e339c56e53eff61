"""Paths over the scene and on the ground: where they are drawn, and for whom."""

from __future__ import annotations

import numpy as np

from muybridge.io.boxes import BoxSeries
from muybridge.plotting.people_paths import draw_paths, plot_ground_map
from muybridge.plotting.people_video import colour_of
from muybridge.plotting.style import new_figure

BOXES = BoxSeries(
    np.repeat(np.arange(10), 2), np.tile([1, 2], 10),
    np.array([[20 + 8 * k, 20 + 50 * side, 10, 30] for k in range(10) for side in (0, 1)], float), np.ones(20),
)  # fmt: skip


def test_paths_are_drawn_where_the_feet_were() -> None:
    scene = np.full((120, 160, 3), 90, np.uint8)
    drawn = draw_paths(scene, BOXES)
    assert (scene == 90).all()
    for identity, row in ((1, 50), (2, 100)):
        found = np.flatnonzero((np.abs(drawn[row].astype(int) - colour_of(identity)) < 30).all(axis=1))
        assert found.min() <= 26 and found.max() >= 96  # feet from column 25 to 97, thick lines a pixel more
    assert (drawn[:40] == 90).all()  # nothing above anybody's feet


def test_the_map_has_a_way_and_a_beginning_for_everybody() -> None:
    _, axes = new_figure()
    places = np.column_stack([np.arange(6.0), np.arange(6.0)])
    places[5] = np.nan
    artists = plot_ground_map(axes[0, 0], np.array([1, 1, 1, 2, 2, 3]), places)
    lines = axes[0, 0].get_lines()
    assert artists == list(lines) and len(lines) == 6
    np.testing.assert_array_equal(lines[3].get_xdata(), [3.0])
    assert np.size(lines[5].get_xdata()) == 0  # who is nowhere on the floor
