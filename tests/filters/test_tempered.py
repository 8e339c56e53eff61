"""The tempered filter: its bridge of exponents. That it ends in the posterior is test_against_kalman's business."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from filters.oracles import GaussianLikelihood
from muybridge.errors import InputError
from muybridge.filters import GaussianWalk, tempered

CONFIG = tempered.Config(particles=400, layers=8, survival=0.5, estimate="mean", resampling="systematic")


def run(config: tempered.Config, sd: float = 0.3):
    rng = np.random.default_rng(0)
    state = tempered.init(rng, np.zeros(3), np.zeros(3), config)
    return tempered.step(rng, state, GaussianLikelihood(np.ones(3), sd), GaussianWalk(np.ones(3)), config)


def test_exponents_rise_to_the_sharpness_and_stay() -> None:
    _, info = run(CONFIG)
    assert (np.diff(info.exponents) >= 0).all() and info.exponents[-1] == 1.0 and info.remedy == ""
    rising = info.exponents < 1.0
    np.testing.assert_allclose(info.survival_rate[rising], 0.5, rtol=2e-3)  # schedule.TOLERANCE, twice
    assert (info.survival_rate[np.concatenate(([False], ~rising[:-1]))] > 0.999).all()  # no rise, no selection


def test_too_few_layers_say_so() -> None:
    state, info = run(replace(CONFIG, layers=2), sd=0.01)
    assert info.exponents[-1] < 1.0 and "more layers" in info.remedy and not info.collapsed
    assert np.isfinite(state.estimate).all()


def test_final_weights_are_equal() -> None:
    state, info = run(CONFIG)
    np.testing.assert_allclose(state.log_weights, -np.log(400))
    assert info.ess == pytest.approx(400)


def test_maximum_takes_the_prior_into_account() -> None:
    """Likelihood sd 1 about 1, walk sd 1 from 0: the posterior's mode is .5, and the best of 3000 draws lies near it.

    In three dimensions with posterior sd .71 the nearest of 3000 is about .71 (3 sqrt(pi / 2) / 3000)^(1/3) = .08 from
    the mode; the bound leaves a factor of 4 for copies and ties.
    """
    state, _ = run(replace(CONFIG, estimate="maximum", particles=3000), sd=1.0)
    np.testing.assert_allclose(state.estimate, 0.5, atol=0.3)


@pytest.mark.parametrize(("setting", "value"), [("layers", 0), ("survival", 0.0), ("c", -1.0), ("shrink", 1.1)])
def test_bad_settings(setting: str, value: object) -> None:
    with pytest.raises(InputError, match=setting):
        replace(CONFIG, **{setting: value})
