"""A trained regressor as a tracker's guesser: one guess a camera, turned into the world and put together.

Sedai et al. (2013), IV-B, turn the guess by the angle between training and test camera, and do not say whose descriptor
is used with several cameras. Here the heading is relative to the ray that the person is seen along, and all cameras are
asked: one mixture, each weighed by its own alpha (`regression.combined`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from muybridge.body import Body
from muybridge.cameras.model import Camera
from muybridge.filters import Guess
from muybridge.io.job import Job
from muybridge.likelihood.observation import ImageLikelihood
from muybridge.regression import (
    PoseMixture,
    PoseOutputs,
    SilhouetteRegressor,
    bearing,
    combined,
    describe,
    load_regressor,
    turned,
)
from muybridge.regression.model_file import require_components

SHIPPED = Path(__file__).parents[1] / "regression" / "models" / "person.npz"
FEWEST_PIXELS = 200  # a smaller silhouette shows too little of a pose
#: How much the cameras vote for each other's modes, see `regression.combined`. Without votes a draw is 56 mm worse;
#: from .1 to 1 there is no difference: docs/benchmarks.md, "The guided Gaussian-process filter".
AGREEMENT = 0.3


@dataclass(frozen=True, eq=False)
class SilhouetteGuesser:
    """Guesses poses of a body from masks.

    Parameters
    ----------
    regressor : SilhouetteRegressor
    body : Body
        The tracked one.
    cameras : of the masks, reduced as they are
    agreement : float
        See `regression.combined`.
    only : int, optional
        The camera that is asked; all where absent.
    """

    regressor: SilhouetteRegressor
    body: Body
    cameras: tuple[Camera, ...]
    agreement: float = AGREEMENT
    only: int | None = None

    def __post_init__(self) -> None:
        require_components("regressor", self.regressor, PoseOutputs(self.body).components)

    @classmethod
    def of(cls, regressor: SilhouetteRegressor, model: ImageLikelihood, **settings: float) -> SilhouetteGuesser:
        """For the masks that a likelihood sees."""
        cameras = tuple(c.scaled(1.0 / factor) for c, factor in zip(model.rig, model.reductions, strict=True))
        return cls(regressor, model.body, cameras, **settings)  # type: ignore[arg-type]

    def mixture(self, masks: Sequence[np.ndarray]) -> PoseMixture | None:
        """p(y | x) of one frame's masks, headings in the world; None where no camera sees the person whole."""
        found = []
        for index, (camera, mask) in enumerate(zip(self.cameras, masks, strict=True)):
            if self.only not in (None, index) or np.count_nonzero(mask) < FEWEST_PIXELS:
                continue
            seen = describe(mask, self.regressor.config.descriptor)
            if not seen.touches_border:
                found.append(turned(self.regressor.predict(seen.values), bearing(camera, seen.centre)))
        return combined(found, self.regressor.config.trusted_variance, self.agreement) if found else None

    def guess(self, masks: Sequence[np.ndarray]) -> Guess | None:
        """The mixture as a filter takes it: over the body's turns, its place left open."""
        mixture = self.mixture(masks)
        if mixture is None:
            return None
        means = PoseOutputs(self.body).to_poses(mixture.means, np.zeros(3))[:, 3:]
        trusted = self.regressor.config.trusted_variance
        return Guess(mixture.weights, means, mixture.variances, np.arange(3, 3 + means.shape[1]), trusted)


def guesser_of_job(job: Job, model: ImageLikelihood) -> SilhouetteGuesser | None:
    """The guesser that a job asks for; None where it asks for none, or the shipped one knows no such body."""
    if job.guess.model == "none":
        return None
    if job.guess.file is not None:
        return SilhouetteGuesser.of(_loaded(job.guess.file), model)
    shipped = _loaded(SHIPPED)
    same = model.body.dof_names[3:] == shipped.components.names
    same = same and PoseOutputs(model.body).components == shipped.components
    return SilhouetteGuesser.of(shipped, model) if same else None


@lru_cache(maxsize=2)
def _loaded(path: Path) -> SilhouetteRegressor:
    return load_regressor(path)
