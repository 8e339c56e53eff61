"""A baked person: a mesh, its bones, and linear blend skinning.

The mesh is no body model of the tracker: 14,000 vertices of a person with clothes, hair and shoes. Its bones carry the
truth: the 15 reported joints are bone heads, which lie at the anatomical joint centres.

Frames
    World: metres, z up; the person faces +x, left is +y. Every bone has a frame that is parallel to the world's in the
    *neutral posture*: upright, arms and legs straight down, palms in, toes forward. A posture is one rotation a bone,
    relative to its parent, in that frame; turns about +y lift what points forward down, so flexion of a hip is -y.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from muybridge._kernels.rasterise import blend_skin, vertex_normals
from muybridge.evaluation.names import JOINTS
from muybridge.synthetic.dress import folds, hang
from muybridge.synthetic.figure_file import figure_names, read_figure
from muybridge.synthetic.rasterise import Mesh

__all__ = ["JOINT_BONES", "SEGMENTS", "Figure", "figure_names", "load_figure"]

#: The bone at whose head each joint lies; pelvis, thorax and head_top are made from several points (`Figure.joints`).
JOINT_BONES = {
    "shoulder": "upper_arm",
    "elbow": "forearm",
    "wrist": "hand",
    "hip": "thigh",
    "knee": "shank",
    "ankle": "foot",
}
#: The bones of each segment whose visibility a scene reports.
SEGMENTS: dict[str, tuple[str, ...]] = {
    "head": ("head", "neck"),
    "torso": ("thorax", "abdomen", "left_clavicle", "right_clavicle"),
    "pelvis": ("pelvis",),
    **{
        f"{side}_{segment}": tuple(f"{side}_{bone}" for bone in (segment, *more))
        for side in ("left", "right")
        for segment, more in (
            ("upper_arm", ()),
            ("forearm", ()),
            ("hand", ()),
            ("thigh", ()),
            ("shank", ()),
            ("foot", ("toes",)),
        )
    },
}
FORWARD, DOWN = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, -1.0])


@dataclass(frozen=True, eq=False)
class Figure:
    """A baked person at rest, dressed.

    Parameters
    ----------
    name, cut, hair : str
    vertices : (V, 3) float64, metres, rest posture (arms half raised), soles on z = 0
    faces : (F, 3) int32
    weights : (V, 4) float64, rows sum to 1
    bone_indices : (V, 4) int32
    labels : (V,) int32, into label_names (skin, hair, shirt, trousers, shoes, eyes, soles)
    face_labels : (F,) int32; -1 where the region map decides
    corner_uv : (F, 3, 2) float32 in 0-1: the corners' places in the region map
    regions : (rows, columns) uint8: the label of each texel, see `rasterise.Mesh`
    looseness : (V,) float64 in 0-1: how far loose cloth may hang off the skin
    label_names, bone_names : tuple of str
    parents : (B,) int, parents come first, -1 for the root
    heads : (B, 3) float64, metres: where each bone begins, rest posture
    landmarks : dict of (3,) float64: head_top, left_knuckle, right_knuckle at rest
    """

    name: str
    cut: str
    hair: str
    vertices: np.ndarray
    faces: np.ndarray
    weights: np.ndarray
    bone_indices: np.ndarray
    labels: np.ndarray
    face_labels: np.ndarray
    corner_uv: np.ndarray
    regions: np.ndarray
    looseness: np.ndarray
    label_names: tuple[str, ...]
    bone_names: tuple[str, ...]
    parents: np.ndarray
    heads: np.ndarray
    landmarks: dict[str, np.ndarray]

    def bone(self, name: str) -> int:
        """The index of a bone."""
        return self.bone_names.index(name)

    @cached_property
    def to_neutral(self) -> np.ndarray:
        """(B, 3, 3): the rotation that takes each bone from the rest posture to the neutral one."""
        turns = np.tile(np.eye(3), (len(self.heads), 1, 1))
        for side in ("left", "right"):
            self._straighten_arm(turns, side)
            self._straighten_leg(turns, side)
        return turns

    @cached_property
    def neutral_offsets(self) -> np.ndarray:
        """(B, 3) metres: from the parent's head to each bone's head in the neutral posture."""
        offsets = self.heads - self.heads[self.parents]
        turned = np.einsum("bij,bj->bi", self.to_neutral[self.parents], offsets)
        turned[0] = 0.0
        return turned

    @cached_property
    def material(self) -> np.ndarray:
        """(V, 3) metres: places in the cloth, those of the neutral posture: stripes run round trunk and limbs alike."""
        frames = self.frames(np.tile(np.eye(3), (len(self.heads), 1, 1)), np.zeros(3))
        return self.skin(*frames)

    def frames(self, rotations: np.ndarray, root: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forward kinematics.

        Parameters
        ----------
        rotations : (B, 3, 3), each bone's turn relative to its parent; the root's is relative to the world
        root : (3,) metres, world: where the pelvis bone's head is

        Returns
        -------
        (B, 3, 3) and (B, 3): world rotations and head positions
        """
        world, places = np.empty_like(rotations), np.empty((len(rotations), 3))
        world[0], places[0] = rotations[0], root
        for bone in range(1, len(rotations)):
            parent = self.parents[bone]
            world[bone] = world[parent] @ rotations[bone]
            places[bone] = places[parent] + world[parent] @ self.neutral_offsets[bone]
        return world, places

    def skin(self, world: np.ndarray, places: np.ndarray) -> np.ndarray:
        """(V, 3) metres, world: the mesh in the posture that `frames` gave."""
        turns = world @ self.to_neutral
        offsets = places - np.einsum("bij,bj->bi", turns, self.heads)
        out = np.empty_like(self.vertices)
        blend_skin(self.vertices, self.weights, self.bone_indices, turns, offsets, out)
        return out

    def normals(self, vertices: np.ndarray) -> np.ndarray:
        """(V, 3) outward unit normals of the mesh with these vertices."""
        out = np.empty_like(vertices)
        vertex_normals(vertices, self.faces, out)
        return out

    @cached_property
    def face_parts(self) -> np.ndarray:
        """(F,) int32: the bone that moves most of each face."""
        a, b, c = self.bone_indices[self.faces, 0].T
        return np.where(b == c, b, a).astype(np.int32)

    @cached_property
    def folds(self) -> np.ndarray:
        """(V,) in -1 to 1: where loose cloth bulges."""
        return folds(self.material)

    def mesh(
        self,
        world: np.ndarray,
        places: np.ndarray,
        *,
        earlier: tuple[np.ndarray, np.ndarray] | None = None,
        looseness: float = 0.0,
    ) -> Mesh:
        """The figure in the posture that `frames` gave, ready to be drawn; its parts are bones.

        Parameters
        ----------
        world : (B, 3, 3); places : (B, 3) metres, world
        earlier : the same a moment ago (`posture.mesh_at`), which loose cloth is still drawn to; None: it stands still
        looseness : metres that cloth hangs off the skin where it is loosest; 0 is tight
        """
        vertices = self.skin(world, places)
        normals = self.normals(vertices)
        if looseness > 0:
            before = vertices if earlier is None else self.skin(earlier[0], earlier[1] - earlier[1][0] + places[0])
            vertices = hang(vertices, normals, before, looseness * self.looseness, self.folds)
            normals = self.normals(vertices)
        return Mesh(
            vertices,
            normals,
            self.faces,
            self.material,
            self.face_labels,
            self.face_parts,
            self.corner_uv,
            self.regions,
        )

    def carried(self, point: np.ndarray, bone: int, world: np.ndarray, places: np.ndarray) -> np.ndarray:
        """(3,) metres, world: where a rest-posture point that is fixed to a bone has gone."""
        return places[bone] + world[bone] @ (self.to_neutral[bone] @ (point - self.heads[bone]))

    def joints(self, world: np.ndarray, places: np.ndarray) -> np.ndarray:
        """(15, 3) metres, world, in the order of `JOINTS`.

        The pelvis is midway between the hips; the thorax midway between the base of the neck and the inner ends of the
        clavicles, as marker sets take it from C7 and the sternal notch; head_top the top of the head, with hair.
        """
        collar = 0.5 * (places[self.bone("left_clavicle")] + places[self.bone("right_clavicle")])
        found = {
            "pelvis": 0.5 * (places[self.bone("left_thigh")] + places[self.bone("right_thigh")]),
            "thorax": 0.5 * (places[self.bone("neck")] + collar),
            "head_top": self.carried(self.landmarks["head_top"], self.bone("head"), world, places),
        }
        for name in JOINTS:
            side, _, joint = name.partition("_")
            if joint in JOINT_BONES:
                found[name] = places[self.bone(f"{side}_{JOINT_BONES[joint]}")]
        return np.array([found[name] for name in JOINTS])

    def _straighten_arm(self, turns: np.ndarray, side: str) -> None:
        """Upper arm, forearm and hand down, the elbow's axis across, so that it bends forward."""
        upper, lower, hand = (self.bone(f"{side}_{part}") for part in ("upper_arm", "forearm", "hand"))
        directions = (
            self.heads[lower] - self.heads[upper],
            self.heads[hand] - self.heads[lower],
            self.landmarks[f"{side}_knuckle"] - self.heads[hand],
        )
        hinge = np.cross(directions[0], directions[1])
        for bone, direction in zip((upper, lower, hand), directions, strict=True):
            turns[bone] = turn_between((direction, hinge), (DOWN, np.array([0.0, -1.0, 0.0])))

    def _straighten_leg(self, turns: np.ndarray, side: str) -> None:
        """Thigh and shank down, the foot flat and pointing forward, a little outwards."""
        thigh, shank, foot, toes = (self.bone(f"{side}_{part}") for part in ("thigh", "shank", "foot", "toes"))
        turns[thigh] = turn_between((self.heads[shank] - self.heads[thigh], FORWARD), (DOWN, FORWARD))
        turns[shank] = turn_between((self.heads[foot] - self.heads[shank], FORWARD), (DOWN, FORWARD))
        along = (self.heads[toes] - self.heads[foot]) * (1.0, 1.0, 0.0)
        out = np.radians(6.0 if side == "left" else -6.0)
        turns[foot] = turn_between((DOWN, along), (DOWN, np.array([np.cos(out), np.sin(out), 0.0])))
        turns[toes] = turns[foot]


def load_figure(name: str, cut: str | None = None, hair: str | None = None) -> Figure:
    """A person baked by scripts/bake_bodies.py.

    Parameters
    ----------
    name : one of `figure_names()`: "man" (1.79 m), "woman" (1.67 m), ...
    cut : of the clothes: "short_sleeves", "long_sleeves", "shorts" or "skirt"; None: the person's own
    hair : "short", "long" or "bun"; None: the person's own
    """
    return Figure(**read_figure(name, cut, hair))


def turn_between(source: tuple[np.ndarray, np.ndarray], target: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """The rotation that takes source[0] to target[0] and source[1] as near to target[1] as it can."""
    return _basis(*target) @ _basis(*source).T


def _basis(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """A right-handed orthonormal basis (3, 3) in columns: first, then second made perpendicular."""
    x = first / np.linalg.norm(first)
    y = second - x * (x @ second)
    y = y / np.linalg.norm(y)
    return np.stack([x, y, np.cross(x, y)], axis=1)
