"""Lens distortion with five coefficients (Brown-Conrady, as in OpenCV), and its inverse.

Points here are normalised: camera coordinates divided by depth, so that (0, 0) is the optical axis and the unit is
the tangent of the angle off the axis.

    x_d = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
    y_d = y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

NEWTON_STEPS = 50  # converges in 4-6 for lenses in use; near the fold it slows down to halving its step
WIDEST = 1e3  # tangent of the widest angle off the axis that is looked for, 0.06 degrees short of 90
BISECTIONS = 40  # from 1e3 to 1e-9
RESIDUAL_LIMIT = 1e-10  # normalised; 1e-7 px at a focal length of 1000 px


def distort(points: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """Where the lens moves normalised points.

    Parameters
    ----------
    points : (..., 2) float64, normalised
    coefficients : (5,) float64, k1 k2 p1 p2 k3

    Returns
    -------
    (..., 2) float64, normalised and distorted
    """
    k1, k2, p1, p2, k3 = coefficients
    x, y = points[..., 0], points[..., 1]
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    bent = np.empty(points.shape)
    bent[..., 0] = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    bent[..., 1] = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    return bent


def undistort(points: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """Inverse of `distort` by Newton's method; NaN where no undistorted point exists (beyond the fold).

    Starting at the distorted point the radial part converges from one side only where it is concave (a barrel) or
    convex (a pincushion). Points that are not found so, as under a moustache lens, start again at the inverse of the
    radial part.

    Parameters
    ----------
    points : (..., 2) float64, normalised and distorted
    coefficients : (5,) float64, k1 k2 p1 p2 k3

    Returns
    -------
    (..., 2) float64, normalised
    """
    target = np.asarray(points, dtype=np.float64)
    if not np.any(coefficients):
        return target.copy()
    straight = _newton(target, target, coefficients)
    lost = np.isnan(straight).any(axis=-1) & np.isfinite(target).all(axis=-1)
    if np.any(lost):
        straight[lost] = _newton(_radially_undistorted(target[lost], coefficients), target[lost], coefficients)
    return straight


def _newton(start: np.ndarray, target: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """Newton's method from a start; NaN where it ends beyond the fold or off its target."""
    straight = start.copy()
    with np.errstate(all="ignore"):
        for _ in range(NEWTON_STEPS):
            step = _newton_step(straight, target, coefficients)
            straight = straight - step
            if not np.any(np.abs(step) > 1e-11 * (1 + np.abs(straight))):  # squared by the next step: rounding
                break
        residual = np.abs(distort(straight, coefficients) - target).max(axis=-1)
        r2 = np.sum(straight * straight, axis=-1)
        close = residual <= RESIDUAL_LIMIT * (1 + np.abs(target).max(axis=-1))
        solved = close & (r2 < fold_radius_squared(coefficients))
    straight[~solved] = np.nan
    return straight


def _radially_undistorted(target: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """The inverse of the radial part alone, by bisection: up to the fold it grows, so it is never missed."""
    k1, k2, _, _, k3 = coefficients
    reach = np.linalg.norm(target, axis=-1)
    low = np.zeros_like(reach)
    high = np.full_like(reach, min(np.sqrt(fold_radius_squared(coefficients)), WIDEST))
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        r2 = middle * middle
        short = middle * (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) < reach
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    return target * np.divide(low, reach, out=np.ones_like(reach), where=reach > 0)[..., None]


def _newton_step(points: np.ndarray, target: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """J^-1 (distort(points) - target), with the symmetric 2 x 2 Jacobian written out."""
    k1, k2, p1, p2, k3 = coefficients
    x, y = points[..., 0], points[..., 1]
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3))
    j_xx = radial + slope * x * x + 2 * p1 * y + 6 * p2 * x
    j_xy = slope * x * y + 2 * p1 * x + 2 * p2 * y
    j_yy = radial + slope * y * y + 6 * p1 * y + 2 * p2 * x
    off = distort(points, coefficients) - target
    determinant = j_xx * j_yy - j_xy * j_xy
    step = np.empty(points.shape)
    step[..., 0] = (j_yy * off[..., 0] - j_xy * off[..., 1]) / determinant
    step[..., 1] = (j_xx * off[..., 1] - j_xy * off[..., 0]) / determinant
    return step


def fold_radius_squared(coefficients: np.ndarray) -> float:
    """Squared normalised radius at which the radial part stops growing; infinite where it never does.

    Beyond it the polynomial folds the world back into the picture: a hand well outside the field of view would be
    drawn inside it.
    """
    k1, k2, _, _, k3 = (float(value) for value in coefficients)
    return _first_fold(k1, k2, k3)


@lru_cache(maxsize=256)
def _first_fold(k1: float, k2: float, k3: float) -> float:
    """Smallest positive root s = r^2 of d/dr [r (1 + k1 r^2 + k2 r^4 + k3 r^6)] = 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3."""
    series = [7 * k3, 5 * k2, 3 * k1, 1.0]
    # Leading terms this small bend nothing below 89 degrees, and would overflow the companion matrix.
    roots = np.roots([term if abs(term) > 1e-11 else 0.0 for term in series])
    positive = [root.real for root in roots if abs(root.imag) < 1e-9 * (1 + abs(root)) and root.real > 0]
    return min(positive, default=np.inf)
