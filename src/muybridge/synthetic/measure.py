"""The tracker's body for a figure of ours, measured on its mesh: the joint centres and girths that a tape would find.

With it a tracker has the right body, so that what is left of its error is the filter's and the likelihood's. No cone
follows a mesh exactly: a few millimetres of outline remain.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from muybridge.body import Body, named_body
from muybridge.body.parts import Landmark, Segment, Shape, Vector
from muybridge.cameras.model import Rig
from muybridge.evaluation.names import JOINTS
from muybridge.likelihood.contour import robust_weights
from muybridge.likelihood.observation import ImageLikelihood
from muybridge.synthetic.rasterise import coverage_of
from muybridge.synthetic.rigs import looking_at
from muybridge.synthetic.skinning import Figure, load_figure

#: The figure faces +x with its left to +y; the body faces +y with its right to +x.
FIGURE_TO_BODY = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
#: Bones whose flesh makes up a segment of the body; the rest have the segment's own name.
FLESH = {"torso": ("abdomen", "thorax", "left_clavicle", "right_clavicle"),
         "left_foot": ("left_foot", "left_toes"), "right_foot": ("right_foot", "right_toes")}  # fmt: skip
BINS = 8  # slices along a segment in which its width and depth are taken
MARGIN = 0.12  # share of a segment at each end that is left out: flesh of the neighbours
THINNEST = 0.01  # metres
#: Arms and legs off the body, degrees: every segment has an outline of its own.
POSTURE = {"shoulder_abduction": 40.0, "hip_abduction": 12.0, "elbow_flexion": 15.0}
CAMERAS, STEPS, SPREAD = 12, 6, 0.05  # spread in metres
STIFFNESS = 1e-3  # square metres: keeps a girth that no outline shows
FEWEST = 4  # points of a slice that is looked at
#: Limbs reach from their joint to that of the next one.
CHAIN = {"upper_arm": "forearm", "forearm": "hand", "thigh": "shank", "shank": "foot"}


@lru_cache(maxsize=16)
def tracker_body(name: str, cut: str | None = None, hair: str | None = None) -> Body:
    """The catalogue's person with the joint centres and girths of a figure.

    Parameters
    ----------
    name, cut, hair : a figure of `skinning.load_figure`, and what it wears

    Returns
    -------
    Body
        Its joints coincide with the figure's in the neutral posture; the spine bends in one place instead of two.
    """
    figure, body = load_figure(name, cut, hair), named_body("person")
    centres, vertices = _neutral(figure)
    flesh = {segment.name: _flesh_of(segment.name, figure, vertices) for segment in body.segments}
    segments = tuple(_measured(segment, centres, flesh[segment.name]) for segment in body.segments)
    marks = {joint: _mark(body.landmarks[joint], centres[joint], centres) for joint in JOINTS}
    height = float(np.ptp(figure.vertices[:, 2]))
    measured = Body(f"person-{name}", segments, marks, height, f"measured on the mesh of {name}")
    return _wrapped(measured, figure)


def _neutral(figure: Figure) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Joint centres by segment and by joint, (3,) metres, and vertices (V, 3), in the body's axes, standing upright."""
    frames = figure.frames(np.tile(np.eye(3), (len(figure.heads), 1, 1)), np.zeros(3))
    places = frames[1] @ FIGURE_TO_BODY.T
    centres = {bone: places[index] for index, bone in enumerate(figure.bone_names)}
    joints = figure.joints(*frames) @ FIGURE_TO_BODY.T
    # One joint stands for the two of the figure's spine.
    centres["torso"] = 0.5 * (centres["abdomen"] + centres["thorax"])
    centres |= dict(zip(JOINTS, joints, strict=True))
    return centres, figure.skin(*frames) @ FIGURE_TO_BODY.T


def _flesh_of(segment: str, figure: Figure, vertices: np.ndarray) -> np.ndarray:
    """(n, 3) metres: the vertices that move mostly with a segment."""
    bones = [figure.bone(bone) for bone in FLESH.get(segment, (segment,)) if bone in figure.bone_names]
    return vertices[np.isin(figure.bone_indices[:, 0], bones)]


def _measured(segment: Segment, centres: dict[str, np.ndarray], flesh: np.ndarray) -> Segment:
    """The segment at its own joint, with a shape that follows its flesh."""
    at = centres[segment.name]
    offset = at - centres[segment.parent] if segment.parent else np.zeros(3)
    shape = None if segment.shape is None else _fitted(segment, centres, flesh - at)
    return replace(segment, offset=_vector(offset), at_tip=False, shape=shape)


def _mark(mark: Landmark, joint: np.ndarray, centres: dict[str, np.ndarray]) -> Landmark:
    """The joint, fixed to the segment that carries it in the catalogue."""
    return Landmark(mark.segment, offset=_vector(joint - centres[mark.segment]))


# ---- shapes ----------------------------------------------------------------------------------------------------------


def _fitted(segment: Segment, centres: dict[str, np.ndarray], flesh: np.ndarray) -> Shape:
    """The cone through the middle of the flesh (n, 3), as wide and deep as its slices."""
    low, high, free = _span(segment, centres, flesh)
    length = float(np.linalg.norm(high - low))
    axis = (high - low) / length
    side = np.array([1.0, 0.0, 0.0])
    third = np.cross(axis, side)
    along = (flesh - low) @ axis / length
    places = MARGIN + (1 - 2 * MARGIN) * (np.arange(BINS) + 0.5) / BINS
    slices = [flesh[np.abs(along - place) < 0.5 / BINS] for place in places]
    kept = [(place, part) for place, part in zip(places, slices, strict=True) if len(part) >= FEWEST]
    lines = {}
    for name, direction in (("side", side), ("third", third)):
        reach = np.array([_reach((part - low) @ direction) for _, part in kept])
        at = [place for place, _ in kept]
        lines[name] = _line(at, reach.mean(axis=1)), np.maximum(_line(at, 0.5 * np.diff(reach, axis=1)[:, 0]), THINNEST)
    (across, wide), (over, deep) = lines["side"], lines["third"]
    radii = np.sqrt(wide * deep)
    ratio = float(np.sqrt(wide.mean() / deep.mean()))
    ends = [point + side * across[k] + third * over[k] for k, point in enumerate((low, high))]
    base, tip = _pulled_in(ends, radii, free)
    return Shape(_vector(base), _vector(tip), (float(radii[0]), float(radii[1])), (ratio, 1.0 / ratio))


def _span(
    segment: Segment, centres: dict[str, np.ndarray], flesh: np.ndarray
) -> tuple[np.ndarray, np.ndarray, tuple[bool, bool]]:
    """Where a segment begins and ends, (3,) metres from its joint, and which ends stick out freely.

    Limbs reach from joint to joint; the others as far as their flesh, along the catalogue's axis.
    """
    side, _, part = segment.name.partition("_")
    if part in CHAIN:
        return np.zeros(3), centres[f"{side}_{CHAIN[part]}"] - centres[segment.name], (False, False)
    assert segment.shape is not None
    axis = np.subtract(segment.shape.tip, segment.shape.base)
    axis = np.eye(3)[np.argmax(np.abs(axis))] * np.sign(axis[np.argmax(np.abs(axis))])
    first, last = _reach(flesh @ axis)
    middle = np.median(flesh, axis=0) * (1 - np.abs(axis))
    return middle + axis * first, middle + axis * last, (True, True)


def _pulled_in(ends: list[np.ndarray], radii: np.ndarray, free: tuple[bool, bool]) -> list[np.ndarray]:
    """Ends (3,) moved inwards by their radii, since a round end reaches as far beyond its centre."""
    length = float(np.linalg.norm(ends[1] - ends[0]))
    inward = [radii[k] if free[k] else 0.0 for k in (0, 1)]
    scale = min(1.0, 0.9 * length / max(sum(inward), 1e-9))
    axis = (ends[1] - ends[0]) / length
    return [ends[0] + axis * inward[0] * scale, ends[1] - axis * inward[1] * scale]


# ---- girths from outlines --------------------------------------------------------------------------------------------


def _wrapped(body: Body, figure: Figure) -> Body:
    """The body with widths and depths that meet the figure's outlines, seen from all around in one posture.

    Each step solves d_i = w_i log(width) + h_i log(depth) over a group's outline points, where d is how far the mask's
    border lies outside, and w and h how far the outline moves: see `likelihood.contour`.
    """
    pose = np.array([np.radians(POSTURE.get(_unsided(name), 0.0)) for name in body.dof_names])
    model = ImageLikelihood(body, _around(body.height), (1,) * CAMERAS)
    seen = model.observe(_masks(body, figure, pose, model.rig))
    for _ in range(STEPS):
        rows = replace(seen, model=replace(model, body=body)).contour(pose, SPREAD)
        groups = np.array([segment.radius_group for segment in body.segments])[rows.segment]
        widths, depths = {}, {}
        for group in body.radius_groups:
            own = groups == group
            slopes = np.stack([rows.width[own], rows.depth[own]], axis=1)
            weights = robust_weights(rows.distance[own], SPREAD)[:, None]
            change = np.linalg.solve(
                slopes.T @ (weights * slopes) + STIFFNESS * np.eye(2), (weights * slopes).T @ rows.distance[own]
            )
            widths[group], depths[group] = np.exp(np.clip(change, -0.2, 0.2)).tolist()
        body = body.scaled(widths=widths, depths=depths)
    return body


def _around(height: float) -> Rig:
    """Cameras all round a person who stands at the origin with the hips there."""
    middle = np.array([0.0, 0.0, -0.05 * height])
    turns = 2 * np.pi * np.arange(CAMERAS) / CAMERAS
    places = [middle + (4 * np.cos(turn), 4 * np.sin(turn), 0.2) for turn in turns]
    return Rig(
        tuple(looking_at(f"c{i}", place, middle, focal=900.0, size=(640, 640)) for i, place in enumerate(places))
    )


def _masks(body: Body, figure: Figure, pose: np.ndarray, rig: Rig) -> list[np.ndarray]:
    """(H, W) bool: the figure in a pose (D,) of the body, with the hips at the origin, in each camera."""
    frames = figure.frames(_turns(body, figure, pose), np.zeros(3))
    hips = figure.joints(*frames)[JOINTS.index("pelvis")]
    mesh = figure.mesh(*frames)
    mesh = replace(mesh, vertices=(mesh.vertices - hips) @ FIGURE_TO_BODY.T)
    width, height = rig[0].size
    masks = []
    for camera in rig:
        pixels = camera.world_to_pixel(mesh.vertices)
        masks.append(coverage_of(pixels, mesh.faces, width, height))
    return masks


def _turns(body: Body, figure: Figure, pose: np.ndarray) -> np.ndarray:
    """(B, 3, 3): the turns of the figure's bones that stand for a pose (D,) of the body; the spine stays straight."""
    frames = body.frames(pose)[0, :, :, :3]
    turns = np.tile(np.eye(3), (len(figure.bone_names), 1, 1))
    for index, segment in enumerate(body.segments):
        if segment.name in figure.bone_names and segment.parent:
            local = frames[body.segment_names.index(segment.parent)].T @ frames[index]
            turns[figure.bone(segment.name)] = FIGURE_TO_BODY.T @ local @ FIGURE_TO_BODY
    return turns


def _unsided(name: str) -> str:
    return name.removeprefix("left_").removeprefix("right_")


def _reach(values: np.ndarray) -> tuple[float, float]:
    """From where to where (n,) values go: an outline is made by the outermost points."""
    return float(values.min()), float(values.max())


def _line(places: list[float], values: np.ndarray) -> np.ndarray:
    """(2,) values at 0 and at 1 of the straight line through (n,) values."""
    slope, level = np.polyfit(places, values, 1)
    return np.array([level, level + slope])


def _vector(point: np.ndarray) -> Vector:
    x, y, z = (float(v) for v in point)
    return x, y, z
