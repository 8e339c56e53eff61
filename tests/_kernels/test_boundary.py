"""Tracing and transform on shapes whose border is known, and on random blobs against a textbook and OpenCV."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from muybridge._kernels.bits import pack_rows
from muybridge._kernels.boundary import SIDE, fourier_descriptor, start_pixel, trace_border
from muybridge._kernels.draw import transpose_rows
from reference import boundary as slow
from reference.scene import count


def _traced(mask):
    canvas = transpose_rows(pack_rows(mask)[None])[0]
    xs, ys = np.zeros(4 * mask.size, np.int32), np.zeros(4 * mask.size, np.int32)
    number, area = trace_border(canvas, *start_pixel(canvas, 0, mask.shape[0]), xs, ys)
    return list(zip(xs[:number].tolist(), ys[:number].tolist(), strict=True)), area


def _blob(rng, height=60, width=150):
    noise = cv2.GaussianBlur(rng.normal(size=(height, width)), (0, 0), rng.uniform(1.0, 5.0))
    count, labels = cv2.connectedComponents((noise > 0).astype(np.uint8), connectivity=8)
    return labels == 1 + np.argmax([np.sum(labels == i) for i in range(1, count)])


@pytest.mark.parametrize("seed", range(count(24)))
def test_border_of_blobs_is_the_textbooks_and_opencvs(seed):
    mask = _blob(np.random.default_rng(seed))
    border, area = _traced(mask)
    assert border == slow.trace(mask)
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    longest = max(contours, key=len)[:, 0]
    assert sorted(border) == sorted(map(tuple, longest.tolist()))
    assert area == pytest.approx(2 * cv2.contourArea(longest))
    erosion = slow.border_pixels(mask)
    assert all(erosion[y, x] for x, y in border)  # (5.8); the erosion also leaves the rims of holes


@pytest.mark.parametrize("offset", [0, 1, 62, 63, 64, 126])
def test_a_rectangle_has_its_corners_and_a_closed_form_area(offset):
    mask = np.zeros((12, 192), bool)
    mask[2:9, offset : offset + 5] = True
    border, area = _traced(mask)
    assert border[0] == (offset, 2) and border[1] == (offset + 1, 2)  # clockwise from the top left corner
    assert len(border) == 2 * (6 + 4) and area == 2 * 6 * 4


def test_one_pixel_and_a_line():
    mask = np.zeros((5, 70), bool)
    mask[2, 3] = True
    assert _traced(mask)[0] == [(3, 2)]
    mask[2, 3:7] = True
    assert _traced(mask)[0] == [(3, 2), (4, 2), (5, 2), (6, 2), (5, 2), (4, 2)]


def test_descriptor_is_the_transform():
    rng = np.random.default_rng(9)
    curve = rng.normal(0, 100, 256) + 1j * rng.normal(0, 100, 256)
    real, imaginary = curve.real.reshape(SIDE, SIDE).copy(), curve.imag.reshape(SIDE, SIDE).copy()
    fourier_descriptor(real, imaginary, np.empty((SIDE, SIDE)), np.empty((SIDE, SIDE)))
    np.testing.assert_allclose((real + 1j * imaginary).ravel(), np.fft.fft(curve) / 256, atol=1e-12 * 100)
