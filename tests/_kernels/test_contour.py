"""Residuals and derivatives of the contour against small steps."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from muybridge.likelihood.contour import Borders, contour_rows, no_borders
from muybridge.likelihood.pictures import FULL
from reference import contour as slow
from reference.scene import SLOW, WIDE, camera, count, random_poses, rows, standing
from reference.silhouette import model_mask

DISTANCE, WIDEST = 4.0, 0.2  # metres: of the camera, of a half axis


@pytest.fixture(scope="module", params=[(0.0,) * 5, WIDE], ids=["straight", "distorted"])
def found(request):
    body, pose = standing()
    view = rows(camera(0.4, (320, 240), DISTANCE, distortion=request.param))
    rng = np.random.default_rng(20)
    mask = model_mask(random_poses(rng, pose, 1, 0.02, 0.1)[0], body.arrays, view[0])[None]
    nothing = Borders(np.zeros((1, 1, 2)), np.zeros(1, np.int64))
    residuals = contour_rows(body, view, mask.astype(np.uint8) * np.uint8(FULL), nothing, pose, 0.1)
    chosen = rng.permutation(len(residuals.distance))[: count(60)]
    return body, pose, view, mask[0], residuals, chosen


def test_distances_are_those_walked(found):
    """Steps of half a pixel, then linear between two looks at a bilinear picture: a quarter of a step at most."""
    _, _, _, mask, residuals, chosen = found
    assert len(chosen) >= 15
    walked = [slow.distance(mask, residuals.pixel[i], residuals.normal[i], 40.0) for i in chosen]
    np.testing.assert_allclose(residuals.distance[chosen] / residuals.metres[chosen], walked, atol=0.125 + 0.01)


def test_slopes_are_differences(found):
    """The kernel differentiates the projection at the surface, the outline's ellipse at its centre.

    The two differ by the share of the depth that lies between, WIDEST / DISTANCE, twice: place and size; a lever is 1
    m long.
    """
    body, pose, view, _, residuals, chosen = found
    per_metre = 1.0 / residuals.metres
    for i in chosen[: count(24)]:
        for dof in range(i % 8 if SLOW else 0, len(pose), 8 if SLOW else 1):
            moved = slow.slope(
                pose, body.arrays, view[0], residuals.segment[i], residuals.along[i], residuals.normal[i], dof
            )
            bound = 2.0 * WIDEST / DISTANCE * per_metre[i]
            assert abs(residuals.slopes[i, dof] * per_metre[i] - moved) < bound, (i, dof)


def test_slopes_of_the_other_sign_would_be_noticed(found):
    """The negative control of the bound above."""
    body, pose, view, _, residuals, chosen = found
    wrong = 0
    for i in chosen[: count(24)]:
        for dof in range(3):
            moved = slow.slope(
                pose, body.arrays, view[0], residuals.segment[i], residuals.along[i], residuals.normal[i], dof
            )
            wrong += abs(-residuals.slopes[i, dof] - moved * residuals.metres[i]) > 2.0 * WIDEST / DISTANCE
    assert wrong > 0


def test_what_a_wide_trunk_covers_is_explained():
    """Here a trunk is over 100 pixels wide on either side of its axis. Points inside the own mask ask for nothing."""
    body, pose = standing()
    view = rows(camera(0.4, (2560, 1920), DISTANCE))
    mask = model_mask(pose, body.arrays, view[0]).astype(np.uint8)
    inside = np.argwhere(cv2.erode(mask, np.ones((5, 5), np.uint8)))[::97, ::-1].astype(float)
    points = Borders(inside[None], np.array([len(inside)]))
    masks = (mask * np.uint8(FULL))[None]
    with_points = contour_rows(body, view, masks, points, pose, 0.2)
    without = contour_rows(body, view, masks, no_borders(1), pose, 0.2)
    assert len(inside) > 1000 and len(with_points.distance) == len(without.distance) > 0
