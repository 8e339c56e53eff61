from __future__ import annotations

import numpy as np
import pytest

from muybridge.cameras.model import Rig
from muybridge.experiments.spoiling import HOLE_RADIUS, HOLES, shifted_rig, spoilt_mask
from muybridge.synthetic.rigs import ring

RNG = np.random.default_rng(0)


def square() -> np.ndarray:
    """A square of 40 pixels in a picture of 80."""
    mask = np.zeros((80, 80), bool)
    mask[20:60, 20:60] = True
    return mask


@pytest.mark.parametrize(("fault", "side"), [("", 40), ("eroded", 38), ("dilated", 42)])
def test_a_square_loses_or_gains_a_pixel_all_round(fault: str, side: int) -> None:
    assert np.count_nonzero(spoilt_mask(square(), fault, RNG)) == side**2


def test_holes_are_inside_and_no_larger_than_said() -> None:
    """Four discs of radius 2 (5 % of 40), 13 pixels each when drawn: at least one of them, at most four, is missing."""
    spoilt = spoilt_mask(square(), "holes", np.random.default_rng(1))
    missing = square() & ~spoilt
    assert not (spoilt & ~square()).any()
    disc = np.pi * (40 * HOLE_RADIUS + 1) ** 2
    assert 5 <= missing.sum() <= HOLES * disc


def test_nobody_stays_nobody_and_the_given_mask_stays_as_it_was() -> None:
    nobody, given = np.zeros((8, 8), bool), square()
    assert not spoilt_mask(nobody, "holes", RNG).any() and not spoilt_mask(nobody, "dilated", RNG).any()
    spoilt_mask(given, "holes", RNG)
    assert (given == square()).all()


class TestShiftedRig:
    rig = ring(np.random.default_rng(2), 3)

    def test_every_camera_is_off_by_that_much_in_its_own_direction(self) -> None:
        shifts = [
            other.matrix[:2, 2] - camera.matrix[:2, 2]
            for camera, other in zip(self.rig, shifted_rig(self.rig, 2.0, 5), strict=True)
        ]
        np.testing.assert_allclose(np.linalg.norm(shifts, axis=1), 2.0)
        assert len({round(float(np.arctan2(y, x)), 3) for x, y in shifts}) == 3

    def test_none(self) -> None:
        assert shifted_rig(self.rig, 0.0, 5) is self.rig

    def test_the_seed_decides(self) -> None:
        def centres(rig: Rig) -> list[list[float]]:
            return [camera.matrix[:2, 2].tolist() for camera in rig]

        assert centres(shifted_rig(self.rig, 2.0, 5)) == centres(shifted_rig(self.rig, 2.0, 5))
        assert centres(shifted_rig(self.rig, 2.0, 5)) != centres(shifted_rig(self.rig, 2.0, 6))
