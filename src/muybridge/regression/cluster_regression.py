"""One cluster's regression: descriptor -> every component of the pose, each with its variance.

What makes a Gaussian process of a cluster's frames: angles unwrapped around the cluster's middle, outputs brought to
mean 0 and variance 1, as many frames as can be afforded, and hyper-parameters shared as the settings say.

Angles that wrap are unwrapped, not turned into sine and cosine: a cluster faces one way, so that its angles lie within
half a turn of their middle, and the variance is that of the angle itself. Two outputs for one angle would need to be
brought back to the circle, and their variances with them. (Measured on made data in
`tests/regression/test_cluster_regression.py`: the same error inside a cluster. A single cluster of all headings has a
seam, which sine and cosine have not.)

A component that does not change within a cluster (a joint that nothing in the data turns) has its mean and the variance
`CONSTANT_VARIANCE`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from muybridge.errors import InputError
from muybridge.filters.particles import FloatArray
from muybridge.regression.components import PoseComponents
from muybridge.regression.gaussian_process import (
    GaussianProcess,
    HyperParameters,
    fit_hyper_parameters,
    squared_distances,
)
from muybridge.regression.shared_scale import SharedScaleProcess, fit_shared_scale

CONSTANT_SD = 1e-4  # radians; what changes less is constant
CONSTANT_VARIANCE = 1e-6  # square radians
Sharing = Literal["none", "scale", "all"]


@dataclass(frozen=True, kw_only=True)
class RegressionConfig:
    """Settings of a cluster's Gaussian processes."""

    sharing: Sharing = "scale"  # of hyper-parameters between outputs: none (the paper), theta_2, or all of them
    frames: int = 500  # of a cluster, at most; the cost grows with the cube
    choice: Literal["spread", "random"] = "spread"  # of the frames that are kept, where there are more
    searched: int = 500  # frames, at most, from which hyper-parameters are found; all are conditioned on

    def __post_init__(self) -> None:
        if self.sharing not in ("none", "scale", "all"):
            raise InputError("sharing of hyper-parameters", expected="none | scale | all", got=repr(self.sharing))
        if self.choice not in ("spread", "random"):
            raise InputError("choice of frames", expected="spread | random", got=repr(self.choice))
        if self.frames < 2 or self.searched < 2:
            raise InputError("frames of a cluster", expected="2 or more", got=str(min(self.frames, self.searched)))


@dataclass(frozen=True, eq=False)
class ClusterExamples:
    """What a cluster's regression is made of, and all that a file needs to hold.

    inputs : (N, F) float64, rounded to float32, standardised
    outputs : (N, D) float64, rounded to float32: (pose - middle) / sd, unwrapped; 0 where constant
    middle, sd : (D,) float64, radians; sd is 0 where constant
    hyper : one set a component, or a single one where all is shared
    """

    inputs: FloatArray
    outputs: FloatArray
    middle: FloatArray
    sd: FloatArray
    hyper: tuple[HyperParameters, ...]
    sharing: Sharing


def learn(
    rng: np.random.Generator,
    inputs: FloatArray,
    poses: FloatArray,
    components: PoseComponents,
    config: RegressionConfig,
) -> ClusterExamples:
    """Choose frames and find hyper-parameters. inputs : (N, F), standardised; poses : (N, D), radians."""
    kept = CHOICES[config.choice](rng, inputs, config.frames)
    inputs, poses = _as_stored(inputs[kept]), poses[kept]
    middle = components.middle(poses)
    away = components.wrapped(poses - middle)
    shift, sd = away.mean(axis=0), away.std(axis=0)
    sd = np.where(sd < CONSTANT_SD, 0.0, sd)
    outputs = _as_stored((away - shift) / np.where(sd > 0, sd, np.inf))
    changing = np.flatnonzero(sd > 0)
    searched = rng.permutation(len(inputs))[: config.searched]
    distances = squared_distances(inputs[searched], inputs[searched])
    hyper = SEARCHES[config.sharing](distances, outputs[np.ix_(searched, changing)]) if changing.size else []
    return ClusterExamples(inputs, outputs, components.wrapped(middle + shift), sd, tuple(hyper), config.sharing)


class ClusterRegression:
    """A cluster's Gaussian processes, ready to predict."""

    def __init__(self, examples: ClusterExamples) -> None:
        self.examples = examples
        self._changing = np.flatnonzero(examples.sd > 0)
        self._squares = np.sum(examples.inputs**2, axis=1)
        outputs, hyper = examples.outputs[:, self._changing], list(examples.hyper)
        distances = squared_distances(examples.inputs, examples.inputs)
        self._processes: list[GaussianProcess | SharedScaleProcess]
        if not self._changing.size:
            self._processes = []
        elif examples.sharing == "scale":
            self._processes = [SharedScaleProcess(distances, outputs, hyper)]
        elif examples.sharing == "all":
            self._processes = [GaussianProcess(distances, outputs, hyper[0])]
        else:
            self._processes = [GaussianProcess(distances, y[:, None], own) for y, own in zip(outputs.T, hyper)]

    def predict(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mean and variance, (D,) each, radians and their squares; not wrapped. x : (F,) float64, standardised."""
        distances = np.maximum(self._squares + x @ x - 2.0 * (self.examples.inputs @ x), 0.0)
        mean, variance = self.examples.middle.copy(), np.full(len(self.examples.sd), CONSTANT_VARIANCE)
        if self._processes:
            found = [process.predict(distances) for process in self._processes]
            scale = self.examples.sd[self._changing]
            mean[self._changing] += scale * np.concatenate([np.atleast_1d(own) for own, _ in found])
            variance[self._changing] = scale**2 * np.concatenate([np.atleast_1d(own) for _, own in found])
        return mean, variance


def _as_stored(values: FloatArray) -> FloatArray:
    """Rounded to what a file keeps, so that a model predicts the same once it was saved."""
    return values.astype(np.float32).astype(np.float64)


def _each(distances: FloatArray, outputs: FloatArray) -> list[HyperParameters]:
    return [fit_hyper_parameters(distances, output[:, None]) for output in outputs.T]


def _together(distances: FloatArray, outputs: FloatArray) -> list[HyperParameters]:
    return [fit_hyper_parameters(distances, outputs)]


SEARCHES: dict[str, Callable[[FloatArray, FloatArray], list[HyperParameters]]] = {
    "none": _each,
    "scale": fit_shared_scale,
    "all": _together,
}


def _at_random(rng: np.random.Generator, inputs: FloatArray, count: int) -> np.ndarray:
    """(n,) int, ascending: as many of N as are wanted."""
    return np.sort(rng.permutation(len(inputs))[:count])


def _spread_out(rng: np.random.Generator, inputs: FloatArray, count: int) -> np.ndarray:
    """(n,) int, ascending: one at random, then always the one that is furthest from those chosen."""
    if len(inputs) <= count:
        return np.arange(len(inputs))
    chosen = [int(rng.integers(len(inputs)))]
    nearest = squared_distances(inputs, inputs[chosen])[:, 0]
    while len(chosen) < count:
        chosen.append(int(np.argmax(nearest)))
        nearest = np.minimum(nearest, squared_distances(inputs, inputs[chosen[-1:]])[:, 0])
    return np.sort(chosen)


CHOICES: dict[str, Callable[[np.random.Generator, FloatArray, int], np.ndarray]] = {
    "spread": _spread_out,
    "random": _at_random,
}
