"""Scenes: repeatable, seen whole, with noise and masks that are what they claim."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from muybridge.cameras.model import Rig
from muybridge.errors import InputError
from muybridge.evaluation.names import JOINTS
from muybridge.synthetic.motion import Motion
from muybridge.synthetic.rigs import looking_at
from muybridge.synthetic.room import Room, picture
from muybridge.synthetic.scene import (
    DEMO_OUTFIT,
    Garment,
    Person,
    Scene,
    demo_scene,
    empty,
    render,
    stage,
    truth,
)


def small(scene: Scene, factor: float = 0.25) -> Scene:
    """The same scene in smaller pictures, so that tests are quick."""
    return replace(scene, rig=Rig(tuple(camera.scaled(factor) for camera in scene.rig)))


SCENE = small(demo_scene(3))


class TestDemo:
    def test_size(self):
        scene = demo_scene(0)
        assert scene.frame_count == 90 and len(scene.rig) == 3 and scene.rig[0].size == (640, 480)

    @pytest.mark.parametrize("seed", [0, 1, 2])
    def test_everything_is_in_view(self, seed):
        scene = demo_scene(seed)
        for camera in scene.rig:
            pixels = camera.world_to_pixel(truth(small(scene)).joints)
            assert (pixels > 20).all() and (pixels < np.array(camera.size) - 20).all()

    def test_seeds_differ(self):
        assert demo_scene(0).rig != demo_scene(1).rig and demo_scene(0) == demo_scene(0)

    def test_too_long_to_stay_in_view(self):
        with pytest.raises(InputError, match="short enough"):
            demo_scene(0, duration=30.0, rate=5.0)


class TestRender:
    def test_shapes(self):
        images, masks = render(SCENE, 0)
        assert [image.shape for image in images] == [(120, 160, 3)] * 3 and images[0].dtype == np.uint8
        assert [mask.shape for mask in masks] == [(120, 160)] * 3 and masks[0].dtype == bool

    def test_order_does_not_matter(self):
        first = render(SCENE, 7)[0]
        render(SCENE, 50)
        stage.cache_clear()
        assert all(np.array_equal(a, b) for a, b in zip(first, render(SCENE, 7)[0], strict=True))

    @pytest.mark.parametrize("frame", [-1, 90])
    def test_no_such_frame(self, frame):
        with pytest.raises(InputError, match="expected 0 to 89"):
            render(SCENE, frame)

    def test_joints_lie_in_the_mask(self):
        """Centres of trunk and legs are far from the outline; at a quarter of the size a wrist is two pixels wide."""
        names = ("pelvis", "left_hip", "right_hip", "left_knee", "right_knee", "left_shoulder", "right_shoulder")
        chosen = [JOINTS.index(name) for name in names]
        for frame in (0, 30, 60, 89):
            _, masks = render(SCENE, frame)
            for camera, mask in zip(SCENE.rig, masks, strict=True):
                x, y = np.round(camera.world_to_pixel(truth(SCENE).joints[frame, chosen])).astype(int).T
                assert mask[y, x].all()

    def test_the_mask_is_as_tall_as_the_person(self):
        images, masks = render(SCENE, 45)
        for camera, mask in zip(SCENE.rig, masks, strict=True):
            head = camera.world_to_pixel(truth(SCENE).joints[45, JOINTS.index("head_top")])
            # Half a pixel of rasterisation; in a camera that looks down the top vertex is not the outline's top: 1 px.
            assert abs(np.flatnonzero(mask.any(axis=1))[0] - head[1]) < 2.0

    def test_the_person_differs_from_the_room(self):
        images, masks = render(SCENE, 20)
        for image, mask, plate in zip(images, masks, stage(SCENE).plates, strict=True):
            change = np.abs(image.astype(float) - plate).max(axis=-1)
            assert np.median(change[mask]) > 30
            # Outside there are noise, the light's drift (1.5 %) and the shadow, which covers a small part.
            assert np.median(change[~mask]) < 10

    def test_the_shadow_darkens_the_floor(self):
        dark, bright = replace(SCENE, noise=0.0, drift=0.0), replace(SCENE, noise=0.0, drift=0.0, shadow=0.0)
        images, masks = render(dark, 20)
        others, _ = render(bright, 20)
        for image, other, mask in zip(images, others, masks, strict=True):
            change = image.astype(int) - other
            assert change.max() <= 0 and change[~mask].min() < -20

    def test_an_outfit_must_be_whole(self):
        with pytest.raises(InputError, match="outfit: expected an entry for each of .*none for shirt"):
            render(replace(SCENE, person=replace(SCENE.person, outfit=DEMO_OUTFIT[1:])), 0)

    def test_unknown_pattern(self):
        with pytest.raises(InputError, match="pattern"):
            outfit = (Garment("shirt", "tartan", (0, 0, 0)), *DEMO_OUTFIT[1:])
            render(replace(SCENE, person=replace(SCENE.person, outfit=outfit)), 0)


class TestEmpty:
    def test_noise_has_the_standard_deviation_asked_for(self):
        """At 128 the deviation is noise * sqrt(.75 + .25) = noise; 8-bit rounding adds 1/12 of variance."""
        flat = replace(SCENE, noise=4.0)
        frames = np.array([pictures[0] for pictures in empty(flat, 12)], dtype=float)
        plate = stage(flat).plates[0]
        chosen = (plate > 118) & (plate < 138)
        measured = frames.std(axis=0, ddof=1)[chosen]
        # The mean of the variance over n values with 11 degrees of freedom each has a relative error of sqrt(2 / 11 n).
        count = chosen.sum()
        expected = 16.0 + 1 / 12
        assert count > 1000
        assert abs((measured**2).mean() / expected - 1) < 0.02 + 4 * np.sqrt(2 / (11 * count))

    def test_frames_differ_from_each_other_and_the_clip(self):
        first, second = (pictures[0] for pictures in empty(SCENE, 2))
        assert not np.array_equal(first, second)
        assert np.abs(np.mean(first.astype(float) - second)) < 0.5


class TestRoom:
    def test_floor_places(self):
        """The place that a floor pixel claims projects back into that pixel."""
        camera = looking_at("a", np.array([3.0, -2.0, 1.8]), np.array([0, 0, 0.5]), focal=150, size=(160, 120),
                            distortion=np.array([-0.15, 0.03, 0, 0, 0]))  # fmt: skip
        colours, floor = picture(Room(), camera)
        rows, columns = np.nonzero(np.isfinite(floor[..., 0]))
        assert len(rows) > 3000 and colours.shape == (120, 160, 3)
        places = np.concatenate([floor[rows, columns], np.zeros((len(rows), 1))], axis=1)
        np.testing.assert_allclose(camera.world_to_pixel(places), np.stack([columns, rows], axis=1), atol=0.01)

    def test_the_same_from_every_camera(self):
        """Two cameras see the same floor, but for grain below a pixel; 400 unrelated places: |r| < 4 / sqrt(400)."""
        cameras = [
            looking_at("a", np.array([2.0, y, 2.2]), np.zeros(3), focal=300, size=(320, 240)) for y in (-0.4, 0.4)
        ]
        first, second = (picture(Room(), camera) for camera in cameras)
        points = np.random.default_rng(2).uniform(-0.4, 0.4, (400, 3)) * (1, 1, 0)
        seen = []
        for camera, (colours, _) in zip(cameras, (first, second), strict=True):
            x, y = np.round(camera.world_to_pixel(points)).astype(int).T
            seen.append(colours[y, x, 1])
        assert np.corrcoef(seen)[0, 1] > 0.5
        assert abs(np.corrcoef(seen[0], np.roll(seen[1], 7))[0, 1]) < 0.2

    @pytest.mark.parametrize("floor", ["planks", "tiles"])
    def test_colours_are_colours(self, floor):
        camera = looking_at("a", np.array([3.0, 0, 1.5]), np.zeros(3), focal=100, size=(80, 60))
        colours, _ = picture(Room(floor=floor), camera)
        assert np.isfinite(colours).all() and colours.min() >= 0 and colours.max() <= 255 and colours.std() > 8


def test_standing_motions_render():
    still = replace(SCENE, person=Person("woman", Motion("crouch", duration=0.5)))
    images, masks = render(still, 8)
    assert all(mask.sum() > 100 for mask in masks)
