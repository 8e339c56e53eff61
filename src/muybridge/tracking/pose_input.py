"""A job's `[start]` table made a first pose: from a pose file, a reference's joints, or none (found automatically)."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from muybridge.body import Body
from muybridge.body.bodytrack import bodytrack_pose
from muybridge.datasets.bodytrack import read_poses
from muybridge.errors import InputError
from muybridge.io.job import Job
from muybridge.io.run_folder import read_pose
from muybridge.tracking.spread import joint_slopes

JOINT_SD, TURN_SD = 0.02, 1.0  # metres, radians: how closely joints are met, how freely angles move
HEADINGS = 8
STEPS, SETTLED = 30, 1e-4  # Gauss-Newton steps a frame at most, and the change (metres, radians) that ends them
LARGEST_TURN = 0.3  # radians a step


def first_pose(job: Job, body: Body, frame: int) -> np.ndarray | None:
    """(D,) pose in the first frame; None where it is to be found automatically."""
    if job.start.pose == "auto":
        return None
    if job.start.pose == "reference":
        return _from_reference(job, body, frame if job.start.frame is None else job.start.frame)
    return read_first_pose(Path(job.start.pose), body)


def read_first_pose(path: Path, body: Body) -> np.ndarray:
    """A pose from a file: a pose.csv (its first row), TOML of degrees of freedom, or bodytrack's 31 numbers."""
    if path.suffix == ".toml":
        try:
            table = tomllib.loads(path.read_text(encoding="utf8"))
        except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            raise InputError(f"first pose {path}", expected="a TOML file", got=str(error)) from error
        return _named_pose(path, body, table)
    if path.suffix == ".csv":
        series = read_pose(path)
        if not len(series.poses):
            raise InputError(f"first pose {path}", expected="at least one row", got="none")
        return _named_pose(path, body, dict(zip(series.names, series.poses[0].tolist(), strict=True)))
    if body.name != "bodytrack":
        raise InputError(
            f"first pose {path}", expected="a pose.csv or a TOML file of angles", got=path.suffix or "no suffix"
        )
    return bodytrack_pose(read_poses(path)[0])


def _named_pose(path: Path, body: Body, table: dict[str, float]) -> np.ndarray:
    unknown = [name for name in table if name not in body.dof_names]
    if unknown:
        raise InputError(
            f"first pose {path}: {unknown[0]!r}",
            expected=f"a degree of freedom of {body.name!r}",
            remedy=f"they are {', '.join(body.dof_names)}",
        )
    for name, value in table.items():
        if not isinstance(value, int | float):
            raise InputError(f"first pose {path}: {name}", expected="a number", got=repr(value))
    pose = np.array([float(table.get(name, 0.0)) for name in body.dof_names])
    if not np.isfinite(pose).all():
        raise InputError(f"first pose {path}", expected="finite numbers", got="nan or inf")
    return pose


def _from_reference(job: Job, body: Body, frame: int) -> np.ndarray:
    from muybridge.evaluation import read_truth

    assert job.reference is not None
    series = read_truth(job.reference.file, axes=job.reference.axes)
    rows = np.flatnonzero(series.frames == frame)
    if not len(rows):
        raise InputError(f"reference {job.reference.file}", expected=f"frame {frame}", got="no such frame")
    known = {
        name: point
        for name, point in zip(series.names, series.positions[rows[0]], strict=True)
        if np.isfinite(point).all() and name in body.joint_names
    }
    return pose_from_joints(body, known)


def pose_from_joints(body: Body, joints: dict[str, np.ndarray]) -> np.ndarray:
    """The pose (D,) whose joints come nearest to given ones (metres, world), from the best of several headings."""
    from scipy.optimize import least_squares

    if len(joints) < 4:
        raise InputError("joints for a first pose", expected="at least 4 that the body has", got=str(len(joints)))
    index = [body.joint_names.index(name) for name in joints]
    target = np.array(list(joints.values()))
    rest = np.clip(np.zeros(len(body.dof_names)), body.lower, body.upper)
    rest[:3] += target.mean(axis=0) - body.joints(rest)[index].mean(axis=0)

    def residuals(pose: np.ndarray, start: np.ndarray) -> np.ndarray:
        away = (body.joints(pose)[index] - target).ravel() / JOINT_SD
        return np.concatenate([away, (pose - start)[3:] / TURN_SD])

    best = None
    for heading in range(HEADINGS):
        start = rest.copy()
        start[body.dof_names.index("root_yaw")] = 2 * np.pi * heading / HEADINGS
        found = least_squares(
            residuals, start, args=(start,), bounds=(body.lower - 1e-9, body.upper + 1e-9), max_nfev=60
        )
        if best is None or found.cost < best.cost:
            best = found
    assert best is not None
    return np.clip(best.x, body.lower, body.upper)


def poses_from_joints(body: Body, names: Sequence[str], joints: np.ndarray) -> np.ndarray:
    """(T, D) the poses whose joints come nearest to (T, J, 3), metres, world; NaN for a joint that is not known.

    What joints do not tell, such as the twist of a straight arm, is as the body mostly has it: a pose depends on its
    own joints and on nothing before, but for the side from which a turn that may be made both ways is reached.
    """
    columns = [j for j, name in enumerate(names) if name in body.joint_names]
    index = np.array([body.joint_names.index(names[j]) for j in columns])
    known = {names[j]: joints[0, j] for j in columns if np.isfinite(joints[0, j]).all()}
    pose = pose_from_joints(body, known)
    poses = []
    for target in joints[:, columns]:
        pose = _followed(body, pose, index, target)
        poses.append(pose)
    return np.array(poses)


def _followed(body: Body, pose: np.ndarray, index: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Gauss-Newton from a pose (D,) to the one whose joints `index` are nearest to a target (B, 3)."""
    seen = np.isfinite(target).all(axis=1)
    index, target = index[seen], target[seen]
    mean, sd = body.usual
    usual = np.diag(1.0 / np.minimum(sd, 1e3) ** 2)
    for _ in range(STEPS):
        slopes = joint_slopes(body, pose)[index].reshape(-1, pose.size) / JOINT_SD
        away = ((target - body.joints(pose)[index]) / JOINT_SD).ravel()
        pull = slopes.T @ away + usual @ (mean - pose)
        step = np.linalg.solve(slopes.T @ slopes + usual, pull)
        step *= min(1.0, LARGEST_TURN / max(float(np.abs(step).max()), 1e-12))
        moved = np.clip(pose + step, body.lower, body.upper)
        settled = float(np.abs(moved - pose).max()) < SETTLED
        pose = moved
        if settled:
            break
    return pose
