"""Every row of the registry goes through every check; a filter that breaks the rules is caught by them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from filters import conformance
from filters.conformance import CHECKS
from muybridge.errors import InputError
from muybridge.filters import METHODS, CommonConfig, Method, condensation, method


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__.removeprefix("check_"))
def test_conforms(name: str, check) -> None:
    check(METHODS[name])


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize("preset", ["PRINTED", "WORKING"])
def test_presets_run(name: str, preset: str) -> None:
    row = METHODS[name]
    config = getattr(row, preset)
    assert isinstance(config, row.Config) and isinstance(config, CommonConfig)
    rng, state = conformance.start(row, config)
    state, info = row.step(rng, state, conformance.Scripted(), conformance.dynamics(), config)
    assert np.isfinite(state.estimate).all() and info.evaluations > 0


def test_rows_carry_their_names() -> None:
    assert all(row.name == name and row.description for name, row in METHODS.items())
    with pytest.raises(InputError, match="condensation"):
        method("kalman")


def broken(**changes) -> Method:
    return replace(METHODS["condensation"], **changes)


def drawing_from_a_global(rng, *arguments):
    return condensation.step(np.random.default_rng(), *arguments)


def forgetting_limits(rng, state, likelihood, dynamics, config):
    free = replace(dynamics, lower=np.full(len(dynamics.lower), -np.inf), upper=np.full(len(dynamics.upper), np.inf))
    return condensation.step(rng, state, likelihood, free, config)


def miscounting(rng, *arguments):
    state, info = condensation.step(rng, *arguments)
    return state, replace(info, evaluations=1)


def standing_still(rng, state, *arguments):
    return state, condensation.step(rng, state, *arguments)[1]


def knowing_nothing_usual(rng, state, likelihood, dynamics, config):
    anywhere = replace(dynamics, usual_sd=np.full(len(dynamics.usual_sd), np.inf))
    return condensation.step(rng, state, likelihood, anywhere, config)


@pytest.mark.parametrize(
    ("step", "check"),
    [
        (drawing_from_a_global, conformance.check_same_seed_same_bytes),
        (forgetting_limits, conformance.check_proposals_stay_within_limits),
        (miscounting, conformance.check_counts_its_evaluations),
        (standing_still, conformance.check_follows_a_motion),
        (knowing_nothing_usual, conformance.check_takes_what_is_usual_into_account),
    ],
)
def test_negative_controls(step, check) -> None:
    with pytest.raises(AssertionError):
        check(broken(step=step))
