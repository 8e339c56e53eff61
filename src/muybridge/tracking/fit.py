"""The body fitted to the person and the cameras to each other: Gauss-Newton over several frames at once.

Poses of F frames, one factor per length group, one per width and per depth group, and a shift of each camera's picture
are moved together until the outlines meet the masks' borders. Left and right share their measures. The weights,
residuals and slopes are those of `likelihood.contour`; the derivative by a length is how fast the segment's ends move
with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from muybridge.body.model import Body
from muybridge.likelihood.contour import ContourRows, robust_weights
from muybridge.likelihood.observation import ImageLikelihood, Observation

_STEP = 1e-4  # of a log length, for the numerical derivative of segment ends


@dataclass(frozen=True)
class FitConfig:
    """Settings of the fit."""

    lengths: bool = True
    girths: bool = True  # widths and depths
    cameras: bool = False  # a shift of each camera's picture
    length_sd: float = 0.03  # prior, of a log length; wider, and a straight leg's knee wanders
    girth_sd: float = 0.20  # prior, of a log width or depth
    shift_sd: float = 0.05  # prior, metres at the person
    pose_sd: float = 0.10  # pull to the poses given, radians; a tenth of it in metres
    spreads: tuple[float, ...] = (0.12, 0.08, 0.06, 0.05, 0.04) + 5 * (0.03,)  # metres, one an iteration


@dataclass(frozen=True, eq=False)
class Fit:
    """What the fit found.

    lengths, widths, depths : factor by group; shifts : (C, 2) pixels of the recorded pictures, to be added to the
    principal point; poses : (F, D); residual : root mean square weighted contour residual, metres.
    """

    lengths: dict[str, float]
    widths: dict[str, float]
    depths: dict[str, float]
    shifts: np.ndarray
    poses: np.ndarray
    residual: float


def fit_body(
    model: ImageLikelihood, observations: Sequence[Observation], poses: np.ndarray, config: FitConfig
) -> tuple[ImageLikelihood, Fit]:
    """The model with body (and cameras) fitted to F frames, and what was changed.

    Parameters
    ----------
    observations : F frames
    poses : (F, D) float64
        Where the person is about; the fit refines them.
    """
    problem = _Problem(model, config, np.asarray(poses)[:, :3])
    unknown = np.zeros(problem.size)
    poses = np.array(poses, float)
    given = poses.copy()
    residual = np.inf
    for spread in config.spreads:
        current = problem.apply(unknown)
        shape_h = problem.prior.copy()
        shape_g = -problem.prior @ unknown
        parts = []
        squares = total = 0.0
        for observation, pose, start in zip(observations, poses, given, strict=True):
            rows = replace(observation, model=current).contour(pose, spread)
            weights = robust_weights(rows.distance, spread) * current.camera_weights[rows.camera]
            squares, total = squares + float(weights @ rows.distance**2), total + float(weights.sum())
            weights = weights / current.row_sd**2
            pull = np.full(len(pose), config.pose_sd**-2)
            pull[:3] *= 100.0
            by_shape = problem.slopes(current.body, pose, rows)
            weighted = rows.slopes * weights[:, None]
            h_pose = weighted.T @ rows.slopes + np.diag(pull)
            g_pose = weighted.T @ rows.distance + pull * (start - pose)
            cross = weighted.T @ by_shape
            shape_h += (by_shape * weights[:, None]).T @ by_shape
            shape_g += by_shape.T @ (weights * rows.distance)
            parts.append((h_pose, g_pose, cross))
        # Schur complement: the poses are eliminated, the shared measures solved for, the poses found from them.
        reduced_h, reduced_g = shape_h.copy(), shape_g.copy()
        for h_pose, g_pose, cross in parts:
            solved = np.linalg.solve(h_pose, np.column_stack([cross, g_pose]))
            reduced_h -= cross.T @ solved[:, :-1]
            reduced_g -= cross.T @ solved[:, -1]
        change = np.linalg.solve(reduced_h, reduced_g) if problem.size else np.zeros(0)
        change = np.clip(change, -problem.largest, problem.largest)
        for f, (h_pose, g_pose, cross) in enumerate(parts):
            step = np.linalg.solve(h_pose, g_pose - cross @ change)
            step *= min(1.0, 0.3 / max(1e-9, np.abs(step[3:]).max()))
            poses[f] = np.clip(poses[f] + step, current.body.lower, current.body.upper)
        unknown = unknown + change
        residual = np.sqrt(squares / max(total, 1e-12))
    return problem.apply(unknown), problem.describe(unknown, poses, residual)


class _Problem:
    """The shared unknowns: log factors of lengths, widths, depths, then camera shifts in reduced pixels."""

    def __init__(self, model: ImageLikelihood, config: FitConfig, places: np.ndarray) -> None:
        self.model, self.config = model, config
        self.lengths = model.body.length_groups if config.lengths else ()
        self.girths = model.body.radius_groups if config.girths else ()
        views = len(model.rig) if config.cameras else 0
        counts = len(self.lengths), len(self.girths), len(self.girths), 2 * views
        self.ends = np.cumsum(counts)
        self.size = int(self.ends[-1])
        focal = np.sqrt(model.cameras[:, 0] * model.cameras[:, 1])
        depth = np.maximum(0.5, places.mean(axis=0) @ model.cameras[:, 17:20].T + model.cameras[:, 22])
        shift_sd = np.repeat(config.shift_sd * focal / depth, 2)[: 2 * views]
        sd = np.concatenate(
            [np.full(counts[0], config.length_sd), np.full(counts[1] + counts[2], config.girth_sd), shift_sd]
        )
        self.prior = np.diag(sd**-2.0)
        if views:
            self.prior[self.ends[2] :, self.ends[2] :] += _gauge(model, places) / np.median(shift_sd) ** 2 * 1e4
        self.largest = np.concatenate([np.full(sum(counts[:3]), 0.1), np.full(2 * views, 4.0)])
        self.groups = [segment.radius_group for segment in model.body.segments]

    def split(self, unknown: np.ndarray) -> list[np.ndarray]:
        """The unknowns (size,) by kind: log lengths, log widths, log depths, shifts (2 C,) in reduced pixels."""
        return np.split(unknown, self.ends[:-1])

    def apply(self, unknown: np.ndarray) -> ImageLikelihood:
        """The model with the unknowns (size,) put into its body and rig."""
        lengths, widths, depths, shifts = self.split(unknown)
        body = self.model.body.scaled(
            lengths=dict(zip(self.lengths, np.exp(lengths), strict=True)),
            widths=dict(zip(self.girths, np.exp(widths), strict=True)),
            depths=dict(zip(self.girths, np.exp(depths), strict=True)),
        )
        rig = self.model.rig
        if len(shifts):
            full = shifts.reshape(-1, 2) * np.array(self.model.reductions)[:, None]
            rig = type(rig)(tuple(c.shifted(dx, dy) for c, (dx, dy) in zip(rig, full, strict=True)))
        return replace(self.model, body=body, rig=rig)

    def slopes(self, body: Body, pose: np.ndarray, rows: ContourRows) -> np.ndarray:
        """(R, size) float64: metres the outline moves outwards with each shared unknown."""
        out = np.zeros((len(rows.distance), self.size))
        if self.lengths:
            out[:, : self.ends[0]] = self._length_slopes(body, pose, rows)
        for g, group in enumerate(self.girths):
            mine = np.array([own == group for own in self.groups])[rows.segment]
            out[mine, self.ends[0] + g] = rows.width[mine]
            out[mine, self.ends[1] + g] = rows.depth[mine]
        if self.config.cameras:
            index = np.arange(len(rows.distance))
            out[index, self.ends[2] + 2 * rows.camera] = rows.normal[:, 0] * rows.metres
            out[index, self.ends[2] + 2 * rows.camera + 1] = rows.normal[:, 1] * rows.metres
        return out

    def _length_slopes(self, body: Body, pose: np.ndarray, rows: ContourRows) -> np.ndarray:
        base, tip = _segment_ends(body, pose)
        columns = []
        for group in self.lengths:
            moved_base, moved_tip = _segment_ends(body.scaled(lengths={group: 1.0 + _STEP}), pose)
            d_base, d_tip = (moved_base - base) / _STEP, (moved_tip - tip) / _STEP
            place = rows.along[:, None]
            point = d_base[rows.segment] * (1.0 - place) + d_tip[rows.segment] * place
            columns.append(np.einsum("rk,rk->r", rows.slopes[:, :3], point))
        return np.column_stack(columns)

    def describe(self, unknown: np.ndarray, poses: np.ndarray, residual: float) -> Fit:
        """The unknowns (size,) as people read them, with poses (F, D) and the residual in metres."""
        lengths, widths, depths, shifts = self.split(unknown)
        full = np.zeros((len(self.model.rig), 2))
        if len(shifts):
            full = shifts.reshape(-1, 2) * np.array(self.model.reductions)[:, None]
        named = [
            dict(zip(names, np.exp(values).tolist(), strict=True))
            for names, values in ((self.lengths, lengths), (self.girths, widths), (self.girths, depths))
        ]
        return Fit(named[0], named[1], named[2], full, poses, float(residual))


def _gauge(model: ImageLikelihood, places: np.ndarray) -> np.ndarray:
    """(2C, 2C) projector on the shifts that only move the world: the same as if the person stood elsewhere."""
    centre = places.mean(axis=0)
    step = 1e-3
    moved = [
        np.concatenate([c.world_to_pixel(centre + step * axis) - c.world_to_pixel(centre) for c in model.rig])
        for axis in np.eye(3)
    ]
    basis = np.linalg.qr(np.column_stack(moved) / np.repeat(model.reductions, 2)[:, None])[0]
    return basis @ basis.T


def _segment_ends(body: Body, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Base and tip of every segment's shape in the world, (S, 3) each."""
    frames = body.frames(pose[None])[0]
    ends = np.einsum("sab,seb->sea", frames[..., :3], body.arrays.ends) + frames[:, None, :, 3]
    return ends[:, 0], ends[:, 1]
