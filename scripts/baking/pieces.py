"""What does not lie on the skin: skirt, long hair, a bun and shoes, each a mesh of its own over the same bones.

Every piece has the same faces and weights in all people, so only its vertices are made from a person's body.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from baking.clothes import smooth_step, waist
from baking.rig import Body

HAIR_GRID, BUN_GRID, SHOE_GRID = (18, 29), (10, 16), (18, 26)  # rows x columns of vertices
HAIR_LENGTH = 0.17  # metres below the base of the neck
SKIRT_GAP, HAIR_GAP, SHOE_WALL = 0.012, 0.016, 0.005  # metres between skin and piece
SKIRT_FLARE = 0.055  # metres at the hem, to the front and back; less to the sides
UPPER = 19  # columns of a shoe over the instep
SOLE_EDGE, SOLE_RIM = 0.018, 0.003  # metres: height of a sole's edge, and how far it stands out


def grid_faces(grid: tuple[int, int], *, closed: bool) -> np.ndarray:
    """(F, 3) triangles of a grid of vertices, row by row; `closed` joins the last column to the first."""
    rows, columns = grid
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns if closed else columns - 1), indexing="ij")
    a, b = i * columns + j, i * columns + (j + 1) % columns
    c, d = a + columns, b + columns
    return np.stack([np.stack([a, c, b], -1), np.stack([b, c, d], -1)], axis=2).reshape(-1, 3)


# ---- skirt -----------------------------------------------------------------------------------------------------------


def fitted_skirt(body: Body, cloth: np.ndarray) -> np.ndarray:
    """The model's skirt (N, 3), pushed away from hips and thighs that come through it."""
    hips = body.vertices[body.on("pelvis", "abdomen", "left_thigh", "right_thigh")]
    centre = hips[:, :2].mean(axis=0)
    tree = cKDTree(hips)
    cloth = cloth.copy()
    for _ in range(6):
        away = cloth[:, :2] - centre
        away /= np.linalg.norm(away, axis=1, keepdims=True)
        near = hips[tree.query(cloth, k=4)[1]]
        beyond = np.einsum("nki,ni->nk", near[..., :2] - cloth[:, None, :2], away).max(axis=1)
        cloth[:, :2] += np.clip(beyond + SKIRT_GAP, 0.0, 0.03)[:, None] * away
    cloth[:, :2] += SKIRT_FLARE * skirt_looseness(body, cloth)[:, None] * away * (1.0, 0.4)
    return cloth


def skirt_looseness(body: Body, cloth: np.ndarray) -> np.ndarray:
    """(N,) 0 at the waistband, 1 at the hem."""
    return smooth_step((waist(body) - 0.05 - cloth[:, 2]) / (waist(body) - 0.05 - cloth[:, 2].min()))


# ---- hair ------------------------------------------------------------------------------------------------------------


def long_hair(body: Body) -> np.ndarray:
    """A sheet that falls from the crown over the back of head and neck to the shoulder blades: (rows x columns, 3)."""
    rows, columns = HAIR_GRID
    head = body.vertices[body.on("head")]
    axis = np.array([0.5 * (head[:, 0].min() + head[:, 0].max()), 0.0])
    turn = np.radians(np.linspace(-108, 108, columns))  # 0 is straight back
    heights = np.linspace(head[:, 2].max() - 0.035, body.at("neck")[2] - HAIR_LENGTH, rows)
    trunk = body.vertices[body.on("head", "neck", "thorax")]
    reach = radii(trunk, axis, turn, heights) + HAIR_GAP
    widest = reach[: rows // 3].max(axis=0)
    fall = (heights[0] - heights[-1]) / (rows - 1)
    for row in range(1, rows):  # hair hangs: it falls in by a fifth at most, and does not spread over the shoulders
        reach[row] = np.clip(reach[row], reach[row - 1] - 0.2 * fall, widest + 0.02)
    reach[:3] -= np.array([0.024, 0.012, 0.004])[:, None]  # the sheet's upper edge and sides lie under the short hair
    reach -= 0.02 * smooth_step((np.abs(turn) - np.radians(92)) / np.radians(16))
    x, y = axis[0] - reach * np.cos(turn), -reach * np.sin(turn)
    return np.stack([x, y, np.repeat(heights[:, None], columns, axis=1)], axis=-1).reshape(-1, 3)


def radii(points: np.ndarray, axis: np.ndarray, turn: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """(rows, columns) how far points reach from a vertical axis around each direction and height; gaps are filled."""
    offset = points[:, :2] - axis
    distance, angle = np.hypot(*offset.T), np.arctan2(-offset[:, 1], -offset[:, 0])
    out = np.zeros((len(heights), len(turn)))
    for i, height in enumerate(heights):
        slab = np.abs(points[:, 2] - height) < 0.022
        for j, direction in enumerate(turn):
            apart = np.abs((angle - direction + np.pi) % (2 * np.pi) - np.pi)
            near = slab & (apart < np.radians(13))
            out[i, j] = distance[near].max() if near.any() else 0.0
    kernel = np.array([0.25, 0.5, 0.25])
    padded = np.pad(out, 1, mode="edge")
    across = sum(k * padded[:, c : c + len(turn)] for c, k in enumerate(kernel))
    return np.asarray(sum(k * across[r : r + len(heights)] for r, k in enumerate(kernel)))


def bun(body: Body) -> np.ndarray:
    """A knot of hair at the back of the head: an ellipsoid, (rows x columns, 3)."""
    head = body.vertices[body.on("head")]
    crown = head[:, 2].max()
    back = head[np.abs(head[:, 2] - crown + 0.075) < 0.02, 0].min()
    polar, turn = np.meshgrid(
        np.linspace(0, np.pi, BUN_GRID[0]), 2 * np.pi * np.arange(BUN_GRID[1]) / BUN_GRID[1], indexing="ij"
    )
    unit = np.stack([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], axis=-1).reshape(-1, 3)
    return unit * (0.042, 0.047, 0.047) + (back - 0.026, 0.0, crown - 0.07)


# ---- shoes -----------------------------------------------------------------------------------------------------------


def shoe(body: Body, side: str) -> np.ndarray:
    """A shoe lofted through the convex sections of the foot, with a flat sole: (rows x columns, 3).

    Rows run from heel to toe; a foot's sections are convex but for the gaps between toes, which a shoe closes. The
    first UPPER columns run over the instep from edge to edge of the sole, the others back beneath it.
    """
    ankle, along, across = foot_axes(body, side)
    foot = body.vertices[body.on(f"{side}_foot", f"{side}_toes", f"{side}_shank")]
    foot = foot[foot[:, 2] < ankle[2] + 0.012]
    local = np.stack([(foot - ankle) @ along, (foot - ankle) @ across, foot[:, 2]], axis=1)
    ends = np.array([local[:, 0].min(), local[:, 0].max()]) + (-SHOE_WALL, SHOE_WALL + 0.004)
    stations = ends.mean() - 0.5 * np.ptp(ends) * np.cos(np.linspace(0, np.pi, SHOE_GRID[0]))
    out = np.empty((*SHOE_GRID, 3))
    for row, station in enumerate(stations):
        at = np.clip(station, *(ends + (0.012, -0.012)))
        section = shoe_section(local[np.abs(local[:, 0] - at) < 0.014, 1:])
        if row in (0, SHOE_GRID[0] - 1):  # the cap: lower and narrower
            middle = section[:, 0].mean()
            section = np.stack([middle + 0.7 * (section[:, 0] - middle), 0.6 * section[:, 1]], axis=1)
        out[row, :, 0], out[row, :, 1:] = station, section
    flat = out.reshape(-1, 3)
    return ankle * (1, 1, 0) + flat[:, :1] * along + flat[:, 1:2] * across + flat[:, 2:] * (0, 0, 1)


def foot_axes(body: Body, side: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The ankle, and unit vectors along the foot and across it to the left, on the floor."""
    ankle, toes = body.at(f"{side}_foot"), body.at(f"{side}_toes")
    along = (toes - ankle) * (1, 1, 0) / np.linalg.norm((toes - ankle)[:2])
    return ankle, along, np.array([-along[1], along[0], 0.0])


def shoe_section(points: np.ndarray) -> np.ndarray:
    """(columns, 2) across and up: the upper round points (N, 2) of the foot, then the sole down to the floor."""
    left, right = points[:, 0].max(), points[:, 0].min()
    base = [(left, SOLE_EDGE), (right, SOLE_EDGE), (0.5 * (left + right), SOLE_EDGE + 0.012)]
    turn = np.linspace(0, np.pi, UPPER)
    over = rounded(np.concatenate([points, base]), np.array([0.5 * (left + right), SOLE_EDGE]), turn, SHOE_WALL)
    over[0, 0] += SOLE_RIM
    over[-1, 0] -= SOLE_RIM
    under = np.linspace(over[-1, 0], over[0, 0], SHOE_GRID[1] - UPPER)
    return np.concatenate([over, np.stack([under, np.zeros_like(under)], axis=1)])


def rounded(points: np.ndarray, middle: np.ndarray, turn: np.ndarray, wall: float) -> np.ndarray:
    """(columns, 2) convex outline of points (N, 2), `wall` outside them, in directions `turn` from a middle (2,)."""
    fine = np.linspace(0, 2 * np.pi, 72, endpoint=False)
    normals = np.stack([np.cos(fine), np.sin(fine)], axis=1)
    support = ((points - middle) @ normals.T).max(axis=0) + wall
    directions = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    facing = directions @ normals.T
    reach = np.where(facing > 1e-6, support / np.maximum(facing, 1e-6), np.inf).min(axis=1)
    return middle + reach[:, None] * directions


def sole_faces() -> np.ndarray:
    """(F,) bool: which faces of a shoe's grid are its sole and the sole's edge."""
    columns = SHOE_GRID[1]
    column = np.arange(columns)
    sole = (column >= UPPER - 1) & (column < columns)  # from a column to the next one
    return np.repeat(np.tile(sole, SHOE_GRID[0] - 1), 2)


# ---- weights: which bones move the pieces ----------------------------------------------------------------------------


def hair_weights(names: tuple[str, ...]) -> np.ndarray:
    """(rows x columns, B): the head above, then neck, then thorax."""
    share = np.linspace(0, 1, HAIR_GRID[0])
    head = 1.0 - smooth_step((share - 0.35) / 0.35)
    thorax = smooth_step((share - 0.62) / 0.38)
    weights = np.zeros((HAIR_GRID[0], len(names)))
    weights[:, names.index("head")] = head
    weights[:, names.index("thorax")] = (1 - head) * thorax
    weights[:, names.index("neck")] = (1 - head) * (1 - thorax)
    return np.repeat(weights, HAIR_GRID[1], axis=0)


def bun_weights(names: tuple[str, ...]) -> np.ndarray:
    """(rows x columns, B): the head alone."""
    return np.tile(np.eye(len(names))[names.index("head")], (BUN_GRID[0] * BUN_GRID[1], 1))


def shoe_weights(body: Body, side: str) -> np.ndarray:
    """(rows x columns, B): the foot, and the toes from the ball on."""
    names = body.names
    ankle, along, _ = foot_axes(body, side)
    ball = (body.at(f"{side}_toes") - ankle) @ along
    share = smooth_step(((shoe(body, side) - ankle) @ along / ball - 0.85) / 0.3)
    weights = np.zeros((len(share), len(names)))
    weights[:, names.index(f"{side}_foot")], weights[:, names.index(f"{side}_toes")] = 1 - share, share
    return weights
