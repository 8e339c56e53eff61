"""Colours of pixels and whose they are, against visiting every pixel in plain Python."""

from __future__ import annotations

import numpy as np

from muybridge._kernels.appearance import (
    CHROMA,
    CODES,
    LUMA,
    band_scores,
    fill_band_sums,
    fill_claims,
    fill_codes,
)

BANDS = 4


def test_codes_number_all_bins() -> None:
    """Y in eighths of 256; Cr and Cb in sixteen bins of 8 from 64 on, what lies beyond in the first and the last."""
    picture = np.array([[[0, 0, 0], [31, 71, 64], [32, 72, 64], [255, 255, 255], [128, 128, 136]]], np.uint8)
    codes = np.empty((1, 5), np.int16)
    fill_codes(picture, codes)
    assert codes.tolist() == [[0, 0, CHROMA * CHROMA + CHROMA, CODES - 1, (4 * CHROMA + 8) * CHROMA + 9]]
    assert CODES == LUMA * CHROMA * CHROMA


def cell(at: float, centre: float, size: float, cells: int) -> int:
    return int(np.floor(((at - centre) / size + 0.5) * cells))


def test_claims_are_bayes_rule() -> None:
    """float32 of numbers up to 1: 1e-6."""
    rng = np.random.default_rng(1)
    codes = rng.integers(0, CODES, (20, 15)).astype(np.int16)
    near, far = np.array([8.0, 14.0, 8.0, 16.0]), np.array([11.0, 9.0, 6.0, 14.0])
    densities = rng.uniform(0.1, 1, (2, BANDS, CODES)).astype(np.float32)
    share = rng.uniform(0.1, 0.9, (5, 3))
    out = np.empty((20, 15), np.float32)
    fill_claims(codes, 2, 3, near, far, densities[0], densities[1], share, 0.05, out)

    def cover(y: int, x: int, box: np.ndarray) -> float:
        row, column = cell(y, box[1], box[3], 5), cell(x, box[0], box[2], 3)
        return share[row, column] if 0 <= row < 5 and 0 <= column < 3 else 0.05

    for i in range(20):
        for j in range(15):
            y, x = i + 3, j + 2
            a, b = (int(np.clip(cell(y, box[1], box[3], BANDS), 0, BANDS - 1)) for box in (near, far))
            mine = cover(y, x, near) * densities[0, a, codes[i, j]]
            others = (1 - cover(y, x, near)) * cover(y, x, far) * densities[1, b, codes[i, j]]
            assert abs(out[i, j] - mine / (mine + others)) < 1e-6


def test_band_scores_visit_every_pixel_in_its_band() -> None:
    """Sums of some hundred numbers of order 1 in another order: 1e-9."""
    rng = np.random.default_rng(2)
    codes = rng.integers(0, CODES, (30, 25)).astype(np.int16)
    share = rng.uniform(-0.5, 1, (30, 25)).clip(0).astype(np.float32)
    ratios = rng.normal(size=(CODES, BANDS)).astype(np.float32)
    table = np.empty((31, 26, BANDS))
    fill_band_sums(codes, share, ratios, table)
    states = np.column_stack([rng.uniform(0, 30, 12), rng.uniform(0, 35, 12), rng.uniform(3, 30, (12, 2))])
    out = np.empty(12)
    band_scores(table, 3, 4, states, out)
    for state, score in zip(states, out, strict=True):
        expected = 0.0
        for i in range(30):
            for j in range(25):
                band = cell(i + 4, state[1], state[3], BANDS)
                if 0 <= band < BANDS and cell(j + 3, state[0], state[2], 1) == 0:
                    expected += float(share[i, j]) * float(ratios[codes[i, j], band])
        assert abs(score - expected) < 1e-9
