"""Calibration from pictures of a chequered board: the lens from several views, the place from one view on the floor.

Corners are found by OpenCV's classic detector, else by its sector-based one, and refined by cv2.cornerSubPix in a
window that grows with the squares: a fixed one reaches over neighbouring corners where squares are small and wastes
the blur where they are large. The camera model is fitted by cv2.calibrateCamera.

Board corners are given as (rows x columns) grids in the order found, starting at a black square where the board's
two sides allow it (one odd and one even number of inner corners); all cameras that see such a board on the floor
then agree on the world. A board with both odd or both even looks the same after half a turn, and they may not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from muybridge.cameras.model import Camera
from muybridge.cameras.rotations import rotation_from_vector
from muybridge.errors import InputError

FEWEST_VIEWS = 3  # fewer leave the focal length and the principal point undetermined (Zhang 2000, sec. 3.3)
WINDOW_PER_SQUARE = 0.25  # half width of the refinement window over the shortest side of a square in the picture
SMALLEST_WINDOW = 2  # pixels
OUTLIER_RATIO, OUTLIER_FLOOR = (
    4.0,
    1.0,
)  # a view this many times the median error and above this many pixels is left out


@dataclass(frozen=True)
class LensCalibration:
    """What several views of a board say about a lens.

    Parameters
    ----------
    size : (width, height), pixels
    matrix : (3, 3) float64, pixels
    distortion : (5,) float64, k1 k2 p1 p2 k3
    rms_px : float
        Root mean square reprojection error over all corners used.
    view_errors_px : (V,) float64
        The same for each picture given; NaN where no board was found or the view was left out.
    focal_sd_px : (2,) float64
        Standard deviations of fx and fy, from the fit's curvature.
    """

    size: tuple[int, int]
    matrix: np.ndarray
    distortion: np.ndarray
    rms_px: float
    view_errors_px: np.ndarray
    focal_sd_px: np.ndarray


@dataclass(frozen=True)
class BoardPose:
    """Where a camera stands with respect to a board that lies on the floor: world x along a row, z up.

    Parameters
    ----------
    rotation : (3, 3) float64, world to camera
    translation : (3,) float64, metres
    rms_px : float
        Root mean square reprojection error of the corners.
    """

    rotation: np.ndarray
    translation: np.ndarray
    rms_px: float


def find_corners(picture: np.ndarray, inner_corners: tuple[int, int]) -> np.ndarray | None:
    """The board's inner corners in a picture, or None where it is not seen whole.

    Parameters
    ----------
    picture : (H, W, 3) or (H, W) uint8
    inner_corners : (columns, rows), between the squares: a board of 8 x 5 squares has (7, 4)

    Returns
    -------
    (rows, columns, 2) float64, pixels
    """
    import cv2

    _check_board(inner_corners)
    grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY) if picture.ndim == 3 else picture
    found, corners = cv2.findChessboardCorners(
        grey, inner_corners, flags=cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE
    )
    if not found:
        flags = cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_ACCURACY | cv2.CALIB_CB_NORMALIZE_IMAGE
        found, corners = cv2.findChessboardCornersSB(grey, inner_corners, flags=flags)
    if not found:
        return None
    columns, rows = inner_corners
    grid = np.asarray(corners, dtype=np.float32).reshape(rows, columns, 2)
    window = max(SMALLEST_WINDOW, round(WINDOW_PER_SQUARE * _shortest_side(grid)))
    stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 60, 1e-4)
    refined = cv2.cornerSubPix(grey, grid.reshape(-1, 1, 2).copy(), (window, window), (-1, -1), stop)
    return _black_first(grey, _right_handed(refined.reshape(rows, columns, 2).astype(np.float64)))


def lens_from_board(
    pictures: Sequence[np.ndarray],
    inner_corners: tuple[int, int],
    square_m: float,
    *,
    radial_terms: int = 2,
) -> LensCalibration:
    """Matrix and distortion of a lens from pictures of a board held in several ways.

    Parameters
    ----------
    pictures : sequence of (H, W, 3) or (H, W) uint8, all of one size
    inner_corners : (columns, rows)
    square_m : side of a square, metres
    radial_terms : 0-3
        How many of k1 k2 k3 are fitted. The third is free to overfit where corners stay away from the border; only
        wide lenses need it.

    Raises
    ------
    InputError
        When pictures differ in size or the board is seen in fewer than three.
    """
    if not len(pictures):
        raise InputError("calibration pictures", expected=f"at least {FEWEST_VIEWS}", got="none")
    shapes = {picture.shape[:2] for picture in pictures}
    if len(shapes) > 1:
        sizes = ", ".join(f"{width} x {height}" for height, width in sorted(shapes))
        raise InputError("calibration pictures", expected="one size", got=sizes)
    found = [find_corners(picture, inner_corners) for picture in pictures]
    height, width = shapes.pop()
    return fit_lens(found, (width, height), square_m, radial_terms=radial_terms)


def fit_lens(
    views: Sequence[np.ndarray | None], size: tuple[int, int], square_m: float, *, radial_terms: int = 2
) -> LensCalibration:
    """`lens_from_board` for corners found already: (rows, columns, 2) float64 pixels a view, or None.

    Views whose error stands out (a board read askew) are left out, one at a time, the worst first.
    """
    if radial_terms not in (0, 1, 2, 3):
        raise InputError("radial terms", expected="0, 1, 2 or 3", got=str(radial_terms))
    used = {index: view for index, view in enumerate(views) if view is not None}
    while True:
        if len(used) < FEWEST_VIEWS:
            raise InputError(
                "calibration pictures",
                expected=f"the board in at least {FEWEST_VIEWS}",
                got=f"{len(used)} of {len(views)}",
                remedy="check the number of inner corners, and that the whole board is in view and sharp",
            )
        fit, errors = _fit_once(list(used.values()), size, square_m, radial_terms)
        worst = int(np.argmax(errors))
        if errors[worst] <= max(OUTLIER_FLOOR, OUTLIER_RATIO * float(np.median(errors))):
            break
        used.pop(list(used)[worst])
    view_errors = np.full(len(views), np.nan)
    view_errors[list(used)] = errors
    return LensCalibration(size, view_errors_px=view_errors, **fit)


def place_on_floor(corners: np.ndarray, square_m: float, matrix: np.ndarray, distortion: np.ndarray) -> BoardPose:
    """Place of a camera from one view of a board lying on the floor; the world is the board's, with z up.

    The origin is the first corner, x runs along the first row and y against the columns.

    Parameters
    ----------
    corners : (rows, columns, 2) float64, pixels, as from `find_corners`
    square_m : side of a square, metres
    matrix : (3, 3) float64, pixels
    distortion : (5,) float64, k1 k2 p1 p2 k3
    """
    import cv2

    board = board_points(corners.shape[1], corners.shape[0], square_m)
    pixels = corners.reshape(-1, 2)
    floor = board * (1.0, -1.0, 1.0)  # columns run down the picture: z is up only if y runs against them
    _, vectors, shifts, _ = cv2.solvePnPGeneric(floor, pixels, matrix, distortion, flags=cv2.SOLVEPNP_IPPE)
    poses = [_refined_pose(floor, pixels, matrix, distortion, pair) for pair in zip(vectors, shifts, strict=True)]
    best = min(poses, key=lambda pose: pose.rms_px)
    if (best.rotation.T @ best.translation)[2] >= 0:
        raise InputError("board on the floor", expected="a camera above it", got="corners in mirrored order")
    return best


def camera_from_board(name: str, lens: LensCalibration, pose: BoardPose) -> Camera:
    """The two halves of a calibration put together."""
    return Camera(name, lens.size, lens.matrix, lens.distortion, pose.rotation, pose.translation)


def board_points(columns: int, rows: int, square_m: float) -> np.ndarray:
    """(rows * columns, 3) float64, metres: x along a row, y along a column, z = 0."""
    if not (np.isfinite(square_m) and square_m > 0):
        raise InputError("board square", expected="a side in metres > 0", got=str(square_m))
    x, y = np.meshgrid(np.arange(columns) * square_m, np.arange(rows) * square_m)
    return np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)


def _fit_once(
    views: list[np.ndarray], size: tuple[int, int], square_m: float, radial_terms: int
) -> tuple[dict, np.ndarray]:
    """One run of cv2.calibrateCamera: the fields of `LensCalibration`, and the error of each view."""
    import cv2

    fixed = (cv2.CALIB_FIX_K1, cv2.CALIB_FIX_K2, cv2.CALIB_FIX_K3)[radial_terms:]
    boards = [board_points(view.shape[1], view.shape[0], square_m).astype(np.float32) for view in views]
    pixels = [view.reshape(-1, 1, 2).astype(np.float32) for view in views]
    rms, matrix, distortion, _, _, deviations, _, errors = cv2.calibrateCameraExtended(  # type: ignore[call-overload]
        boards, pixels, size, None, None, flags=sum(fixed)
    )
    fit = {
        "matrix": matrix,
        "distortion": np.asarray(distortion, dtype=np.float64).ravel()[:5],
        "rms_px": float(rms),
        "focal_sd_px": np.asarray(deviations, dtype=np.float64).ravel()[:2],
    }
    return fit, np.asarray(errors, dtype=np.float64).ravel()


def _refined_pose(
    floor: np.ndarray, pixels: np.ndarray, matrix: np.ndarray, distortion: np.ndarray, start: tuple
) -> BoardPose:
    """A planar solution after Levenberg-Marquardt on the pixels."""
    import cv2

    vector, shift = cv2.solvePnPRefineLM(floor, pixels, matrix, distortion, start[0].copy(), start[1].copy())
    seen, _ = cv2.projectPoints(floor, vector, shift, matrix, distortion)
    rms = float(np.sqrt(np.mean(np.sum((seen.reshape(-1, 2) - pixels) ** 2, axis=-1))))
    return BoardPose(rotation_from_vector(vector.ravel()), np.asarray(shift, dtype=np.float64).ravel(), rms)


def _shortest_side(grid: np.ndarray) -> float:
    """Pixels between the nearest two neighbouring corners."""
    return min(float(np.linalg.norm(np.diff(grid, axis=axis), axis=-1).min()) for axis in (0, 1))


def _right_handed(grid: np.ndarray) -> np.ndarray:
    """The grid with columns running clockwise from rows, as a board seen from its front has them."""
    along_row, along_column = grid[0, -1] - grid[0, 0], grid[-1, 0] - grid[0, 0]
    clockwise = along_row[0] * along_column[1] - along_row[1] * along_column[0] > 0
    return grid if clockwise else grid[:, ::-1].copy()


def _black_first(grey: np.ndarray, grid: np.ndarray) -> np.ndarray:
    """The grid, turned by half a turn if that puts a black square between its first corners."""
    first, last = (_brightness(grey, grid, corner) for corner in (0, -2))
    return grid[::-1, ::-1].copy() if first > last and sum(grid.shape[:2]) % 2 == 1 else grid


def _brightness(grey: np.ndarray, grid: np.ndarray, corner: int) -> float:
    """Of the pixel in the middle of the square that follows a corner along the grid's diagonal."""
    following = corner + 1
    x, y = (grid[corner, corner] + grid[following, following] + grid[corner, following] + grid[following, corner]) / 4
    return float(grey[round(y), round(x)])


def _check_board(inner_corners: tuple[int, int]) -> None:
    if min(inner_corners) < 3:
        raise InputError(
            "board",
            expected="at least 3 x 3 inner corners",
            got=f"{inner_corners[0]} x {inner_corners[1]}",
            remedy="count where four squares meet, not the squares",
        )
