"""The ground's line from drawn people, exactly, and among outliers."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.people.blobs import Blob
from muybridge.people.ground_fit import fit_ground, follow_regions

PICTURE = (640, 480)


def person(feet: int, x: int = 300, offset: float = 10.0, slope: float = 0.3, aspect: float = 0.4) -> Blob:
    """A full box with its feet in that row."""
    height = round(offset + slope * feet)
    return Blob(x, feet - height + 1, np.ones((height, round(aspect * height)), bool))


def alone(blobs: list[Blob]) -> list[list[Blob]]:
    """Each in a moment of its own, with an empty one between: nobody follows from anybody."""
    return [moment for blob in blobs for moment in ([blob], [])]


def test_the_line_is_found() -> None:
    """Heights are rounded to whole pixels: half a pixel over a lever of 350 rows, 1.5e-3 of the slope, at most twice
    that for pixels at both ends; and half a pixel of the height."""
    ground = fit_ground(alone([person(feet) for feet in range(60, 470, 10)]), PICTURE)
    assert ground is not None
    assert abs(ground.slope - 0.3) < 3e-3 and abs(ground.aspect - 0.4) < 0.01
    assert abs(float(ground.height(200.0)) - 70) < 0.5


def test_pairs_do_not_move_it() -> None:
    """A third are two people, one behind the other, as one region half as tall again."""
    people = [person(feet) for feet in range(60, 470, 10)]
    pairs = [person(feet, offset=15, slope=0.45) for feet in range(65, 470, 20)]
    ground = fit_ground(alone(people + pairs), PICTURE)
    assert ground is not None and abs(float(ground.height(250.0)) - 85) < 1.0
    heights = [blob.mask.shape[0] for blob in people + pairs]
    plain = np.polyfit([blob.top + blob.mask.shape[0] for blob in people + pairs], heights, 1)
    assert np.polyval(plain, 250.0) > 95  # negative control: least squares over all lies a third of the way up


def test_missing_feet_do_not_steepen_it() -> None:
    """Twenty people walk by one after the other, each without feet or shins, or with a shadow at the feet: heights and
    feet are off together."""
    rng = np.random.default_rng(3)
    blobs, moments = [], []
    for wrong in rng.integers(-25, 25, 20):
        for row in range(int(rng.integers(250, 300)), 350, 4):
            height = round(10 + 0.3 * row) + int(wrong)
            blobs.append(Blob(300, int(row + wrong) - height + 1, np.ones((height, 40), bool)))
            moments.append([blobs[-1]])
        moments.append([])
    ground = fit_ground(moments, PICTURE)
    # Errors of 14 pixels (standard deviation) against rows of about 25: heights against feet have the slope
    # (25^2 x 0.3 + 14^2) / (25^2 + 14^2) = 0.47. A third of that error is left at most.
    plain = np.polyfit([b.top + len(b.mask) for b in blobs], [len(b.mask) for b in blobs], 1)[0]
    assert ground is not None and plain - 0.3 > 0.1 and abs(ground.slope - 0.3) < 0.33 * (plain - 0.3)


def test_how_one_person_changes_says_more_than_who_is_how_tall() -> None:
    """A tall one walks far away, a child nearby: the line between them is level, and theirs are not."""
    tall = [person(200 + 3 * k, x=100, offset=12, slope=0.36) for k in range(20)]
    child = [person(330 + 3 * k, x=400, offset=8, slope=0.24) for k in range(20)]
    together = fit_ground([list(moment) for moment in zip(tall, child, strict=True)], PICTURE)
    assert together is not None
    growth = float(together.height(389.0)) / float(together.height(200.0))
    # Along each way heights are known to half a pixel of 90 at both ends, 0.8 %, over a third of the rows between 200
    # and 389: 2.4 % over all of them; and one step of the statures that are tried is 2.5 %.
    assert abs(growth / ((10 + 0.3 * 389) / (10 + 0.3 * 200)) - 1) < 0.05
    apart = fit_ground(alone(tall + child), PICTURE)
    assert apart is not None
    assert float(apart.height(389.0)) / float(apart.height(200.0)) < growth  # negative control: who is who is not told


def test_who_is_cut_off_says_nothing() -> None:
    people = alone([person(feet) for feet in range(60, 470, 20)])
    cut = alone([Blob(0, feet - 30, np.ones((31, 12), bool)) for feet in range(60, 470, 2)])
    assert fit_ground(people + cut, PICTURE) == fit_ground(people, PICTURE)


def test_somebody_who_stands_counts_once() -> None:
    """Somebody stands in row 300 while others pass behind: mostly one region with them, up to half as tall again."""
    people = [person(feet) for feet in range(60, 470, 10)]
    standing = [Blob(200, 301 - height, np.ones((height, 45), bool)) for height in range(110, 150)]
    ground = fit_ground(alone([*people, *standing, person(300, x=200)]), PICTURE)
    assert ground is not None and abs(float(ground.height(300.0)) - 100) < 1.0


def test_people_cut_short_do_not_flatten_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """More lack their legs or heads: 70 pixels are left of all, wherever they stand, and so lie near one line."""
    people = [person(feet) for feet in range(180, 470, 6)]
    cut = [Blob(100, feet - 69, np.ones((70, 24), bool)) for feet in range(180, 470, 5)]
    ground = fit_ground(alone(people + cut), PICTURE)
    # Everybody may be as tall as suits the line: to one step of the statures that are tried, 2.5 % of 130 pixels, and
    # half a pixel of rounding.
    assert ground is not None and abs(float(ground.height(400.0)) - 130) < 3.75
    monkeypatch.setattr("muybridge.people.ground_fit.ABOVE", 0.2)
    flat = fit_ground(alone(people + cut), PICTURE)
    assert flat is not None and float(flat.height(400.0)) < 90  # negative control: most lie near a level line


def test_too_few_say_nothing() -> None:
    assert fit_ground(alone([person(feet) for feet in range(100, 200, 10)]), PICTURE) is None
    assert fit_ground([], PICTURE) is None


def test_regions_follow_each_other_until_they_merge() -> None:
    """Two walk towards each other, are one region, and part: four people as far as regions can tell, and a pair."""
    moments = [[person(300, x=100 + 20 * k), person(300, x=300 - 20 * k)] for k in range(4)]
    merged = Blob(160, 201, np.ones((100, 120), bool))
    boxes, numbers = follow_regions([*moments, [merged], *moments[::-1]], PICTURE)
    assert boxes.shape == (17, 4)
    assert numbers[:8].tolist() == [0, 1] * 4 and numbers[8] == 2 and numbers[9:].tolist() == [3, 4] * 4
