"""Where people stand on the ground, of a calibrated camera: the floor is the plane z = 0 of its world."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from muybridge.cameras.model import Camera
from muybridge.io.boxes import BoxSeries
from muybridge.io.disk import replace_file
from muybridge.io.run_folder import fixed

GROUND_FILE = "ground.csv"
HEADER = "frame,id,x_m,y_m"
DECIMALS = 3


def on_ground(boxes: BoxSeries, camera: Camera) -> NDArray[np.float64]:
    """(M, 2) metres, world: where the middle of each box's lower side meets the floor; NaN where it does not."""
    feet = boxes.boxes[:, :2] + boxes.boxes[:, 2:] * (0.5, 1.0) - 0.5  # pixel centres are whole numbers
    origins, rays = camera.pixel_to_ray(feet)
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = -origins[:, 2] / rays[:, 2]
        places = origins[:, :2] + distance[:, None] * rays[:, :2]
    ahead: NDArray[np.bool_] = np.isfinite(distance) & (distance > 0)
    return np.where(ahead[:, None], places, np.nan)


def write_ground(path: Path, boxes: BoxSeries, places: NDArray[np.float64]) -> None:
    """Frames from 1, as in tracks.txt; those who stand nowhere on the floor are left out."""
    known = np.isfinite(places).all(axis=1)
    rows = zip(boxes.frames[known] + 1, boxes.ids[known], places[known])
    lines = [f"{frame},{identity},{fixed(x, DECIMALS)},{fixed(y, DECIMALS)}\n" for frame, identity, (x, y) in rows]
    replace_file(path, f"{HEADER}\n{''.join(lines)}".encode())
