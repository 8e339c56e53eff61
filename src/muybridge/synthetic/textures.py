"""Procedural textures: smooth noise, cloth as solid textures, and the surfaces of a room."""

from __future__ import annotations

import numpy as np

from muybridge.errors import InputError
from muybridge.synthetic.rasterise import Cloth

CELLS = 40  # of a solid texture along each side
PATTERNS = ("plain", "stripes", "checks", "blotches", "denim", "smooth")
#: how much the cells of a cloth differ, as a share of its colour
GRAIN = {"denim": 0.16, "smooth": 0.015}
Colour = tuple[int, int, int]


def smooth_noise(rng: np.random.Generator, points: np.ndarray, cell: float, octaves: int = 3) -> np.ndarray:
    """Value noise in about [-1, 1] on a plane.

    Parameters
    ----------
    points : (..., 2) float64, metres
    cell : metres, the size of the coarsest blots; every octave halves it
    """
    total = np.zeros(points.shape[:-1])
    for octave in range(octaves):
        lattice = rng.uniform(-1, 1, (64, 64))
        scaled = points / (cell / 2**octave) + rng.uniform(0, 64, 2)
        whole = np.floor(scaled)
        part = scaled - whole
        part = part * part * (3 - 2 * part)
        i, j = (whole.astype(int) % 64)[..., 0], (whole.astype(int) % 64)[..., 1]
        near = lattice[i, j] * (1 - part[..., 0]) + lattice[(i + 1) % 64, j] * part[..., 0]
        far = lattice[i, (j + 1) % 64] * (1 - part[..., 0]) + lattice[(i + 1) % 64, (j + 1) % 64] * part[..., 0]
        total += (near * (1 - part[..., 1]) + far * part[..., 1]) / 2**octave
    return total / (2 - 2.0 ** (1 - octaves))


def solid(rng: np.random.Generator, pattern: str, colour: Colour, second: Colour) -> np.ndarray:
    """(CELLS, CELLS, CELLS, 3) float32 BGR: one tile of a cloth; its last axis in space is up.

    `stripes` run round the body, `checks` cross them, `blotches` are blots of the second colour, `denim` is grain,
    `smooth` has next to none, as skin.
    """
    if pattern not in PATTERNS:
        raise InputError("cloth: pattern", expected=f"one of {', '.join(PATTERNS)}", got=repr(pattern))
    first, other = np.array(colour, dtype=np.float64), np.array(second, dtype=np.float64)
    x, y, z = np.meshgrid(*[np.arange(CELLS) / CELLS] * 3, indexing="ij")
    share = np.zeros_like(x)
    if pattern == "stripes":
        share = ((z * 4) % 1.0 < 0.42).astype(float)
    elif pattern == "checks":
        share = 0.5 * ((z * 3) % 1.0 < 0.4) + 0.5 * (((x + y) * 3) % 1.0 < 0.4)
    elif pattern == "blotches":
        share = (_blots(rng) > 0.25).astype(float)
    tile = first + (other - first) * share[..., None]
    tile *= 1 + GRAIN.get(pattern, 0.05) * rng.standard_normal((CELLS, CELLS, CELLS, 1)) + 0.05 * _blots(rng)[..., None]
    return np.clip(tile, 0, 255).astype(np.float32)


def clothing(
    rng: np.random.Generator, outfit: dict[str, tuple[str, Colour, Colour, float]], labels: tuple[str, ...]
) -> Cloth:
    """Solid textures of every label: outfit[label] = (pattern, colour, second colour, tile size in metres)."""
    missing = [label for label in labels if label not in outfit]
    if missing:
        raise InputError("outfit", expected=f"an entry for each of {', '.join(labels)}", got=f"none for {missing[0]}")
    tiles = np.stack([solid(rng, *outfit[label][:3]) for label in labels])
    return Cloth(np.ascontiguousarray(tiles), np.array([outfit[label][3] for label in labels], dtype=np.float64))


def _blots(rng: np.random.Generator) -> np.ndarray:
    """(CELLS, CELLS, CELLS) smooth periodic noise in about [-1, 1]."""
    noise = np.fft.fftn(rng.standard_normal((CELLS, CELLS, CELLS)))
    frequency = np.fft.fftfreq(CELLS) * CELLS
    squared = frequency[:, None, None] ** 2 + frequency[:, None] ** 2 + frequency**2
    smooth = np.fft.ifftn(noise * np.exp(-squared / 12.0)).real
    return smooth / (2 * smooth.std())
