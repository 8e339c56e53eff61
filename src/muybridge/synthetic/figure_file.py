"""Reading the baked people of `bodies/`: who there is, and a person's arrays with the clothes that are worn."""

from __future__ import annotations

from importlib import resources
from typing import Any

import numpy as np

from muybridge._kernels.rasterise import vertex_normals
from muybridge.errors import InputError

HAIR = ("short", "long", "bun")
BODIES = resources.files("muybridge.synthetic") / "bodies"
COMMON = "common"  # the file of what all people share


def figure_names() -> tuple[str, ...]:
    """Who can be loaded: men and women, old, young, heavy, slight and strong ones.

    >>> len(figure_names()) >= 6
    True
    """
    found = (entry.name[:-4] for entry in BODIES.iterdir() if entry.name.endswith(".npz"))
    return tuple(sorted(name for name in found if name != COMMON))


def cut_names() -> tuple[str, ...]:
    """How clothes can be cut.

    >>> cut_names()
    ('short_sleeves', 'long_sleeves', 'shorts', 'skirt')
    """
    return tuple(str(name) for name in _arrays(COMMON, ("cut_names",))["cut_names"])


def read_figure(name: str, cut: str | None = None, hair: str | None = None) -> dict[str, Any]:
    """The parameters of `skinning.Figure` for a person; None takes what the person usually wears."""
    if name not in figure_names():
        raise InputError("figure", expected=f"one of {', '.join(figure_names())}", got=repr(name))
    own = _arrays(name)
    cut, hair = cut or str(own["cut"]), hair or str(own["hair"])
    for what, value, known in (("cut", cut, cut_names()), ("hair", hair, HAIR)):
        if value not in known:
            raise InputError(f"figure: {what}", expected=f"one of {', '.join(known)}", got=repr(value))
    common = _arrays(COMMON)
    skirt = bool(common["skirts"][cut_names().index(cut)])
    worn = {"body", "shoes", hair} | ({"skirt"} if skirt else set())
    pieces = np.array([str(piece) in worn for piece in common["piece_names"]])
    return {"name": name, "cut": cut, "hair": hair, **_mesh(common, own, cut, pieces), **_bones(common, own)}


def _arrays(name: str, keys: tuple[str, ...] = ()) -> dict[str, np.ndarray]:
    """What a file of `bodies` holds, or some of it."""
    with (BODIES / f"{name}.npz").open("rb") as stream, np.load(stream, allow_pickle=False) as file:
        return {key: file[key] for key in keys or file.files}


def _mesh(
    common: dict[str, np.ndarray], own: dict[str, np.ndarray], cut: str, pieces: np.ndarray
) -> dict[str, np.ndarray]:
    """The mesh of the pieces that are worn; clothes on the skin are the skin pushed outwards."""
    vertices, faces = own["vertices"].astype(np.float64), common["faces"].astype(np.int32)
    keep, seen = pieces[common["vertex_piece"]], pieces[common["face_piece"]]
    normals = np.empty_like(vertices)
    vertex_normals(vertices, faces, normals)
    vertices += normals * (common[f"{cut}_thickness"] * 1e-4)[:, None]
    weights = common["weights"][keep].astype(np.float64)
    return {
        "vertices": vertices[keep],
        "faces": (np.cumsum(keep) - 1).astype(np.int32)[faces[seen]],
        "weights": weights / weights.sum(axis=1, keepdims=True),
        "bone_indices": common["bone_indices"][keep].astype(np.int32),
        "labels": common[f"{cut}_labels"][keep].astype(np.int32),
        "face_labels": common["face_label"][seen].astype(np.int32),
        "corner_uv": common["uv"][common["face_uv"][seen]].astype(np.float32) / np.float32(65535),
        "regions": common[f"{cut}_regions"],
        "looseness": common[f"{cut}_looseness"][keep] / 255.0,
    }


def _bones(common: dict[str, np.ndarray], own: dict[str, np.ndarray]) -> dict[str, Any]:
    """Bones, names and landmarks."""
    names = (str(name) for name in common["landmark_names"])
    return {
        "label_names": tuple(str(label) for label in common["label_names"]),
        "bone_names": tuple(str(bone) for bone in common["bone_names"]),
        "parents": common["bone_parents"].astype(np.int64),
        "heads": own["bone_heads"].astype(np.float64),
        "landmarks": dict(zip(names, own["landmarks"].astype(np.float64), strict=True)),
    }
