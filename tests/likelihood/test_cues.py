"""Cues as the filters see them: their formulas, cameras that say nothing, and that the truth is where they peak."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge._kernels.bits import pack_rows
from muybridge.errors import InputError
from muybridge.likelihood.boundary import BoundaryCue, descriptors_of, largest_component
from muybridge.likelihood.colour import (
    ColourCue,
    ColourReference,
    colour_tables,
    fill_reference,
    measure_reference,
    mirrored_segments,
    update_reference,
)
from muybridge.likelihood.edges import BLUR, MARGIN, EdgeCue, edge_map, stack_maps
from muybridge.likelihood.fusion import Fusion, fuse
from muybridge.likelihood.silhouette import KINDS, SilhouetteCue
from reference import silhouette as slow
from reference.scene import camera, count, random_poses, rows, standing

SIZE = (96, 72)


@pytest.fixture(scope="module")
def scene():
    """A body at its true pose before two cameras, its masks, and pictures in which every segment has a colour of
    its own.
    """
    from reference.colour import label_image

    body, pose = standing()
    arrays, view = body.arrays, rows(camera(0.5), camera(2.0))
    palette = np.random.default_rng(10).integers(30, 256, (len(arrays.shaped) + 1, 3)).astype(np.uint8)
    palette[-1] = 0
    images = [palette[label_image(pose, arrays, v)] for v in view]
    masks = [slow.model_mask(pose, arrays, v) for v in view]
    return body, pose, view, masks, images


def _silhouette(scene, masks=None, **more):
    body, _, view, true_masks, _ = scene
    masks = true_masks if masks is None else masks
    return SilhouetteCue(
        body.arrays, view, np.array([pack_rows(m) for m in masks]), np.array([m.sum() for m in masks]), **more
    )


def _colour(scene, **more):
    body, pose, view, _, images = scene
    tables = colour_tables(images)
    return ColourCue(body.arrays, view, tables, measure_reference(body.arrays, view, tables, pose), **more)


def _boundary(scene, masks=None, **more):
    body, _, view, true_masks, _ = scene
    return BoundaryCue(body.arrays, view, SIZE, *descriptors_of(true_masks if masks is None else masks), **more)


def _edges(scene, **more):
    body, _, view, masks, images = scene
    return EdgeCue(body.arrays, view, stack_maps([edge_map(i, m) for i, m in zip(images, masks, strict=True)]), **more)


CUES = {"silhouette": _silhouette, "colour": _colour, "boundary": _boundary, "edges": _edges}


class TestValues:
    @pytest.mark.parametrize("name", CUES)
    def test_truth_beats_every_random_pose(self, scene, name):
        poses = np.vstack([scene[1], random_poses(np.random.default_rng(11), scene[1], count(60), 0.06, 0.2)])
        log_prob = CUES[name](scene).log_prob(poses)
        assert log_prob.shape == (len(poses),) and np.all(np.isfinite(log_prob)) and np.all(log_prob <= 0)
        assert np.argmax(log_prob) == 0

    @pytest.mark.parametrize("name", ["silhouette", "colour", "boundary"])
    def test_truth_itself_is_certain(self, scene, name):
        assert CUES[name](scene).log_prob(scene[1])[0] == pytest.approx(0.0, abs=1e-3)  # float32 roots: sqrt(1e-7 x 3)

    def test_kinds_are_their_formulas(self, scene):
        body, pose, view, masks, _ = scene
        poses = random_poses(np.random.default_rng(12), pose, 3)
        models = [[slow.model_mask(p, body.arrays, v) for v in view] for p in poses]
        iou = [np.mean([np.log(slow.iou(m, h)) for m, h in zip(masks, row, strict=True)]) for row in models]
        both = [-np.mean([slow.two_sided(m, h) for m, h in zip(masks, row, strict=True)]) for row in models]
        one = [-np.mean([np.sum(h & ~m) / h.sum() for m, h in zip(masks, row, strict=True)]) for row in models]
        for kind, expected in {"iou": iou, "two-sided": both, "one-sided": one}.items():
            np.testing.assert_allclose(_silhouette(scene, kind=kind).log_prob(poses), expected, rtol=1e-12)
        assert set(KINDS) == {"iou", "two-sided", "one-sided"}

    def test_beta_and_rho_multiply(self, scene):
        poses = random_poses(np.random.default_rng(13), scene[1], 4)
        np.testing.assert_allclose(
            _colour(scene, beta=3.0).log_prob(poses), 3.0 * _colour(scene, beta=1.0).log_prob(poses)
        )
        np.testing.assert_allclose(
            _boundary(scene, rho=0.02).log_prob(poses), 0.2 * _boundary(scene, rho=0.1).log_prob(poses)
        )

    def test_colour_tells_apart_what_silhouettes_cannot(self, scene):
        """Turned by half a turn the silhouette is nearly the same, left and right are swapped."""
        body, pose, view, masks, _ = scene
        turned = pose.copy()
        turned[5] += np.pi
        colour, silhouette = _colour(scene).log_prob(turned)[0], _silhouette(scene).log_prob(turned)[0]
        assert colour < -0.1 and silhouette > np.log(0.5)


class TestHiddenEdges:
    """Sedai 2013, IV-A2: points that are hidden by the body itself are discarded, (13) is the mean over the others."""

    def _of_forearm(self, side: str, angles: tuple[float, ...]) -> np.ndarray:
        """Log likelihoods with one elbow bent, seen from the left: the trunk and the left arm hide the right one."""
        body, pose = standing()
        poses = np.repeat(pose[None], len(angles), axis=0)
        poses[:, body.dof_names.index(f"{side}_elbow_flexion")] = angles
        maps = np.random.default_rng(20).random((1, *SIZE[::-1])).astype(np.float32)
        left = body.joints(pose)[body.joint_names.index("left_shoulder")]
        return EdgeCue(body.arrays, rows(camera(float(np.arctan2(left[1], left[0])))), maps).log_prob(poses)

    def test_a_hidden_arm_does_not_count(self):
        straight, bent = self._of_forearm("right", (0.0, 0.08))
        assert bent == pytest.approx(straight, abs=1e-12)

    def test_the_arm_before_the_trunk_does(self):
        """Inner edges count: it is what silhouettes cannot see."""
        straight, bent = self._of_forearm("left", (0.0, 0.08))
        assert abs(bent - straight) > 1e-4

    def test_an_arm_that_comes_out_from_behind_does(self):
        straight, bent = self._of_forearm("right", (0.0, 1.5))
        assert abs(bent - straight) > 1e-4


class TestCameras:
    @pytest.mark.parametrize("name", CUES)
    def test_weights_average(self, scene, name):
        poses = random_poses(np.random.default_rng(14), scene[1], 3)
        first, second = (CUES[name](scene, weights=w).log_prob(poses) for w in ((1.0, 0.0), (0.0, 5.0)))
        np.testing.assert_allclose(CUES[name](scene, weights=(3.0, 1.0)).log_prob(poses), 0.75 * first + 0.25 * second)

    def test_an_empty_mask_says_the_same_of_all_poses_or_nearly(self, scene):
        empty = [np.zeros(SIZE[::-1], bool)] * 2
        poses = random_poses(np.random.default_rng(15), scene[1], 3)
        assert np.ptp(_silhouette(scene, empty, kind="two-sided").log_prob(poses)) == 0
        assert np.ptp(_silhouette(scene, empty).log_prob(poses)) == 0
        assert np.all(_boundary(scene, empty).log_prob(poses) == 0)

    def test_a_body_behind_the_camera_is_finite_and_worst(self, scene):
        behind = scene[1] + np.r_[0.0, 0.0, 50.0, np.zeros(len(scene[1]) - 3)]
        for name in ("silhouette", "boundary", "edges"):
            here, gone = CUES[name](scene).log_prob(np.vstack([scene[1], behind]))
            assert np.isfinite(gone) and gone < here - 0.3, name


class TestFusion:
    def test_is_the_product_of_powers(self, scene):
        poses = random_poses(np.random.default_rng(16), scene[1], 5)
        cues = [CUES[n](scene) for n in ("silhouette", "colour", "boundary")]
        expected = sum(w * c.log_prob(poses) for w, c in zip((0.5, 0.2, 0.3), cues, strict=True))
        np.testing.assert_allclose(fuse(*cues, mu=0.5, nu=0.2, sharpness=7.0).log_prob(poses), 7.0 * expected)

    def test_one_pass_is_four(self, scene):
        poses = random_poses(np.random.default_rng(17), scene[1], 5)
        cues = tuple(make(scene) for make in CUES.values())
        weights = (1.0, 0.5, 0.0, 2.0)
        expected = sum(w * c.log_prob(poses) for w, c in zip(weights, cues, strict=True))
        np.testing.assert_allclose(Fusion(cues, weights).log_prob(poses), expected)

    def test_a_cue_switched_off_is_not_asked(self, scene):
        class Unasked:
            def log_prob(self, poses):
                raise AssertionError

        assert Fusion((_silhouette(scene), Unasked()), (1.0, 0.0)).log_prob(scene[1]).shape == (1,)

    def test_different_cameras_are_measured_apart(self, scene):
        body, pose, view, masks, _ = scene
        other = SilhouetteCue(body.arrays, view[:1], pack_rows(masks[0])[None], np.array([masks[0].sum()]))
        both = Fusion((other, _boundary(scene)), (1.0, 1.0)).log_prob(pose)
        np.testing.assert_allclose(both, other.log_prob(pose) + _boundary(scene).log_prob(pose))


class TestReference:
    def test_gaps_are_filled_by_the_other_side_then_by_other_cameras(self):
        names = ("torso", "left_arm", "right_arm", "head")
        assert mirrored_segments(names).tolist() == [0, 2, 1, 3]
        rng = np.random.default_rng(18)
        histograms = rng.dirichlet(np.ones(10), (2, 4, 3))
        known = np.array([[True, True, False, False], [True, False, False, True]])
        filled = fill_reference(ColourReference(histograms, known), mirrored_segments(names))
        np.testing.assert_array_equal(filled.histograms[0, 2], histograms[0, 1])  # the twin, same camera
        np.testing.assert_array_equal(filled.histograms[0, 3], histograms[1, 3])  # the same, other camera
        np.testing.assert_array_equal(filled.histograms[1, 2], histograms[0, 1])  # the twin, other camera
        assert filled.known.all()

    def test_update_moves_by_the_rate_where_seen(self):
        rng = np.random.default_rng(19)
        old = ColourReference(rng.dirichlet(np.ones(10), (1, 3, 3)), np.array([[True, True, False]]))
        new = ColourReference(rng.dirichlet(np.ones(10), (1, 3, 3)), np.array([[True, False, True]]))
        after = update_reference(old, new, 0.25)
        np.testing.assert_allclose(after.histograms[0, 0], 0.25 * new.histograms[0, 0] + 0.75 * old.histograms[0, 0])
        np.testing.assert_array_equal(after.histograms[0, 1], old.histograms[0, 1])
        np.testing.assert_array_equal(after.histograms[0, 2], new.histograms[0, 2])

    def test_histograms_sum_to_one_where_known(self, scene):
        reference = _colour(scene).reference
        np.testing.assert_allclose(reference.histograms[reference.known].sum(axis=-1), 1.0)


class TestPictures:
    def test_edge_map_is_one_along_a_step_and_nothing_off_the_mask(self):
        image = np.zeros((60, 80, 3), np.uint8)
        image[:, 40:] = 200
        mask = np.zeros((60, 80), bool)
        mask[:30] = True
        edges = edge_map(image, mask)
        assert edges[10, 39:41].min() > 0.9 and edges[45].max() < 0.01 and edges[10, 20] == 0.0

    def test_edges_of_the_room_do_not_count(self):
        """A door beside the person: what is farther from the mask than the margin and the blur's reach, 3 sd, is 0."""
        image = np.zeros((60, 120, 3), np.uint8)
        image[:, 20:40] = image[:, 100:] = 200
        mask = np.zeros((60, 120), bool)
        mask[:, 20:40] = True
        edges = edge_map(image, mask)
        assert edges[30, 19:21].min() > 0.9 and edges[30, 39:41].min() > 0.9
        assert edges[:, 40 + MARGIN + int(3 * BLUR) + 1 :].max() < 0.01
        assert edge_map(image, np.ones_like(mask))[30, 99:101].min() > 0.9, "the door is an edge where it may be one"

    def test_largest_component_drops_specks(self):
        mask = np.zeros((20, 20), bool)
        mask[0, 0] = mask[5:10, 5:10] = True
        assert largest_component(mask).sum() == 25


class TestErrors:
    @pytest.mark.parametrize(
        "more", [{"kind": "other"}, {"weights": (1.0,)}, {"weights": (-1.0, 2.0)}, {"weights": (0.0, 0.0)}]
    )
    def test_bad_silhouette_settings(self, scene, more):
        with pytest.raises(InputError):
            _silhouette(scene, **more)

    def test_bad_fusions(self, scene):
        cue = _silhouette(scene)
        for bad in (
            lambda: Fusion((cue,), ()),
            lambda: Fusion((cue,), (-1.0,)),
            lambda: Fusion((cue,), (0.0,)),
            lambda: fuse(cue, cue, cue, mu=0.8, nu=0.4),
            lambda: Fusion((cue,), (1.0,), 0.0),
        ):
            with pytest.raises(InputError):
                bad()

    def test_bad_pictures(self):
        with pytest.raises(InputError, match="uint8"):
            colour_tables([np.zeros((4, 4), np.uint8)])
        with pytest.raises(InputError, match="reduce"):
            colour_tables([np.zeros((1024, 4, 3), np.uint8)])
