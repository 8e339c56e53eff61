"""Visible shares of segments, in cases where they are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from muybridge.cameras.model import Camera, Rig
from muybridge.synthetic.description import Person, Scene
from muybridge.synthetic.motion import Motion
from muybridge.synthetic.occluders import Occluder
from muybridge.synthetic.rasterise import Mesh, draw
from muybridge.synthetic.rigs import looking_at
from muybridge.synthetic.scene import shoot
from muybridge.synthetic.skinning import SEGMENTS, load_figure
from muybridge.synthetic.stage import stage
from muybridge.synthetic.visibility import segment_of_bone, visible_shares

NAMES = tuple(SEGMENTS)
FRONT = looking_at("front", np.array([3.5, 0.0, 1.0]), np.array([0.0, 0.0, 0.9]), focal=260, size=(240, 240))
LEFT = looking_at("left", np.array([0.0, 3.5, 1.0]), np.array([0.0, 0.0, 0.9]), focal=260, size=(240, 240))
#: Somebody who stands at the origin and faces +x.
SCENE = Scene(Rig((FRONT, LEFT)), Person("man", Motion("crouch", 0.5, 30.0)), noise=0.0)


def shares(scene: Scene, camera: int = 0) -> dict[str, float]:
    return dict(zip(NAMES, shoot(scene, 0, visibility=True)[camera].visible, strict=True))


def only(mesh: Mesh, segment: str) -> Mesh:
    """The faces of one segment."""
    owner = segment_of_bone(load_figure("man").bone_names)
    chosen = owner[mesh.face_parts] == NAMES.index(segment)
    return replace(mesh, faces=mesh.faces[chosen], face_labels=mesh.face_labels[chosen],
                   face_parts=mesh.face_parts[chosen])  # fmt: skip


def test_every_bone_has_one_segment() -> None:
    bones = [bone for group in SEGMENTS.values() for bone in group]
    assert sorted(bones) == sorted(load_figure("man").bone_names)


@pytest.mark.parametrize("segment", ["head", "left_forearm", "right_foot"])
@pytest.mark.parametrize("camera", [FRONT, LEFT, FRONT.scaled(0.3)])
def test_a_segment_alone_is_seen_whole(segment: str, camera: Camera) -> None:
    """Exactly 1: both counts are of the same pixels."""
    actor = stage(SCENE).actors[0]
    mesh = only(actor.mesh(0), segment)
    layer = draw(camera, mesh, actor.cloth)
    nothing = np.full((camera.size[1], camera.size[0]), np.inf, dtype=np.float32)
    found = visible_shares(camera, mesh, layer, nothing, segment_of_bone(actor.figure.bone_names))
    assert found[NAMES.index(segment)] == 1.0 and found.sum() == 1.0


def test_what_is_seen_from_the_front() -> None:
    """The head has nothing before it but the lower jaw's own neck; arms hang free; of both sides the same."""
    seen = shares(SCENE)
    assert seen["head"] > 0.9 and seen["left_forearm"] > 0.8 and seen["left_shank"] > 0.8
    for part in ("upper_arm", "forearm", "thigh", "shank", "foot"):
        assert abs(seen[f"left_{part}"] - seen[f"right_{part}"]) < 0.15


def test_the_far_side_is_hidden() -> None:
    seen = shares(SCENE, camera=1)
    assert seen["left_upper_arm"] > 0.9 > 0.3 > seen["right_upper_arm"]


def test_out_of_the_picture_is_not_seen() -> None:
    """A picture that ends at the waist has no legs: share 0, not the share of what would be there."""
    top = Rig((replace(FRONT, size=(240, 118)),))
    seen = shares(replace(SCENE, rig=top))
    assert seen["left_shank"] == seen["right_foot"] == 0 and seen["head"] > 0.9


def test_a_curtain_over_the_left_half() -> None:
    """It ends at the body's middle plane: the left arm is gone, the right one untouched, and half of the head is left.

    The head is symmetric but for its turn of a few degrees and hair: half within 0.15.
    """
    curtain = Occluder("box", (1.5, 0.75), (0.02, 1.5, 2.5))
    free, seen = shares(SCENE), shares(replace(SCENE, occluders=(curtain,)))
    assert seen["left_forearm"] == seen["left_hand"] == 0
    assert seen["right_forearm"] == free["right_forearm"]
    assert abs(seen["head"] / free["head"] - 0.5) < 0.15


def test_somebody_in_front_hides_too() -> None:
    other = Person("woman", Motion("wave", 0.5, 30.0, place=(1.0, 0.0)))
    free, seen = shares(SCENE), shares(replace(SCENE, others=(other,)))
    assert seen["torso"] < 0.4 * free["torso"]
    behind = replace(other, motion=replace(other.motion, place=(-1.0, 0.0)))
    assert shares(replace(SCENE, others=(behind,))) == free
