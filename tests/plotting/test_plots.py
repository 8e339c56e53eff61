"""Plots take axes, return artists, show the numbers they were given, and never touch pyplot."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from muybridge.evaluation import JOINTS, joint_errors
from muybridge.io.run_folder import JointSeries
from muybridge.plotting import (
    DARK,
    LIGHT,
    new_figure,
    plot_acceptance,
    plot_effective_sample_size,
    plot_error_over_time,
    plot_joint_angles,
    plot_joint_errors,
    plot_top_view,
    to_png,
    to_svg,
)
from muybridge.plotting.style import bgr, side_of

TIMES = np.arange(20) / 50


def axis(theme=LIGHT):
    figure, axes = new_figure(theme=theme)
    return figure, axes[0, 0]


def errors(shift: float = 0.01, swapped: bool = False):
    truth = np.random.default_rng(1).normal(size=(20, 15, 3))
    estimate = truth + [shift, 0, 0]
    if swapped:
        legs = ("knee", "ankle")
        order = [
            JOINTS.index(n.replace("left", "LEFT").replace("right", "left").replace("LEFT", "right"))
            if n.endswith(legs)
            else j
            for j, n in enumerate(JOINTS)
        ]
        estimate = estimate[:, order]
    nothing = np.full((20, 15), np.nan)
    frames = np.arange(20)
    return joint_errors(
        JointSeries(JOINTS, frames, TIMES, estimate, nothing), JointSeries(JOINTS, frames, TIMES, truth, nothing)
    )


class TestAngles:
    ANGLES = np.radians(np.linspace(-30, 60, 20))[:, None] * np.ones(8)

    def test_curves_are_degrees_with_bands_and_truth(self):
        _, axes = new_figure(2, 2)
        artists = plot_joint_angles(axes, TIMES, self.ANGLES, np.full((20, 8), 0.1), (TIMES, self.ANGLES))
        assert len(artists) == 4 * (1 + 2 * 3)
        left = next(line for line in axes[0, 0].get_lines() if line.get_label() == "left")
        np.testing.assert_allclose(left.get_ydata(), np.linspace(-30, 60, 20))
        assert left.get_color() == LIGHT.left

    def test_a_band_that_explodes_does_not_flatten_the_curves(self):
        _, axes = new_figure(2, 2)
        spread = np.full((20, 8), 0.05)
        spread[3] = 50.0
        plot_joint_angles(axes, TIMES, self.ANGLES, spread)
        low, high = axes[0, 0].get_ylim()
        assert high - low < 2 * 90

    def test_nothing_known(self):
        _, axes = new_figure(2, 2)
        plot_joint_angles(axes, TIMES, np.full((20, 8), np.nan))


class TestErrors:
    def test_bars_are_the_means(self):
        result = errors(0.01)
        _, ax = axis()
        bars = plot_joint_errors(ax, result)[:-1]
        np.testing.assert_allclose([bar.get_width() for bar in bars], 10.0)
        assert len(bars) == 15
        assert [label.get_text() for label in ax.get_yticklabels()][:3] == ["head top", "thorax", "pelvis"]

    def test_a_joint_that_was_never_seen_has_no_bar(self):
        result = errors()
        truth = np.full((20, 15, 3), np.nan)
        truth[:, 1:] = 0.0
        series = JointSeries(JOINTS, result.frames, TIMES, truth, np.full((20, 15), np.nan))
        _, ax = axis()
        assert len(plot_joint_errors(ax, joint_errors(series, series))) == 14 + 1

    def test_lost_frames_are_marked_and_the_alignment_named(self):
        _, ax = axis()
        plot_error_over_time(ax, errors(0.3))
        assert "lost" in ax.get_legend_handles_labels()[1]
        assert any("alignment none" in text.get_text() for text in ax.texts)

    def test_swapped_legs_are_marked(self):
        _, ax = axis()
        plot_error_over_time(ax, errors(0.0, swapped=True))
        assert "legs swapped" in ax.get_legend_handles_labels()[1]

    def test_a_frame_without_joints_is_a_gap(self):
        points = np.zeros((20, 15, 3))
        points[4] = np.nan
        series = JointSeries(JOINTS, np.arange(20), TIMES, points, np.full((20, 15), np.nan))
        _, ax = axis()
        plot_error_over_time(ax, joint_errors(series, series))
        assert np.isnan(ax.get_lines()[0].get_ydata()[4])


class TestDiagnostics:
    def test_collapsed_frames_are_marked(self):
        _, ax = axis()
        sizes = np.full(20, 100.0)
        sizes[[3, 4]] = 2.0
        cross = plot_effective_sample_size(ax, TIMES, sizes, 200)[-1]
        np.testing.assert_allclose(cross.get_xdata(), TIMES[[3, 4]])
        assert ax.get_ylim() == (0, 200)

    def test_acceptance_of_layers_is_percent(self):
        _, ax = axis()
        artists = plot_acceptance(ax, TIMES, np.tile([0.2, 0.4], (20, 1)))
        np.testing.assert_allclose(artists[-1].get_ydata(), 30.0)
        assert len(artists) == 2


class TestTopView:
    def test_path_truth_and_cameras(self):
        _, ax = axis()
        path = np.column_stack([TIMES, TIMES**2, TIMES])
        path[0] = np.nan
        artists = plot_top_view(
            ax,
            path,
            path,
            {
                "cam1": (np.array([2.0, 0, 1]), np.array([-1.0, 0, 0])),
                "above": (np.array([0.0, 0, 3]), np.array([0.0, 0, -1])),
            },
        )
        start = next(artist for artist in artists if artist.get_label() == "start")
        np.testing.assert_allclose(np.ravel(start.get_data()), path[1, :2])
        assert {text.get_text() for text in ax.texts} >= {"cam1", "above"}

    def test_nowhere(self):
        _, ax = axis()
        plot_top_view(ax, np.full((3, 3), np.nan))


class TestStyle:
    @pytest.mark.parametrize("theme", [LIGHT, DARK])
    def test_both_themes_render_and_repeat_byte_for_byte(self, theme):
        files = []
        for _ in range(2):
            figure, ax = axis(theme)
            plot_joint_errors(ax, errors(), theme=theme)
            files.append(to_svg(figure))
        assert files[0] == files[1]
        assert theme.left.encode() in files[0]
        assert to_png(figure).startswith(b"\x89PNG")

    @pytest.mark.parametrize("theme", [LIGHT, DARK])
    def test_text_stands_out_from_the_surface(self, theme):
        """WCAG 2: text 4.5 : 1, graphical objects 3 : 1."""
        for colour in (theme.ink, theme.muted):
            assert contrast(colour, theme.surface) >= 4.5
        for colour in (theme.left, theme.right, theme.middle, theme.accent, theme.warning):
            assert contrast(colour, theme.surface) >= 3.0

    def test_sides(self):
        assert [side_of(name) for name in ("left_knee", "right", "thorax", "leftover")] == ["left", "right", "", ""]

    def test_pyplot_is_never_imported(self):
        code = (
            "import sys; from muybridge.plotting import *; f, a = new_figure(); "
            "plot_acceptance(a[0, 0], [0, 1], [.1, .2]); to_png(f); sys.exit('matplotlib.pyplot' in sys.modules)"
        )
        assert (
            subprocess.run([sys.executable, "-c", code], env={"PYTHONPATH": ":".join(sys.path)}, check=False).returncode
            == 0
        )

    def test_importing_the_package_is_light(self):
        code = "import sys, muybridge.plotting; sys.exit(bool({'matplotlib', 'cv2'} & set(sys.modules)))"
        assert (
            subprocess.run([sys.executable, "-c", code], env={"PYTHONPATH": ":".join(sys.path)}, check=False).returncode
            == 0
        )


def contrast(one: str, other: str) -> float:
    """Contrast ratio of two colours (WCAG 2, relative luminance)."""

    def luminance(colour: str) -> float:
        channels = np.array(bgr(colour)[::-1]) / 255
        return float(
            np.where(channels <= 0.03928, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
            @ [0.2126, 0.7152, 0.0722]
        )

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)
