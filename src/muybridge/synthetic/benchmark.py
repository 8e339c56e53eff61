"""How fast people are rendered: CPU time of this process on one thread, the best of several.

The person is as tall as the picture of 640 x 480; two by two samples a pixel, textures and light included, the room and
the sensor's noise not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from muybridge.cameras.model import Camera
from muybridge.likelihood.benchmark import fastest
from muybridge.synthetic.motion import Motion, perform
from muybridge.synthetic.posture import mesh_at, posture_at
from muybridge.synthetic.rasterise import Cloth, draw
from muybridge.synthetic.rigs import looking_at
from muybridge.synthetic.skinning import Figure, load_figure
from muybridge.synthetic.textures import clothing

FRAME = 12  # of a walk at 30 frames a second
LOOSENESS = 0.03  # metres


@dataclass(frozen=True)
class RenderTiming:
    """Frames of one camera in a second of CPU time."""

    name: str
    frames_per_second: float


def time_rendering(name: str = "man", repeats: int = 9) -> list[RenderTiming]:
    """Drawing alone; skinning, normals and drawing; the same with loose clothes."""
    figure = load_figure(name)
    track = perform(figure, Motion("walk", 1.0))
    now = posture_at(track, FRAME)
    mesh = figure.mesh(*now)
    camera, cloth = _filled(mesh.vertices), _cloth(figure)
    work: dict[str, Callable[[], object]] = {
        "draw a person": partial(draw, camera, mesh, cloth),
        "skin and draw a person": lambda: draw(camera, figure.mesh(*now), cloth),
        "skin and draw a person in loose clothes": lambda: draw(
            camera, mesh_at(figure, track, FRAME, LOOSENESS), cloth
        ),
    }
    return [RenderTiming(what, 1.0 / fastest(call, repeats)) for what, call in work.items()]


def _filled(vertices: np.ndarray, distance: float = 4.0, size: tuple[int, int] = (640, 480)) -> Camera:
    """A level camera in whose picture the vertices (V, 3) are as tall as the picture, to a few rows."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle = 0.5 * (low + high)
    focal = 0.98 * size[1] * (distance - 0.5 * (high[0] - low[0])) / (high[2] - low[2])
    return looking_at("bench", middle + (distance, 0.0, 0.0), middle, focal=focal, size=size)


def _cloth(figure: Figure) -> Cloth:
    """Stripes on everything."""
    outfit = {label: ("stripes", (58, 46, 176), (206, 210, 214), 0.28) for label in figure.label_names}
    return clothing(np.random.default_rng(0), outfit, figure.label_names)
