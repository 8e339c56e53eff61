"""Plots of experiments show the numbers they were given."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.plotting import new_figure
from muybridge.plotting.experiments import (
    COLOURS,
    MARKERS,
    plot_budgets,
    plot_coverage,
    plot_distance_matrix,
    plot_error_curves,
    plot_intervals,
    plot_surface,
)


def one_axes():
    return new_figure()[1][0, 0]


def test_intervals() -> None:
    ax = one_axes()
    nan = float("nan")
    lines, dots, *targets = plot_intervals(
        ax, ["a", "b"], [10.0, 30.0], [5.0, nan], [15.0, nan], "h", targets=[(20.0, 12.0), (40.0, 25.0)]
    )
    assert len(lines.get_segments()) == 1  # type: ignore[attr-defined]  # the other has no interval
    np.testing.assert_array_equal(dots.get_xdata(), [10.0, 30.0])  # type: ignore[attr-defined]
    assert [label.get_text() for label in ax.get_yticklabels()] == ["a", "b"]
    assert [list(line.get_xdata()) for line in targets] == [[20.0, 40.0], [12.0, 25.0]]  # type: ignore[attr-defined]


def test_budgets_keep_every_curve_inside() -> None:
    ax = one_axes()
    x = np.array([250.0, 20000.0])
    curves = {"one": (x, np.array([300.0, 20.0]), np.array([-5.0, 10.0]), np.array([900.0, 30.0]))}
    plot_budgets(ax, curves, "h")
    low, high = ax.get_ylim()
    assert low < 20 and high > 300 and ax.get_xscale() == ax.get_yscale() == "log"


def test_coverage_draws_every_condition_and_the_diagonal() -> None:
    ax = one_axes()
    curves = {str(i): (0.4, 0.7, 0.9) for i in range(len(COLOURS))}
    artists = plot_coverage(ax, (0.5, 0.8, 0.95), curves, "h")
    assert len(artists) == 1 + len(COLOURS) == 1 + len(MARKERS) == len(ax.get_lines())


def test_surface_marks_the_highest_point() -> None:
    ax = one_axes()
    values = np.zeros((3, 4))
    values[2, 1] = 1.0
    *_, highest = plot_surface(ax, np.array([-1.0, 0, 1]), np.array([-2.0, -1, 0, 1]), values, ("hip", "knee"), "h")
    assert (highest.get_xdata()[0], highest.get_ydata()[0]) == (1.0, -1.0)  # type: ignore[attr-defined]


def test_matrix_has_its_numbers() -> None:
    ax = one_axes()
    plot_distance_matrix(ax, np.array([[1.0, 20.0], [18.0, 2.0]]), ["0", "9"], "h")
    assert [text.get_text() for text in ax.texts[:4]] == ["1", "20", "18", "2"]


@pytest.mark.parametrize("highest", [3.0, 400.0])
def test_error_curves_begin_at_zero_and_fit(highest: float) -> None:
    ax = one_axes()
    plot_error_curves(ax, np.arange(3.0), {"a": np.array([1.0, highest, 2.0])}, "h")
    assert ax.get_ylim()[0] == 0 and ax.get_ylim()[1] > highest
