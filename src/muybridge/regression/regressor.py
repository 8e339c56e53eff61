"""Silhouette -> pose mixture: clusters, a Gaussian process regression in each, and the gate (Sedai 2013, III-B).

Inputs are standardised by one shift and one scale for all numbers of the descriptor, so that their total variance is 1:
distances are then those of the silhouettes themselves, low-pass filtered, whichever of the coefficients they are in.
Outputs are treated in `cluster_regression`. The heading among them is relative to the camera, see `outputs`.

Cost: a prediction takes one vector-matrix product of N x N numbers for each cluster that the gate does not rule out.
Training is an eigendecomposition of N x N numbers for each of about a dozen length scales a cluster; clusters are
learnt side by side in threads, each with one thread of linear algebra, so that their number changes no result.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from threadpoolctl import threadpool_limits

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.regression import clusters as clusters_module
from muybridge.regression import descriptor as descriptors_module
from muybridge.regression.cluster_regression import ClusterExamples, ClusterRegression, RegressionConfig, learn
from muybridge.regression.clusters import ClusterConfig, cluster_poses
from muybridge.regression.components import PoseComponents
from muybridge.regression.descriptor import DescriptorConfig
from muybridge.regression.gate import GateConfig, LogisticGate, by_variance, fit_gate
from muybridge.regression.mixture import PRINTED_TRUSTED_VARIANCE, PoseMixture


@dataclass(frozen=True, kw_only=True)
class Config:
    """Settings of a regressor."""

    descriptor: DescriptorConfig = descriptors_module.WORKING  # how its inputs are made
    clusters: ClusterConfig = clusters_module.WORKING
    regression: RegressionConfig = RegressionConfig()
    gate: Literal["logistic", "variance"] = "logistic"
    logistic: GateConfig = GateConfig(landmarks=400)
    negligible: float = 1e-3  # modes of smaller weight are left out
    trusted_variance: float = PRINTED_TRUSTED_VARIANCE  # lambda of (19), square radians; see `calibration`

    def __post_init__(self) -> None:
        if self.gate not in ("logistic", "variance"):
            raise InputError("gate", expected="logistic | variance", got=repr(self.gate))
        if not 0 <= self.negligible < 1:
            raise InputError("negligible weight", expected="0 or more, below 1", got=repr(self.negligible))
        if not self.trusted_variance > 0:
            raise InputError("trusted variance (lambda)", expected="above 0", got=repr(self.trusted_variance))


PRINTED = Config(
    descriptor=descriptors_module.PRINTED,
    clusters=clusters_module.PRINTED,
    regression=RegressionConfig(sharing="none", choice="random"),
    logistic=GateConfig(),
)
WORKING = Config()


@dataclass(frozen=True, eq=False)
class SilhouetteRegressor:
    """A learnt regression.

    Parameters
    ----------
    components : what the D numbers of a pose are
    body : name of the body whose poses they are
    centre : (F,) float64; scale : float, of the descriptors
    clusters : K regressions
    gate : None where the variances decide
    """

    components: PoseComponents
    body: str
    config: Config
    centre: FloatArray
    scale: float
    clusters: tuple[ClusterRegression, ...]
    gate: LogisticGate | None = None

    def predict(self, descriptor: FloatArray) -> PoseMixture:
        """p(y | x) of (10), headings relative to the camera. descriptor : (F,) float64."""
        descriptor = np.asarray(descriptor, dtype=np.float64)
        if descriptor.shape != self.centre.shape or not np.isfinite(descriptor).all():
            expected = f"shape {self.centre.shape}, finite: as the regressor was trained"
            raise InputError("descriptor", expected=expected, got=f"shape {descriptor.shape}")
        x = (descriptor - self.centre) / self.scale
        if self.gate is None:
            found = [cluster.predict(x) for cluster in self.clusters]
            weights = by_variance(np.array([variances for _, variances in found]))
            used = np.flatnonzero(weights >= self.config.negligible)
            found = [found[mode] for mode in used]
        else:
            weights = np.exp(self.gate.log_prob(x[None])[0])
            used = np.flatnonzero(weights >= self.config.negligible)
            found = [self.clusters[mode].predict(x) for mode in used]
        means, variances = (np.array(part) for part in zip(*found, strict=True))
        return PoseMixture(self.components, weights[used], means, variances)

    def with_trusted_variance(self, trusted_variance: float) -> SilhouetteRegressor:
        """The same with another lambda of (19)."""
        return replace(self, config=replace(self.config, trusted_variance=trusted_variance))


def fit_regressor(
    rng: np.random.Generator,
    descriptors: FloatArray,
    poses: FloatArray,
    components: PoseComponents,
    config: Config = WORKING,
    *,
    facing: FloatArray | None = None,
    body: str = "",
    workers: int = 1,
) -> SilhouetteRegressor:
    """Learn from examples.

    Parameters
    ----------
    descriptors : (N, F) float64
        Made as `config.descriptor` says; other numbers may be appended.
    poses : (N, D) float64, radians
        The heading relative to the camera.
    facing : (N,) float64, radians, optional
        See `clusters.cluster_poses`; the heading where absent.
    body : name of the body, for the file
    workers : threads, one a cluster

    Raises
    ------
    InputError
        Arrays that do not fit together, and what `clusters.cluster_poses` refuses.
    """
    descriptors, poses = _checked(descriptors, components.checked("poses to learn from", poses))
    if facing is None:
        if components.heading is None:
            raise InputError("facing", expected="given, or a heading among the components", got="neither")
        facing = poses[:, components.heading]
    centre = descriptors.mean(axis=0)
    scale = float(np.sqrt(np.sum(descriptors.var(axis=0))))
    if scale == 0:
        raise InputError("descriptors to learn from", expected="some that differ", got="all alike")
    inputs = (descriptors - centre) / scale
    with threadpool_limits(limits=1, user_api="blas"):
        labels = cluster_poses(poses, np.asarray(facing, dtype=np.float64), components, config.clusters)
        count = config.clusters.count
        gate_rng, *generators = rng.spawn(count + 1)

        def learnt(cluster: int) -> ClusterRegression:
            members = labels == cluster
            own = learn(generators[cluster], inputs[members], poses[members], components, config.regression)
            return ClusterRegression(own)

        with ThreadPoolExecutor(max(1, workers)) as executor:
            clusters = tuple(executor.map(learnt, range(count)))
        gate = fit_gate(gate_rng, inputs, labels, count, config.logistic)[0] if config.gate == "logistic" else None
    return SilhouetteRegressor(components, body, config, centre, scale, clusters, gate)


def rebuilt(
    components: PoseComponents,
    body: str,
    config: Config,
    centre: FloatArray,
    scale: float,
    examples: Sequence[ClusterExamples],
    gate: LogisticGate | None,
) -> SilhouetteRegressor:
    """A regressor from what a file holds of it."""
    with threadpool_limits(limits=1, user_api="blas"):
        clusters = tuple(ClusterRegression(own) for own in examples)
    return SilhouetteRegressor(components, body, config, centre, scale, clusters, gate)


def _checked(descriptors: FloatArray, poses: FloatArray) -> tuple[FloatArray, FloatArray]:
    descriptors = np.asarray(descriptors, dtype=np.float64)
    if descriptors.ndim != 2 or len(descriptors) != len(poses) or not np.isfinite(descriptors).all():
        expected = f"shape ({len(poses)}, F) as there are poses, finite"
        raise InputError("descriptors to learn from", expected=expected, got=f"shape {descriptors.shape}")
    return descriptors, poses
