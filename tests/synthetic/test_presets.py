"""Presets: repeatable, in view, different from each other in what they promise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from muybridge.cameras.model import Rig
from muybridge.errors import InputError
from muybridge.evaluation.names import JOINTS
from muybridge.synthetic.description import Scene
from muybridge.synthetic.motion import Motion, perform
from muybridge.synthetic.occluders import hides
from muybridge.synthetic.outfits import OUTFITS
from muybridge.synthetic.placing import apart, clear_of
from muybridge.synthetic.presets import BLUESCREEN_OUTFITS, PRESETS, preset_scene
from muybridge.synthetic.scene import render


def joints_of(scene: Scene, index: int = 0) -> np.ndarray:
    person = scene.people[index]
    return perform(person.load(), person.motion).joints


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("seed", range(4))
class TestEvery:
    def test_everything_is_in_view(self, preset: str, seed: int) -> None:
        scene = preset_scene(preset, seed=seed)
        assert len(scene.rig) == 3 and scene.frame_count == PRESETS[preset].rate * 3
        for camera in scene.rig:
            pixels = camera.world_to_pixel(joints_of(scene))
            assert camera.size == (640, 480) and ((pixels > 20) & (pixels < np.array([620, 460]))).all()
            assert (np.abs(camera.position[:2]) < scene.room.half_width).all()

    def test_the_same_again(self, preset: str, seed: int) -> None:
        scene = preset_scene(preset, seed=seed)
        assert scene == preset_scene(preset, seed=seed) != preset_scene(preset, seed=seed + 100)


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("kind", ["walk", "crouch"])
def test_the_side_view(preset: str, kind: str) -> None:
    """One camera, square to the way within the swing of the pelvis over 3 s, and the person fills what room there is.

    The camera looks at the middle of the joints; that differs from the way's middle by half an arm at most, 0.5 m at
    4.4 m: 6.5 degrees.
    """
    scene = preset_scene(preset, seed=2, motion=kind, view="side")
    joints, camera = joints_of(scene), scene.rig[0]
    assert len(scene.rig) == 1
    pixels = camera.world_to_pixel(joints)
    assert ((pixels > 20) & (pixels < np.array([620, 460]))).all()
    assert (np.ptp(pixels, axis=(0, 1)) > [640 - 2 * 80, 480 - 2 * 80]).any()
    heading = scene.person.motion.heading
    assert abs(camera.rotation[2] @ [np.cos(heading), np.sin(heading), 0.0]) < np.sin(np.radians(6.5))


def test_humaneva_stays_on_its_floor() -> None:
    for seed in range(6):
        scene = preset_scene("humaneva", seed=seed)
        assert (np.ptp(joints_of(scene)[:, JOINTS.index("pelvis"), :2], axis=0) <= [3.0, 2.0]).all()


def test_a_blue_screen_is_blue_and_nobody_in_front_is() -> None:
    scene = preset_scene("studio", seed=1, room="bluescreen")
    wall = np.array(scene.room.wall)
    assert wall[0] > 2 * wall[1] and any(set(OUTFITS[name]) <= set(scene.person.outfit) for name in BLUESCREEN_OUTFITS)
    for garment in scene.person.outfit:
        assert garment.colour[0] < 1.5 * garment.colour[2] + 30


class TestHard:
    @pytest.mark.parametrize("seed", range(4))
    def test_what_it_promises(self, seed: int) -> None:
        scene = preset_scene("hard", seed=seed)
        joints = joints_of(scene)
        assert (
            scene.others and len(scene.light.switches) == 1 and scene.sensor.shutter > 0 and scene.person.looseness > 0
        )
        assert 0 < scene.light.switches[0].time < scene.duration
        hidden = [hides(scene.occluders[-1], camera.position, joints).mean() for camera in scene.rig]
        assert max(hidden) > 0.02
        assert clear_of(scene.occluders, joints, 0.1) and apart(joints, joints_of(scene, 1), 0.7)

    def test_it_renders(self) -> None:
        scene = preset_scene("hard", seed=1, duration=0.2)
        small = replace(scene, rig=Rig(tuple(camera.scaled(0.25) for camera in scene.rig)))
        images, masks = render(small, 3)
        assert all(image.std() > 10 for image in images) and any(mask.any() for mask in masks)


def test_cameras_may_be_one_to_eight() -> None:
    for count in (1, 8):
        assert len(preset_scene("easy", seed=0, cameras=count).rig) == count


def test_a_given_motion_is_kept() -> None:
    motion = Motion("wave", 1.0, 25.0, heading=0.3, place=(0.2, -0.1))
    assert preset_scene("studio", seed=0, motion=motion).person.motion == motion


def test_a_way_that_needs_it_gets_a_larger_room() -> None:
    long = Motion("walk", 5.0, 30.0, cadence=0.95)
    scene = preset_scene("studio", seed=1, motion=long)
    assert scene.room.half_width > 4.6
    assert (np.abs(joints_of(scene)[..., :2]) < scene.room.half_width).all()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"preset": "eazy"}, "preset: expected one of easy"),
        ({"seed": -1}, "0 or more"),
        ({"figure": "nobody"}, "figure: expected one of"),
        ({"motion": "fly"}, "motion: kind"),
        ({"outfit_name": "tuxedo"}, "outfit: expected one of"),
        ({"room": "cave"}, "room: expected one of"),
        ({"cameras": 9}, "1 to 8"),
        ({"cameras": 0}, "1 to 8"),
        ({"view": "top"}, "ring or side"),
        ({"view": "side", "cameras": 2}, "side with one camera"),
        ({"duration": 0.02}, "2 to 100000 frames"),
        ({"duration": 1e9}, "2 to 100000 frames"),
        ({"motion": Motion(place=(30.0, 0.0))}, "stays in every camera's picture"),
    ],
)
def test_bad_input(change: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        preset_scene(**{"preset": "studio", "seed": 0, **change})
