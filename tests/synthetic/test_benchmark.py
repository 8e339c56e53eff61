"""The renderer's benchmark measures what it says: a person as tall as the picture."""

from __future__ import annotations

import pytest

from muybridge.synthetic.benchmark import _cloth, _filled, time_rendering
from muybridge.synthetic.motion import Motion, perform
from muybridge.synthetic.rasterise import draw
from muybridge.synthetic.skinning import load_figure
from reference.scene import SLOW


def test_the_person_fills_the_picture():
    figure = load_figure("man")
    track = perform(figure, Motion("walk", 0.5))
    mesh = figure.mesh(track.rotations[3], track.places[3])
    layer = draw(_filled(mesh.vertices), mesh, _cloth(figure))
    rows = (layer.coverage > 0).any(axis=1).sum()
    assert 0.92 * 480 < rows <= 480


@pytest.mark.skipif(SLOW, reason="nothing is compiled")
def test_twenty_frames_a_second():
    """What scenes are planned with; measured 55 to 80 of CPU time, so that a busy machine passes too."""
    for timing in time_rendering(repeats=5):
        assert timing.frames_per_second > 20, timing.name
