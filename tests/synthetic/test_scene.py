"""Scenes: repeatable, seen whole, with noise and masks that are what they claim."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from muybridge.cameras.model import Rig
from muybridge.errors import InputError
from muybridge.evaluation.names import JOINTS
from muybridge.synthetic.description import Person, Scene
from muybridge.synthetic.light import Lamp, Light, Switch
from muybridge.synthetic.motion import Motion
from muybridge.synthetic.occluders import Occluder
from muybridge.synthetic.outfits import OUTFITS, Garment
from muybridge.synthetic.rigs import looking_at
from muybridge.synthetic.room import Room, picture, relit
from muybridge.synthetic.scene import demo_scene, empty, render, shoot, silhouettes, truth
from muybridge.synthetic.sensor import Sensor
from muybridge.synthetic.stage import stage


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

    def test_silhouettes_are_its_masks(self):
        """The same layers laid over nothing: to the pixel, with a thing in the way too."""
        centre = truth(SCENE).joints[7].mean(axis=0)
        towards = SCENE.rig[0].position[:2] - centre[:2]
        place = centre[:2] + 0.8 * towards / np.linalg.norm(towards)
        hidden = replace(SCENE, occluders=(Occluder("box", (float(place[0]), float(place[1])), (0.4, 0.4, 0.7)),))
        for scene in (SCENE, hidden):
            for one, other in zip(silhouettes(scene, 7), render(scene, 7)[1], strict=True):
                assert one.dtype == bool and one.any()
                np.testing.assert_array_equal(one, other)
        assert silhouettes(hidden, 7)[0].sum() < 0.9 * silhouettes(SCENE, 7)[0].sum(), "the box hides nothing"

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
            render(replace(SCENE, person=replace(SCENE.person, outfit=OUTFITS["striped"][1:])), 0)

    def test_unknown_pattern(self):
        with pytest.raises(InputError, match="pattern"):
            outfit = (Garment("shirt", "tartan", (0, 0, 0)), *OUTFITS["striped"][1:])
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

    @pytest.mark.parametrize("floor", ["planks", "tiles", "carpet"])
    def test_colours_are_colours(self, floor):
        camera = looking_at("a", np.array([3.0, 0, 1.5]), np.zeros(3), focal=100, size=(80, 60))
        colours, _ = picture(Room(floor=floor), camera)
        assert np.isfinite(colours).all() and colours.min() >= 0 and colours.max() <= 255 and colours.std() > 8

    def test_lamps_elsewhere_light_another_corner(self):
        """The ratio is above 1 on the side of the lamps and below on the other."""
        camera = looking_at("a", np.array([0.0, -4.0, 2.0]), np.array([0, 0, 0.5]), focal=100, size=(160, 120))
        ratio = relit(Room(), camera, (2.5, 0.0))
        assert ratio[60, -10] > 1.02 and ratio[60, 10] < 0.98
        np.testing.assert_allclose(relit(Room(), camera, (0.0, 0.0)), 1.0)

    def test_unknown_floor(self):
        with pytest.raises(InputError, match="one of planks"):
            Room(floor="lava")


#: Nothing but the person moves or changes: what differs is what a test has changed.
STILL = replace(SCENE, noise=0.0, drift=0.0, rig=SCENE.rig.subset([0]))
FRAME = 40


def between(scene: Scene, share: float, size: tuple[float, float, float]) -> Occluder:
    """A box on the line from the first camera to the person's pelvis at FRAME, this share of the way, square to it."""
    camera, pelvis = scene.rig[0].position[:2], truth(scene).joints[FRAME, 0, :2]
    way = pelvis - camera
    place = camera + share * way
    return Occluder("box", (float(place[0]), float(place[1])), size, float(np.arctan2(way[1], way[0])))


class TestOccluders:
    def test_in_front_it_hides_the_person(self):
        """A wall from floor to ceiling half way: nothing of the person is seen, and the picture is the empty one."""
        wall = replace(STILL, shadow=0.0, occluders=(between(STILL, 0.5, (0.1, 3.0, 2.9)),))
        image, mask = (part[0] for part in render(wall, FRAME))
        assert not mask.any()
        assert np.array_equal(image, next(iter(empty(wall)))[0])

    def test_behind_it_hides_nothing(self):
        behind = replace(STILL, shadow=0.0, occluders=(between(STILL, 1.5, (0.1, 3.0, 2.9)),))
        _, masks = render(behind, FRAME)
        assert np.array_equal(masks[0], render(STILL, FRAME)[1][0])

    def test_a_counter_hides_the_legs_only(self):
        """Where the mask is lost the picture is the counter's; where it is kept it is what it was without."""
        counter = replace(STILL, shadow=0.0, occluders=(between(STILL, 0.6, (0.2, 1.5, 0.9)),))
        image, mask = (part[0] for part in render(counter, FRAME))
        free, whole = (part[0] for part in render(replace(STILL, shadow=0.0), FRAME))
        plate = next(iter(empty(counter)))[0]
        lost = whole & ~mask
        rows = np.flatnonzero(whole.any(axis=1))
        assert 0.1 < lost.sum() / whole.sum() < 0.9 and not (mask & ~whole).any()
        assert np.flatnonzero(lost.any(axis=1)).min() > rows[0] + 0.2 * len(rows)
        # At the two outlines a pixel is a mixture of all three.
        assert (np.abs(image[lost].astype(int) - plate[lost]).max(axis=-1) <= 1).mean() > 0.85
        assert (np.abs(image[mask].astype(int) - free[mask]).max(axis=-1) <= 1).mean() > 0.85

    def test_it_casts_a_shadow_into_the_empty_frames(self):
        thing = (between(STILL, 1.4, (0.4, 0.4, 1.0)),)
        dark, bright = (next(iter(empty(replace(STILL, shadow=s, occluders=thing))))[0] for s in (0.5, 0.0))
        change = dark.astype(int) - bright
        assert change.max() <= 0 and (change.min(axis=-1) < -15).sum() > 20

    def test_a_camera_inside(self):
        with pytest.raises(InputError, match="outside every occluder"):
            replace(STILL, occluders=(Occluder("box", tuple(STILL.rig[0].position[:2]), (1.0, 1.0, 2.9)),))


class TestOthers:
    def test_who_stands_in_front_hides_the_person(self):
        """The same motion nearer to the camera covers a part of the person, in the picture and in the mask."""
        way = truth(STILL).joints[FRAME, 0, :2] - STILL.rig[0].position[:2]
        place = STILL.rig[0].position[:2] + 0.6 * way + 0.12 * np.array([way[1], -way[0]]) / np.linalg.norm(way)
        other = Person("woman", Motion("wave", 3.0, 30.0, place=(float(place[0]), float(place[1]))), OUTFITS["green"])
        both = replace(STILL, shadow=0.0, others=(other,))
        image, mask = (part[0] for part in render(both, FRAME))
        free, whole = (part[0] for part in render(replace(STILL, shadow=0.0), FRAME))
        assert 0.1 < mask.sum() / whole.sum() < 0.8 and not (mask & ~whole).any()
        changed = np.abs(image.astype(int) - free).max(axis=-1) > 8
        # What is still the person has changed only along the two outlines, where a pixel is a mixture.
        inside = ~grown(~mask, 1)
        assert changed.sum() > 200 and inside.sum() > 20 and not (changed & inside).any()

    def test_who_stands_behind_hides_nothing(self):
        way = truth(STILL).joints[FRAME, 0, :2] - STILL.rig[0].position[:2]
        place = STILL.rig[0].position[:2] + 1.5 * way
        other = Person("woman", Motion("wave", 3.0, 30.0, place=(float(place[0]), float(place[1]))))
        assert np.array_equal(render(replace(STILL, others=(other,)), FRAME)[1][0], render(STILL, FRAME)[1][0])

    def test_the_truth_is_the_tracked_person(self):
        other = Person("woman", Motion("wave", 3.0, 30.0, place=(1.0, 1.0)))
        assert np.array_equal(truth(replace(STILL, others=(other,))).joints, truth(STILL).joints)

    def test_another_length(self):
        with pytest.raises(InputError, match="90 frames at 30 Hz"):
            replace(STILL, others=(Person("man", Motion("wave", 1.0)),))


def grown(mask: np.ndarray, by: int) -> np.ndarray:
    """The mask with all pixels no further than `by` rows and columns."""
    steps = range(-by, by + 1)
    return np.any([np.roll(mask, (dy, dx), (0, 1)) for dy in steps for dx in steps], axis=0)


def off_the_floor(scene: Scene, mask: np.ndarray) -> np.ndarray:
    """Walls, but for the person and the two pixels around: those may be partly the person, whose shading changes."""
    return ~grown(mask, 2) & np.isnan(stage(scene).floors[0][..., 0])


class TestLight:
    LAMP = Lamp((-0.4, 0.4, 0.82), gain=0.6)
    SWITCHED = replace(STILL, light=Light(Lamp(), (Switch(1.0, LAMP),)))

    def test_before_the_switch_nothing_has_changed(self):
        assert np.array_equal(render(self.SWITCHED, 29)[0][0], render(STILL, 29)[0][0])

    def test_after_it_the_room_has_the_lamps_gain(self):
        """Off the floor only the gain has changed: 0.6 times, within the rounding of both pictures."""
        image, mask = (part[0] for part in render(self.SWITCHED, 30))
        walls = off_the_floor(self.SWITCHED, mask)
        before = render(STILL, 30)[0][0]
        chosen = walls & (before.min(axis=-1) > 40)
        assert chosen.sum() > 3000
        assert np.abs(image[chosen] - 0.6 * before[chosen]).max() <= 0.5 + 0.6 * 0.5 + 1

    def test_the_shadow_moves(self):
        image, mask = (part[0] for part in render(self.SWITCHED, 30))
        free = render(replace(self.SWITCHED, shadow=0.0), 30)[0][0]
        old_image, old_free = render(STILL, 30)[0][0], render(replace(STILL, shadow=0.0), 30)[0][0]
        new = (free.astype(int) - image).max(axis=-1) > 12
        old = (old_free.astype(int) - old_image).max(axis=-1) > 20
        assert new.sum() > 50 and old.sum() > 50 and (new & old).sum() < 0.5 * min(new.sum(), old.sum())

    def test_the_exposure_makes_up_for_it(self):
        """Long after the switch a fully automatic exposure has the old brightness back: walls within rounding."""
        scene = replace(self.SWITCHED, sensor=Sensor(automatic=1.0, lag=0.1))
        image, mask = (part[0] for part in render(scene, 89))
        before = render(STILL, 89)[0][0]
        walls = off_the_floor(scene, mask)
        assert np.abs(image[walls].astype(int) - before[walls]).max() <= 2


class TestShutter:
    OPEN = replace(STILL, shadow=0.0, sensor=Sensor(shutter=1.0))

    def test_a_shutter_that_hardly_opens_is_none(self):
        """Eight single samples at four places of a pixel against four samples at once: the same places."""
        image, mask = (part[0] for part in render(replace(self.OPEN, sensor=Sensor(shutter=1e-6)), FRAME))
        sharp, whole = (part[0] for part in render(replace(STILL, shadow=0.0), FRAME))
        assert np.abs(image.astype(int) - sharp).max() <= 3 and (mask != whole).mean() < 0.001

    def test_the_person_is_smeared_along_the_motion(self):
        """More pixels are partly the person than without; none of the still room changes."""
        image, mask = (part[0] for part in render(self.OPEN, FRAME))
        sharp, whole = (part[0] for part in render(replace(STILL, shadow=0.0), FRAME))
        changed = np.abs(image.astype(int) - sharp).max(axis=-1) > 8
        assert changed.sum() > 100 and abs(mask.sum() / whole.sum() - 1) < 0.1
        rows, columns = np.nonzero(whole)
        far = np.ones_like(changed)
        far[max(rows.min() - 6, 0) : rows.max() + 7, max(columns.min() - 6, 0) : columns.max() + 7] = False
        assert not changed[far].any()

    def test_order_does_not_matter(self):
        first = render(self.OPEN, 7)[0][0]
        render(self.OPEN, 50)
        assert np.array_equal(first, render(self.OPEN, 7)[0][0])


def test_rolling_exposure_is_a_matter_of_rows():
    """Within a picture the ratio to the unexposed one changes from top to bottom, and by no more than the amplitude."""
    scene = replace(STILL, sensor=Sensor(exposure=0.2, readout=1.0))
    ratio = render(scene, FRAME)[0][0].astype(float) / np.maximum(render(STILL, FRAME)[0][0], 1)
    bright = render(STILL, FRAME)[0][0].min(axis=-1) > 60
    top, bottom = (np.median(ratio[rows][bright[rows]]) for rows in (slice(0, 30), slice(90, 120)))
    steady = replace(scene, sensor=Sensor(exposure=0.2))
    level = np.median((render(steady, FRAME)[0][0] / np.maximum(render(STILL, FRAME)[0][0], 1))[bright])
    assert (
        abs(top - bottom) > 0.002
        and abs(level - 1) <= 0.2
        and min(top, bottom) - 0.01 < level < max(top, bottom) + 0.01
    )


def test_visibility_is_only_counted_when_asked_for():
    assert shoot(STILL, 0)[0].visible.size == 0
    assert shoot(STILL, 0, visibility=True)[0].visible.shape == (15,)


def test_standing_motions_render():
    still = replace(SCENE, person=Person("woman", Motion("crouch", duration=0.5)))
    images, masks = render(still, 8)
    assert all(mask.sum() > 100 for mask in masks)
