"""Every cue's kernel against its literal twin: random poses, at the picture's edge, behind the camera, nothing
there.
"""

from __future__ import annotations

import numpy as np
import pytest

from muybridge._kernels import fused
from muybridge._kernels.bits import pack_rows
from muybridge._kernels.silhouette import silhouette_counts
from muybridge.likelihood._measure import BoundaryInput, ColourInput, measure_cues
from muybridge.likelihood.boundary import descriptors_of
from muybridge.likelihood.colour import ColourReference, colour_tables
from reference import boundary as slow_boundary
from reference import colour as slow_colour
from reference import edges as slow_edges
from reference.scene import camera, count, random_poses, rows, standing
from reference.silhouette import model_mask

PLACES = {"middle": (0.0, 0.0), "edge": (0.0, 1.2), "corner": (0.9, 1.2), "outside": (0.0, 9.0), "behind": (9.0, 0.0)}


def _scene(place, poses=8, name="person"):
    body, pose = standing(name)
    pose = pose.copy()
    pose[0], pose[1] = pose[0] + PLACES[place][0], pose[1] + PLACES[place][1]
    view = rows(camera(0.0), camera(0.4, (80, 64)))
    return body, random_poses(np.random.default_rng(4), pose, count(poses)), view


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("name", ["person", "bodytrack"])
def test_counts_are_those_of_the_pixels(place, name):
    body, poses, view = _scene(place, name=name)
    masks = np.random.default_rng(5).random((2, 72, 96)) < 0.5
    counts = silhouette_counts(poses, *body.arrays, view, np.array([pack_rows(m) for m in masks]))
    size = [(int(r[24]), int(r[23])) for r in view]
    for n, pose in enumerate(poses):
        for c in range(2):
            model = model_mask(pose, body.arrays, view[c])
            observed = masks[c][: size[c][0], : size[c][1]]
            assert tuple(counts[n, c]) == (model.sum(), (model & observed).sum())


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("by_area", [True, False])
def test_colour_is_that_of_the_painted_picture(place, by_area):
    body, poses, view = _scene(place, 4)
    rng = np.random.default_rng(6)
    images = [rng.integers(0, 256, (72, 96, 3), dtype=np.uint8), rng.integers(0, 120, (64, 80, 3), dtype=np.uint8)]
    histograms = rng.dirichlet(np.ones(10), (2, len(body.arrays.shaped), 3))
    reference = ColourReference(histograms, np.ones(histograms.shape[:2], bool))
    wanted = ColourInput(colour_tables(images), reference.roots, reference.known, by_area)
    results = measure_cues(poses, body.arrays, view, (96, 72), colour=wanted)
    for n, pose in enumerate(poses):
        for c in range(2):
            counts = slow_colour.histograms(
                slow_colour.label_image(pose, body.arrays, view[c]), images[c], histograms.shape[1]
            )
            expected = slow_colour.distance(histograms[c], counts, by_area)
            # the reference's roots are float32: 16 segments x 3 sums of 10 products, each sqrt doubles at most near
            # 0.05
            assert results[n, c, fused.COLOUR] == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("place", PLACES)
def test_boundary_is_that_of_the_traced_picture(place):
    body, poses, view = _scene(place, 4)
    observed = model_mask(standing()[1], body.arrays, view[0])
    descriptors, _ = descriptors_of([observed, observed[:64, :80]])
    results = measure_cues(poses, body.arrays, view, (96, 72), boundary=BoundaryInput(descriptors, 100))
    reference = (descriptors[:, 0] + 1j * descriptors[:, 1]).reshape(2, 256)
    for n, pose in enumerate(poses):
        for c in range(2):
            model = model_mask(pose, body.arrays, view[c])
            if not model.any():
                assert results[n, c, fused.BOUNDARY] == np.inf
                continue
            border = slow_boundary.largest_border(model)
            expected = slow_boundary.distance(slow_boundary.descriptor(border), reference[c], 100)
            assert results[n, c, fused.BOUNDARY] == pytest.approx(expected, abs=1e-8)  # 256 terms of 100 pixels


@pytest.mark.parametrize("place", PLACES)
def test_edges_are_those_looked_up_one_by_one(place):
    body, poses, view = _scene(place, 4)
    maps = np.random.default_rng(7).random((2, 72, 96)).astype(np.float32)
    results = measure_cues(poses, body.arrays, view, (96, 72), edge_maps=maps)
    for n, pose in enumerate(poses):
        for c in range(2):
            seen, total = slow_edges.cost(pose, body.arrays, view[c], maps[c])
            assert results[n, c, fused.EDGE_POINTS] == seen
            assert results[n, c, fused.EDGE_COST] == pytest.approx(total, abs=1e-5)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e300])
def test_a_pose_that_is_no_pose_is_not_drawn(value):
    body, poses, view = _scene("middle", 8)
    poses[0, 0], poses[1, 2], poses[1, 3] = value, value, value
    masks = np.ones((2, 72, 96), bool)
    counts = silhouette_counts(poses, *body.arrays, view, np.array([pack_rows(m) for m in masks]))
    assert not counts[:2].any() and (len(poses) == 2 or counts[2:].all())
    boundary = BoundaryInput(np.zeros((2, 2, 16, 16)), 100)
    assert np.all(measure_cues(poses, body.arrays, view, (96, 72), boundary=boundary)[:2, :, fused.BOUNDARY] == np.inf)


def test_all_at_once_is_each_alone_and_threads_change_nothing():
    import numba

    body, poses, view = _scene("middle", 40)
    rng = np.random.default_rng(8)
    histograms = rng.dirichlet(np.ones(10), (2, len(body.arrays.shaped), 3))
    reference = ColourReference(histograms, np.ones(histograms.shape[:2], bool))
    colour = ColourInput(
        colour_tables([rng.integers(0, 256, (72, 96, 3), dtype=np.uint8)] * 2), reference.roots, reference.known, True
    )
    boundary = BoundaryInput(rng.normal(size=(2, 2, 16, 16)), 100)
    maps = rng.random((2, 72, 96)).astype(np.float32)
    cues = {"colour": colour, "boundary": boundary, "edge_maps": maps}
    together = measure_cues(poses, body.arrays, view, (96, 72), **cues)
    before = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        np.testing.assert_array_equal(together, measure_cues(poses, body.arrays, view, (96, 72), **cues))
    finally:
        numba.set_num_threads(before)
    for name, columns in (("colour", [2]), ("boundary", [3]), ("edge_maps", [4, 5])):
        alone = measure_cues(poses, body.arrays, view, (96, 72), **{name: cues[name]})
        np.testing.assert_array_equal(alone[..., columns], together[..., columns])
