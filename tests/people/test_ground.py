"""The ground's line from drawn people, exactly, and among outliers."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.people.blobs import Blob
from muybridge.people.ground import GroundScale, fit_ground

PICTURE = (640, 480)


def person(feet: int, x: int = 300, offset: float = 10.0, slope: float = 0.3, aspect: float = 0.4) -> Blob:
    """A full box with its feet in that row."""
    height = round(offset + slope * feet)
    return Blob(x, feet - height + 1, np.ones((height, round(aspect * height)), bool))


def test_the_line_is_found() -> None:
    """Heights are rounded to whole pixels: half a pixel over a lever of 350 rows, 1.5e-3 of the slope."""
    ground = fit_ground([person(feet) for feet in range(60, 470, 10)], PICTURE)
    assert ground is not None
    assert abs(ground.slope - 0.3) < 1.5e-3 and abs(ground.offset - 10) < 0.5 and abs(ground.aspect - 0.4) < 0.01
    assert abs(float(ground.height(200.0)) - 70) < 0.5


def test_pairs_do_not_move_it() -> None:
    """A third are two people, one behind the other, as one region half as tall again."""
    people = [person(feet) for feet in range(60, 470, 10)]
    pairs = [person(feet, offset=15, slope=0.45) for feet in range(65, 470, 20)]
    ground = fit_ground(people + pairs, PICTURE)
    assert ground is not None and abs(float(ground.height(250.0)) - 85) < 1.0
    heights = [blob.mask.shape[0] for blob in people + pairs]
    plain = np.polyfit([blob.top + blob.mask.shape[0] for blob in people + pairs], heights, 1)
    assert np.polyval(plain, 250.0) > 95  # negative control: least squares over all lies a third of the way up


def test_who_is_cut_off_says_nothing() -> None:
    people = [person(feet) for feet in range(60, 470, 20)]
    cut = [Blob(0, feet - 30, np.ones((31, 12), bool)) for feet in range(60, 470, 2)]
    assert fit_ground(people + cut, PICTURE) == fit_ground(people, PICTURE)


def test_somebody_who_stands_counts_once() -> None:
    """Somebody stands in row 300 while others pass behind: mostly one region with them, up to half as tall again."""
    people = [person(feet) for feet in range(60, 470, 10)]
    standing = [Blob(200, 301 - height, np.ones((height, 45), bool)) for height in range(110, 150)]
    assert fit_ground(people + standing, PICTURE) is not None
    ground = fit_ground([*people, *standing, person(300, x=200)], PICTURE)
    assert ground is not None and abs(float(ground.height(300.0)) - 100) < 1.0


def test_people_cut_short_do_not_flatten_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """More lack their legs or heads: 70 pixels are left of all, wherever they stand, and so lie near one line."""
    people = [person(feet) for feet in range(180, 470, 6)]
    cut = [Blob(100, feet - 69, np.ones((70, 24), bool)) for feet in range(180, 470, 5)]
    ground = fit_ground(people + cut, PICTURE)
    assert ground is not None and abs(float(ground.height(400.0)) - 130) < 3.0
    monkeypatch.setattr("muybridge.people.ground.ABOVE", 0.0)
    flat = fit_ground(people + cut, PICTURE)
    assert flat is not None and float(flat.height(400.0)) < 90  # negative control: most lie near a level line


def test_a_child_on_the_same_ground() -> None:
    ground = GroundScale(10.0, 0.3, 0.4)
    np.testing.assert_allclose(ground.of_person(0.7).height(200.0), 0.7 * ground.height(200.0))


def test_too_few_say_nothing() -> None:
    assert fit_ground([person(feet) for feet in range(100, 200, 10)], PICTURE) is None
    assert fit_ground([], PICTURE) is None


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
