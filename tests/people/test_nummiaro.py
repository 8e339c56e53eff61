"""The comparison method: its likelihood from its own definition, and its update threshold."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.people.nummiaro import NummiaroConfig, NummiaroTarget
from reference.cumulative import ellipse_histogram


@pytest.fixture
def picture() -> np.ndarray:
    image = np.random.default_rng(1).integers(100, 160, (40, 50, 3), dtype=np.uint8)
    image[10:30, 15:27] = (20, 200, 60)
    return image


STATE = np.array([20.5, 19.5, 12.0, 20.0, 0.0, 0.0])


def test_by_its_definition(picture: np.ndarray) -> None:
    target = NummiaroTarget.learn(picture, STATE, NummiaroConfig(spread=0.2))
    states = np.array([STATE, STATE + [4, 1, 0, 0, 0, 0], [40.0, 12.0, 9.0, 17.0, 0, 0], [-90.0, 0, 5, 5, 0, 0]])
    q = ellipse_histogram(picture, STATE)
    rho = np.array([np.sqrt(ellipse_histogram(picture, state) * q).sum() for state in states[:3]])
    found = target.observe(picture).log_prob(states)
    np.testing.assert_allclose(found[:3], -0.5 * np.maximum(0, 1 - rho) / 0.2**2, rtol=0, atol=1e-10)
    assert np.isneginf(found[3]) and found[0] > found[1] > found[2]


def test_no_update_from_a_poor_match(picture: np.ndarray) -> None:
    seen = NummiaroTarget.learn(picture, np.array([40.0, 12.0, 9.0, 17.0])).histogram
    eager = NummiaroTarget.learn(picture, STATE, NummiaroConfig(update_rate=0.5))
    wary = NummiaroTarget.learn(picture, STATE, NummiaroConfig(update_rate=0.5, update_above=0.1))
    np.testing.assert_allclose(eager.updated(seen).histogram, 0.5 * (eager.histogram + seen))
    assert wary.updated(seen) is wary
    np.testing.assert_allclose(wary.updated(wary.histogram).histogram, wary.histogram)


def test_bad_settings_are_one_line() -> None:
    with pytest.raises(InputError, match="Nummiaro"):
        NummiaroConfig(spread=-1)
