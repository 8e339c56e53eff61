"""Lamps that drift and switch, and the exposure that follows them."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.synthetic.light import Lamp, Light, Switch, drift_gain
from muybridge.synthetic.sensor import Sensor, exposed

DARK = Lamp((0.5, 0.0, 0.8), gain=0.5, spot=(1.0, 0.0))
LIGHT = Light(Lamp(), (Switch(1.0, DARK), Switch(2.0, Lamp(gain=1.2))))


def test_states() -> None:
    assert [LIGHT.state(time) for time in (-1.0, 0.0, 0.99, 1.0, 1.5, 2.0, 9.0)] == [0, 0, 0, 1, 1, 2, 2]
    assert LIGHT.lamps[1] is DARK


def test_the_lagged_gain_is_the_solution_of_its_equation() -> None:
    """g' = (gain - g) / lag: integrated in small steps; Euler's error is below step / lag times the largest change."""
    lag, step = 0.3, 1e-4
    level, worst = 1.0, 0.0
    for count in range(int(3 / step)):
        time = count * step
        worst = max(worst, abs(level - LIGHT.lagged_gain(time, lag)))
        level += step / lag * (LIGHT.lamps[LIGHT.state(time)].gain - level)
    assert worst < 2 * step / lag
    assert abs(LIGHT.lagged_gain(1.9, lag) - 1.0) > 0.4  # it did follow


def test_drift_goes_up_and_down() -> None:
    gains = [drift_gain(0.1, time, 4.0) for time in (0.0, 1.0, 2.0, 3.0)]
    np.testing.assert_allclose(gains, [1.0, 1.1, 1.0, 0.9], atol=1e-12)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Lamp((1.0, 0.0, 0.1)), "lamp above"),
        (lambda: Lamp(gain=0.0), "positive"),
        (lambda: Switch(-1.0, DARK), "0 or more seconds"),
        (lambda: Light(Lamp(), (Switch(2.0, DARK), Switch(1.0, DARK))), "one after the other"),
        (lambda: Sensor(shutter=1.5), "0 to 1"),
        (lambda: Sensor(exposure=0.7), "0 to 0.5"),
        (lambda: Sensor(lag=0.0), "positive seconds"),
        (lambda: Sensor(quality=60), "51"),
    ],
)
def test_bad_input(make: object, words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()  # type: ignore[operator]


class TestSensor:
    def test_the_shutter_is_open_in_the_middle(self) -> None:
        moments = Sensor(shutter=0.5).moments
        assert moments.mean() == pytest.approx(0) and -0.25 < moments.min() < moments.max() < 0.25
        assert list(Sensor().moments) == [0.0]

    def test_rows_are_read_one_after_the_other(self) -> None:
        times = Sensor(readout=0.6).row_times(2.0, 30.0, 480)
        assert times[0] == pytest.approx(2.0 - 0.3 / 30) and times[240] == pytest.approx(2.0)
        np.testing.assert_allclose(np.diff(times), 0.6 / 30 / 480)

    def test_cameras_wander_apart(self) -> None:
        """Within the amplitude, smooth, and not the same for two cameras."""
        sensor, times = Sensor(exposure=0.1), np.linspace(0, 4, 400)
        first, second = sensor.wander(1, 0, times), sensor.wander(1, 1, times)
        assert np.ptp(first) > 0.15 and np.abs(first - 1).max() <= 0.1 + 1e-12
        assert np.abs(np.diff(first)).max() < 0.1 * 2 * np.pi / 1.5 * 0.0101
        assert np.abs(first - second).max() > 0.02

    def test_a_gain_a_row(self) -> None:
        """Without noise a grey of 100 becomes 100 times its row's gain, rounded."""
        gain = np.linspace(0.5, 1.5, 11, dtype=np.float32)[:, None, None]
        image = exposed(np.full((11, 4, 3), 100, np.float32), gain, 0.0, np.random.default_rng(0))
        assert np.abs(image - 100 * gain).max() <= 0.5 + 1e-4
