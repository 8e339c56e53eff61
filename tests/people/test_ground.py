"""What a line on the ground says about boxes."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.people.ground import GroundScale


def test_a_child_on_the_same_ground() -> None:
    ground = GroundScale(10.0, 0.3, 0.4)
    np.testing.assert_allclose(ground.of_person(0.7).height(200.0), 0.7 * ground.height(200.0))


def test_usual_sizes_are_the_likeliest() -> None:
    ground = GroundScale(10.0, 0.3, 0.4)
    box = ground.standing(np.array([100.0]), np.array([200.0]))
    states = np.repeat(box, 5, axis=0)
    states[1:3, 3] *= (0.8, 1.2)
    states[3:, 2] *= (0.8, 1.2)
    log_prob = ground.log_prob(states)
    assert log_prob[0] == 0 and (log_prob[1:] < -3).all()


def test_bad_settings_are_one_line() -> None:
    with pytest.raises(InputError, match="ground scale"):
        GroundScale(np.nan, 0.3, 0.4)
