from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.regression.components import PoseComponents

COMPONENTS = PoseComponents(("yaw", "knee", "twist"), (0, 2), 0)


def test_only_what_is_circular_wraps():
    wrapped = COMPONENTS.wrapped(np.array([[3.5, 3.5, -3.5], [np.pi, 7.0, -np.pi]]))
    np.testing.assert_allclose(wrapped, [[3.5 - 2 * np.pi, 3.5, 2 * np.pi - 3.5], [-np.pi, 7.0, -np.pi]])


def test_the_middle_of_angles_across_the_seam():
    middle = COMPONENTS.middle(np.array([[3.0, 1.0, 0.0], [-3.0, 3.0, 0.2]]))
    np.testing.assert_allclose(np.abs(middle[0]), np.pi)  # a plain mean would be 0, the other way
    np.testing.assert_allclose(middle[1:], [2.0, 0.1])


def test_distances_on_circles_do_not_know_the_seam():
    rows = COMPONENTS.on_circles(np.array([[np.pi - 0.01, 0.5, 0.0], [-np.pi + 0.01, 0.5, 0.0], [0.0, 0.5, 0.0]]))
    assert rows.shape == (3, 5)
    assert np.linalg.norm(rows[0] - rows[1]) == pytest.approx(2 * np.sin(0.01))
    assert np.linalg.norm(rows[0] - rows[2]) == pytest.approx(2.0, abs=1e-3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (((),), "at least one name"),
        ((("a", "a"),), "each once"),
        ((("a",), (1,)), "indices 0 to 0"),
        ((("a", "b"), (0,), 1), "one of the circular"),
    ],
)
def test_they_check_themselves(arguments, message):
    with pytest.raises(InputError, match=message):
        PoseComponents(*arguments)


def test_poses_that_do_not_fit():
    with pytest.raises(InputError, match=r"shape \(N, 3\)"):
        COMPONENTS.checked("poses", np.zeros((4, 2)))
    with pytest.raises(InputError, match="nan"):
        COMPONENTS.checked("poses", np.full((4, 3), np.nan))
