"""Clothes that lie on the skin: which label each place wears, how thick the cloth is, and where it hangs loose.

A hem is a plane across a limb or the trunk in the rest posture. `labels_at` decides for any point, so a vertex and a
texel of the atlas obey the same rule; the region map is that rule evaluated at every texel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from baking.rig import Body

LABELS = ("skin", "hair", "shirt", "trousers", "shoes", "eyes", "soles")
SKIN, HAIR, SHIRT, TROUSERS, SHOES, EYES, SOLES = range(len(LABELS))
#: outward push of each label, metres: cloth and hair have thickness; shoes are pieces of their own
THICKNESS = np.array([0.0, 0.012, 0.007, 0.009, 0.0, 0.0, 0.0])
TEXELS = 1024
TRUNK = ("pelvis", "abdomen", "thorax", "left_clavicle", "right_clavicle")


@dataclass(frozen=True)
class Cut:
    """How far clothes reach.

    sleeve: 0 at the shoulder, 1 at the elbow, 2 at the wrist; leg: 0 at the hip, 1 at the knee, 2 at the ankle (of a
    skirt: what is dark beneath it); hem: metres of the shirt's lower edge over the waist.
    """

    sleeve: float
    leg: float
    hem: float = 0.0
    skirt: bool = False


CUTS = {
    "short_sleeves": Cut(sleeve=0.97, leg=2.0),
    "long_sleeves": Cut(sleeve=1.93, leg=2.0),
    "shorts": Cut(sleeve=0.60, leg=0.80, hem=-0.08),
    "skirt": Cut(sleeve=1.35, leg=0.95, skirt=True),
}


def labels_at(points: np.ndarray, bone: np.ndarray, body: Body, cut: Cut) -> np.ndarray:
    """(N,) labels of points (N, 3) of the template at rest, each with the bone (N,) that moves it most."""
    labels = np.full(len(points), SKIN)
    on = {name: bone == i for i, name in enumerate(body.names)}
    hem = waist(body) + cut.hem
    trunk = np.any([on[name] for name in TRUNK], axis=0)
    labels[trunk] = np.where(points[trunk, 2] >= hem, SHIRT, TROUSERS)
    for side in ("left", "right"):
        along = limb_share(points, body, side, ("upper_arm", "forearm", "hand"), on)
        labels[(on[f"{side}_upper_arm"] | on[f"{side}_forearm"]) & (along < cut.sleeve)] = SHIRT
        along = limb_share(points, body, side, ("thigh", "shank", "foot"), on)
        labels[(on[f"{side}_thigh"] | on[f"{side}_shank"]) & (along < cut.leg)] = TROUSERS
        ankle = body.at(f"{side}_foot")[2]
        foot = on[f"{side}_foot"] | on[f"{side}_toes"] | (on[f"{side}_shank"] & (points[:, 2] < ankle))
        labels[foot] = SHOES
    labels[on["neck"] & (points[:, 2] < body.at("neck")[2] - 0.01)] = SHIRT
    return np.where(short_hair(points, on["head"] | on["neck"], body), HAIR, labels)


def waist(body: Body) -> float:
    """Metres over the floor."""
    return float(body.at("abdomen")[2] + 0.02)


def limb_share(points: np.ndarray, body: Body, side: str, bones: tuple[str, str, str], on: dict) -> np.ndarray:
    """(N,) how far down a limb points lie: 0 to 1 along its first bone, 1 to 2 along its second."""
    first, middle, last = (body.at(f"{side}_{bone}") for bone in bones)
    upper = (points - first) @ (middle - first) / np.sum((middle - first) ** 2)
    lower = (points - middle) @ (last - middle) / np.sum((last - middle) ** 2)
    return np.where(on[f"{side}_{bones[1]}"], 1.0 + np.maximum(lower, 0.0), np.minimum(upper, 1.0))


def short_hair(points: np.ndarray, on_head: np.ndarray, body: Body) -> np.ndarray:
    """A short cut: above a line that rises from the nape over the ears to the forehead."""
    head = body.vertices[body.on("head", "neck")]
    top, middle = head[:, 2].max(), 0.5 * (head[:, 0].max() + head[:, 0].min())
    forward = (points[:, 0] - middle) / 0.1  # about -1 at the back of the head, +1 at the face
    line = top - 0.155 + 0.085 * np.clip(forward + 0.25, -0.6, 1.2)
    return on_head & (points[:, 2] > line) & ~ears(points, body.vertices[body.on("head")])


def ears(points: np.ndarray, head: np.ndarray) -> np.ndarray:
    """(N,) bool: points of the ears, whose rims are a head's (M, 3) widest."""
    rim = head[np.argmax(np.abs(head[:, 1]))]
    inside = ((points[:, 0] - rim[0] - 0.006) / 0.024) ** 2 + ((points[:, 2] - rim[2] + 0.012) / 0.036) ** 2 < 1
    return inside & (np.abs(points[:, 1]) > abs(rim[1]) - 0.024)


def thickness(labels: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(V,) metres of cloth on each vertex, smoothed over the mesh so that hems are not cliffs."""
    return smoothed(THICKNESS[labels], faces, 2)


def looseness(body: Body, cut: Cut, labels: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(V,) in 0-1: how far cloth may hang off the skin: 0 at collar and waistband, 1 where sleeves and legs end."""
    points = body.vertices
    on = {name: body.on(name) for name in body.names}
    loose = np.zeros(len(points))
    chest, hem = body.at("left_upper_arm")[2] - 0.10, waist(body) + cut.hem
    loose[labels == SHIRT] = 0.8 * smooth_step((chest - points[labels == SHIRT, 2]) / (chest - hem))
    for side in ("left", "right"):
        arm = (on[f"{side}_upper_arm"] | on[f"{side}_forearm"]) & (labels == SHIRT)
        along = limb_share(points, body, side, ("upper_arm", "forearm", "hand"), on)
        loose[arm] = 0.15 + 0.85 * smooth_step(along[arm] / cut.sleeve)
        leg = (on[f"{side}_thigh"] | on[f"{side}_shank"]) & (labels == TROUSERS)
        along = limb_share(points, body, side, ("thigh", "shank", "foot"), on)
        loose[leg] = smooth_step(along[leg] / cut.leg)
    out = np.zeros_like(loose)
    for worn in (labels == SHIRT, labels == TROUSERS):  # each garment by itself: it does not narrow towards its hem
        share = smoothed(worn.astype(float), faces, 3)
        out[worn] = smoothed(np.where(worn, loose, 0.0), faces, 3)[worn] / share[worn]
    return out


def smooth_step(x: np.ndarray) -> np.ndarray:
    """0 to 1 over [0, 1] with no corner."""
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def smoothed(values: np.ndarray, faces: np.ndarray, times: int) -> np.ndarray:
    """Values (V,) or (V, K) replaced `times` times by the mean over the faces around each vertex."""
    count = np.bincount(faces.ravel(), minlength=len(values)).reshape(-1, *[1] * (values.ndim - 1))
    for _ in range(times):
        total = np.zeros_like(values)
        np.add.at(total, faces, values[faces].mean(axis=1)[:, None])
        values = np.where(count > 0, total / np.maximum(count, 1), values)
    return values


def region_maps(body: Body, faces: np.ndarray, uv: np.ndarray, face_uv: np.ndarray) -> dict[str, np.ndarray]:
    """(TEXELS, TEXELS) uint8 labels of the atlas by cut; row 0 is v = 0; texels off the mesh take their nearest."""
    rows, columns, points, bone = atlas_points(body, faces, uv[face_uv] * TEXELS - 0.5)
    maps = {}
    empty = np.ones((TEXELS, TEXELS), dtype=bool)
    empty[rows, columns] = False
    nearest = ndimage.distance_transform_edt(empty, return_distances=False, return_indices=True)
    for name, cut in CUTS.items():
        image = np.zeros((TEXELS, TEXELS), dtype=np.uint8)
        image[rows, columns] = labels_at(points, bone, body, cut)
        maps[name] = image[tuple(nearest)]
    return maps


def atlas_points(body: Body, faces: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, ...]:
    """Texels (rows, columns) that faces with corners (F, 3, 2) cover, their points (N, 3) at rest, strongest bones."""
    rows, columns, points, bones = [], [], [], []
    for face, corner in zip(faces, corners, strict=True):
        low, high = np.ceil(corner.min(axis=0)).astype(int), np.floor(corner.max(axis=0)).astype(int)
        x, y = (axis.ravel() for axis in np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1)))
        (ax, ay), (bx, by), (cx, cy) = corner
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if not len(x) or abs(area) < 1e-12:
            continue
        b = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
        c = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
        share = np.stack([1 - b - c, b, c], axis=1)
        inside = (share >= -1e-9).all(axis=1)
        rows.append(y[inside])
        columns.append(x[inside])
        points.append(share[inside] @ body.vertices[face])
        bones.append((share[inside] @ body.weights[face]).argmax(axis=1))
    return tuple(np.concatenate(part) for part in (rows, columns, points, bones))
