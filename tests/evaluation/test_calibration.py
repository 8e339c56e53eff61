"""The written-down quantiles are those of the chi distribution."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi

from muybridge.evaluation.calibration import CHI3_RADII, LEVELS, calibrate_deviations


def test_radii_are_the_quantiles_of_chi_with_three_degrees_of_freedom():
    np.testing.assert_allclose(CHI3_RADII, chi(3).ppf(LEVELS), atol=1e-8)  # eight decimals are written down


def test_unknown_and_zero_deviations_are_left_out():
    fit = calibrate_deviations(np.array([[1.0, 2.0, np.nan, 9.0]]), np.array([[1.0, np.nan, 1.0, 0.0]]))
    assert fit.count == 1
    assert fit.coverage == (1.0, 1.0, 1.0)
    assert calibrate_deviations(np.ones((1, 1)), np.zeros((1, 1))) is None
