"""Everybody in the picture of one camera: who is seen where, and the boxes of people and of their parts."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from muybridge._kernels.layers import mark_parts
from muybridge.cameras.model import Camera
from muybridge.errors import InputError
from muybridge.synthetic.description import Scene
from muybridge.synthetic.rasterise import Mesh, extent
from muybridge.synthetic.scene import film
from muybridge.synthetic.shadow import CELL
from muybridge.synthetic.skinning import SEGMENTS
from muybridge.synthetic.stage import Actor, stage

#: part -> its segments; the legs count to the knee, as Zhao's hip-leg is the upper half of what is below the waist
PARTS: dict[str, tuple[str, ...]] = {
    "head": ("head",),
    "torso": ("torso",),
    "hip_leg": ("pelvis", "left_thigh", "right_thigh"),
}
REST = len(PARTS)  # the bit of arms, shanks and feet
INSIDE = 0.25  # of a person, in the picture: with less, they are not counted as being there
NEAR = 1.5  # metres from the pelvis: nothing of a person or their shadow on the floor that matters is further
BEYOND = 1.0  # widths and heights of the picture: a box that reaches further out is cut there


@dataclass(frozen=True, eq=False)
class PeopleShot:
    """One frame, and who is in it; P people, of each of whom at least `INSIDE` is in the picture, hidden or not.

    Parameters
    ----------
    image : (H, W, 3) uint8 BGR
    ids : (H, W) uint8: the identity of who fills most of the pixel; 0 where people fill less than half of it
    numbers : (P,) int64: identities: 1 is the scene's person, the others follow
    boxes : (P, 4) float64, pixels: left, top, width, height of the whole person, as if nothing hid them; it may reach
        beyond the picture
    visible : (P,) float64 in 0-1: share of the person that is in the picture and not hidden by people or things
    parts : (P, 3, 4) float64, pixels: the same boxes of head, torso (without arms) and hip-leg (to the knees)
    parts_visible : (P, 3) float64 in 0-1
    """

    image: np.ndarray
    ids: np.ndarray
    numbers: np.ndarray
    boxes: np.ndarray
    visible: np.ndarray
    parts: np.ndarray
    parts_visible: np.ndarray

    @property
    def mask(self) -> np.ndarray:
        """(H, W) bool: people fill at least half of the pixel."""
        return self.ids > 0


def shoot_people(scene: Scene, frame: int) -> PeopleShot:
    """One frame of the scene's first camera; only who is near the picture is drawn."""
    if not 0 <= frame < scene.frame_count:
        raise InputError("frame", expected=f"0 to {scene.frame_count - 1}", got=str(frame))
    made, camera = stage(scene), scene.rig[0]
    numbers = [number for number, actor in enumerate(made.actors) if _near(camera, actor, frame)]
    cast = replace(made, actors=tuple(made.actors[number] for number in numbers))
    now = [actor.mesh(frame) for actor in cast.actors]
    time = frame / scene.rate
    lamp = scene.light.lamps[scene.light.state(time)]
    shade = made.decors[scene.epoch(time)].shade(now, lamp, scene.shadow, cell=2 * CELL)
    image, shares, _ = film(scene, cast, 0, frame, now, shade)
    shares = shares[: len(numbers)]
    filled = shares.sum(axis=0) >= 0.5
    identities = np.array(numbers, dtype=np.uint8) + np.uint8(1)
    ids = np.where(filled, identities[shares.argmax(axis=0)], np.uint8(0)) if numbers else filled.astype(np.uint8)
    found = [_measured(camera, actor, mesh, ids == number, share)
             for actor, mesh, number, share in zip(cast.actors, now, identities, shares, strict=True)]  # fmt: skip
    return _collected(image, ids, identities, found)


@dataclass(frozen=True, eq=False)
class _Measured:
    """Boxes (4, 4) of the person and the parts, visible shares (4,), and how much is inside the picture."""

    boxes: np.ndarray
    visible: np.ndarray
    inside: float


def _near(camera: Camera, actor: Actor, frame: int) -> bool:
    """Whether somebody or their shadow may be in the picture."""
    centre = actor.track.joints[frame, 0]
    depth = camera.world_to_camera(centre)[2]
    if depth < -NEAR:
        return False
    if depth < NEAR:
        return True
    pixel, reach = camera.world_to_pixel(centre), NEAR * camera.matrix[0, 0] / depth
    return bool(((pixel > -reach) & (pixel < np.array(camera.size) + reach)).all())


def _measured(camera: Camera, actor: Actor, mesh: Mesh, seen: np.ndarray, share: np.ndarray) -> _Measured | None:
    """Where the person would be seen alone in a picture without sides; None where nothing would be."""
    marks, left, top = _marks(camera, actor, mesh)
    if not marks.any():
        return None
    height, width = share.shape
    rows, columns = np.arange(marks.shape[0]) + top, np.arange(marks.shape[1]) + left
    in_picture = np.ix_((rows >= 0) & (rows < height), (columns >= 0) & (columns < width))
    window = (
        slice(max(top, 0), max(min(top + len(rows), height), 0)),
        slice(max(left, 0), max(min(left + len(columns), width), 0)),
    )
    boxes, visible = np.zeros((1 + REST, 4)), np.zeros(1 + REST)
    inside = np.count_nonzero(marks[in_picture]) / np.count_nonzero(marks)
    boxes[0] = _box(marks > 0, left, top)
    visible[0] = min(1.0, float(share.sum()) / np.count_nonzero(marks))
    for part in range(REST):
        own = (marks >> np.uint32(part)) & np.uint32(1) == 1
        if own.any():
            boxes[1 + part] = _box(own, left, top)
            visible[1 + part] = np.count_nonzero(own[in_picture] & seen[window]) / np.count_nonzero(own)
    return _Measured(boxes, visible, inside)


def _marks(camera: Camera, actor: Actor, mesh: Mesh) -> tuple[np.ndarray, int, int]:
    """(h, w) uint32, a bit for each part seen were the person alone, and the window's left and top, pixels."""
    place = camera.world_to_camera(mesh.vertices)
    pixels = camera.camera_to_pixel(place)
    usable = np.isfinite(pixels[:, 0]) & (place[:, 2] > 0)
    if not usable.any():
        return np.zeros((0, 0), dtype=np.uint32), 0, 0
    size = np.array(camera.size)
    low, high = extent(pixels[usable])
    low, high = (np.clip(end, -BEYOND * size, (1 + BEYOND) * size).astype(int) for end in
                 (np.floor(low), np.ceil(high) + 1))  # fmt: skip
    marks = np.zeros((high - low)[::-1], dtype=np.uint32)
    inverse = np.where(usable, 1.0 / np.where(place[:, 2] > 0, place[:, 2], 1.0), -1.0)
    mark_parts(pixels - low, inverse, mesh.faces, part_of_bone(actor.figure.bone_names)[mesh.face_parts], marks)
    return marks, int(low[0]), int(low[1])


def part_of_bone(bone_names: tuple[str, ...]) -> np.ndarray:
    """(B,) int32: the index in PARTS of each bone's part; REST where it belongs to none."""
    owner = {
        bone: index for index, names in enumerate(PARTS.values()) for name in names for bone in SEGMENTS[name]
    }  # fmt: skip
    return np.array([owner.get(bone, REST) for bone in bone_names], dtype=np.int32)


def _box(mask: np.ndarray, left: int, top: int) -> tuple[int, int, int, int]:
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return left + columns[0], top + rows[0], columns[-1] - columns[0] + 1, rows[-1] - rows[0] + 1


def _collected(image: np.ndarray, ids: np.ndarray, numbers: np.ndarray, found: list[_Measured | None]) -> PeopleShot:
    kept = [(number, one) for number, one in zip(numbers, found, strict=True) if one and one.inside >= INSIDE]
    boxes = np.array([one.boxes for _, one in kept]).reshape(-1, 1 + REST, 4)
    visible = np.array([one.visible for _, one in kept]).reshape(-1, 1 + REST)
    names = np.array([number for number, _ in kept], dtype=np.int64)
    return PeopleShot(image, ids, names, boxes[:, 0], visible[:, 0], boxes[:, 1:], visible[:, 1:])
