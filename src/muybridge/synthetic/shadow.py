"""The person's shadow on the floor: the mesh laid flat along the light, blurred, and looked up in each camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from muybridge.synthetic.rasterise import coverage_of, extent

CELL = 0.015  # metres; about a pixel on the floor
MARGIN = 0.4  # metres of floor kept around the shadow
PENUMBRA, CONTACT = 0.035, 0.05  # metres, standard deviations: a large lamp; light that does not get under a shoe
CONTACT_HEIGHT = 0.12  # metres: what is lower than this darkens the floor beneath it
CONTACT_SHADE = 0.5


@dataclass(frozen=True, eq=False)
class FloorShade:
    """How much light each piece of the floor still gets.

    Parameters
    ----------
    origin : (2,) metres, world: the middle of cell [0, 0]
    light : (rows, columns) float32 in 0-1; rows go along y, columns along x
    cell : metres, the side of a cell
    """

    origin: np.ndarray
    light: np.ndarray
    cell: float = CELL

    def applied(self, plate: np.ndarray, floor: np.ndarray) -> np.ndarray:
        """A copy of a picture (H, W, 3) float32, darkened where its floor (H, W, 2), metres, lies in shadow."""
        import cv2

        cells = (floor - self.origin.astype(np.float32)) / np.float32(self.cell)
        rows, columns = self.light.shape
        # NaN compares false: what is no floor stays as it is.
        near = (cells[..., 0] > 0) & (cells[..., 0] < columns - 1) & (cells[..., 1] > 0) & (cells[..., 1] < rows - 1)
        shaded = plate.copy()
        if not near.any():
            return shaded
        where = np.flatnonzero(near.any(axis=1))
        across = np.flatnonzero(near.any(axis=0))
        window = slice(where[0], where[-1] + 1), slice(across[0], across[-1] + 1)
        part = np.where(near[window][..., None], cells[window], np.float32(-1.0))
        light = cv2.remap(
            self.light, part[..., 0], part[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=1.0
        )
        shaded[window] *= light[..., None]
        return shaded


def floor_shade(
    vertices: np.ndarray, faces: np.ndarray, light: np.ndarray, strength: float, cell: float = CELL
) -> FloorShade:
    """The shadow of a mesh on z = 0.

    Parameters
    ----------
    vertices : (V, 3) float64, metres, world; faces : (F, 3) int32
    light : (3,) towards the lamp; strength : 0-1, how dark the cast shadow is
    """
    import cv2

    cast = vertices[:, :2] - vertices[:, 2:] * (np.asarray(light[:2]) / light[2])
    ends = (*extent(cast), *extent(vertices[:, :2]))
    low, high = np.min(ends, axis=0) - MARGIN, np.max(ends, axis=0) + MARGIN
    columns, rows = np.ceil((high - low) / cell).astype(int) + 1
    dark = coverage_of((cast - low) / cell, faces, columns, rows).astype(np.float32)
    touching = faces[(vertices[faces, 2] < CONTACT_HEIGHT).all(axis=1)]
    under = coverage_of((vertices[:, :2] - low) / cell, touching, columns, rows).astype(np.float32)
    soft = cv2.GaussianBlur(dark, (0, 0), PENUMBRA / cell)
    near = cv2.GaussianBlur(under, (0, 0), CONTACT / cell)
    return FloorShade(low, (1.0 - strength * soft) * (1.0 - CONTACT_SHADE * strength * near), cell)
