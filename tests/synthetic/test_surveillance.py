"""The hall with people who come and go: what is promised happens, and the truth fits the pictures."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from muybridge.cameras.model import Rig
from muybridge.errors import InputError
from muybridge.io.mot import read_mot
from muybridge.io.parts import read_parts
from muybridge.io.video import open_masks
from muybridge.synthetic.crowd import INSIDE, shoot_people
from muybridge.synthetic.description import Scene
from muybridge.synthetic.light import Light
from muybridge.synthetic.motion import Motion
from muybridge.synthetic.occluders import Occluder
from muybridge.synthetic.scene import empty, shoot
from muybridge.synthetic.scene_file import from_table, read
from muybridge.synthetic.scene_text import scene_text
from muybridge.synthetic.stage import stage
from muybridge.synthetic.surveillance import EVENTS, surveillance_scene
from muybridge.synthetic.write import write_scene

SMALL = (160, 120)


@lru_cache
def hall() -> Scene:
    return surveillance_scene(seed=2, duration=16.0, rate=10.0, people=3, size=SMALL)


@lru_cache
def bare(way: tuple, *others: tuple, things: tuple = ()) -> Scene:
    """People on given ways in the calm hall, without noise; the camera stands at x = -4 and looks along x."""
    scene = surveillance_scene(seed=2, duration=2.0, rate=10.0, people=2, size=SMALL, events=())
    people = [replace(scene.person, motion=Motion(duration=2.0, rate=10.0, way=one)) for one in (way, *others)]
    return replace(scene, person=people[0], others=tuple(people[1:]), occluders=things, noise=0.0, drift=0.0,
                   light=Light())  # fmt: skip


def standing(x: float, y: float) -> tuple:
    return ((x, y, 9.0), (x, y + 0.1, 0.0))


class TestPreset:
    def test_the_seed_decides(self):
        same = surveillance_scene(seed=2, duration=16.0, rate=10.0, people=3, size=SMALL)
        assert same == hall() and surveillance_scene(seed=3, duration=16.0, rate=10.0, people=3, size=SMALL) != same

    def test_people_come_and_go(self):
        """Nobody is there as it begins, somebody in between; the first to come lingers, half of the clip."""
        assert not len(shoot_people(hall(), 0).numbers)
        where = stage(hall()).actors[0].track.joints[:, 0, :2]
        still = np.linalg.norm(np.diff(where, axis=0), axis=1) < 0.01
        inside = np.abs(where[1:, 1]) < 4
        assert np.count_nonzero(still & inside) >= 0.5 * 160 - 1
        assert {int(number) for frame in range(20, 160, 20) for number in shoot_people(hall(), frame).numbers} >= {1, 2}

    def test_everybody_wears_something_else(self):
        scene = surveillance_scene(seed=4, duration=20.0, rate=5.0, size=SMALL)
        assert len(scene.people) == 6 and len({person.outfit for person in scene.people}) == 6

    def test_people_keep_apart(self):
        """Half a metre where 0.6 is planned: everybody walks at a pace of their own."""
        scene = surveillance_scene(seed=4, duration=20.0, rate=5.0, size=SMALL)
        ways = [actor.track.joints[:, 0, :2] for actor in stage(scene).actors]
        for first in range(6):
            for second in range(first):
                both = (np.abs(ways[first][:, 1]) < 4) & (np.abs(ways[second][:, 1]) < 4)
                assert not both.any() or np.linalg.norm(ways[first] - ways[second], axis=1)[both].min() > 0.2

    def test_calm_has_no_changes(self):
        calm = surveillance_scene(seed=2, duration=16.0, rate=10.0, people=3, size=SMALL, events=())
        assert calm.changes == () and len(calm.occluders) == 2 and len(hall().occluders) > 3

    @pytest.mark.parametrize(
        ("wrong", "message"),
        [
            ({"people": 7}, "1 to 6"),
            ({"size": (320, 200)}, "4 to 3"),
            ({"events": ("fire",)}, "pillar, linger, door, lamp"),
            ({"linger": -1.0}, "positive"),
            ({"seed": -1}, "0 or more"),
        ],
    )
    def test_errors(self, wrong, message):
        with pytest.raises(InputError, match=message):
            surveillance_scene(**{"seed": 1, **wrong})


class TestChanges:
    def test_the_door_opens_and_stays_open(self):
        scene = replace(hall(), noise=0.0, drift=0.0, light=Light())
        opens = [thing.since for thing in scene.occluders if thing.since is not None]
        before, during, after = (
            stage(scene).decors[scene.epoch(time)].plates[0] for time in (min(opens) - 1.0, max(opens), 15.9)
        )
        changed = np.abs(after - before).max(axis=2) > 10
        assert 50 < np.count_nonzero(changed) < 0.1 * changed.size
        assert np.array_equal(during, after)

    def test_the_lamp_goes_off_and_comes_back(self):
        off, on = (switch.time for switch in hall().light.switches)
        levels = [shoot_people(hall(), round(10 * time)).image.mean() for time in (off - 0.2, off + 0.1, on + 4.0)]
        assert levels[1] < 0.8 * levels[0] and levels[2] == pytest.approx(levels[0], rel=0.1)

    def test_a_thing_comes_and_goes(self):
        crate = Occluder(size=(0.6, 0.6, 0.6), place=(1.0, 0.0), since=0.5, until=1.0)
        scene = bare(standing(1.0, 5.5), things=(crate,))
        pictures = [shoot_people(scene, frame).image for frame in (4, 5, 9, 10)]
        assert np.array_equal(pictures[0], pictures[3]) and np.array_equal(pictures[1], pictures[2])
        assert np.count_nonzero((pictures[0] != pictures[1]).any(axis=2)) > 100
        assert np.array_equal(next(empty(scene))[0], pictures[0])


class TestShot:
    def test_a_person_alone_is_seen_whole(self):
        """Pixels at the edge are counted by share or by centre; on 45 rows that is a tenth at most."""
        shot = shoot_people(bare(standing(1.0, 0.0), standing(1.0, 5.5)), 0)
        assert shot.numbers.tolist() == [1] and shot.visible[0] > 0.97
        rows, columns = np.nonzero(shot.mask)
        left, top, width, height = shot.boxes[0]
        assert abs(rows.min() - top) <= 1 and abs(rows.max() + 1 - top - height) <= 1
        assert abs(columns.min() - left) <= 1 and abs(columns.max() + 1 - left - width) <= 1
        assert shot.parts_visible.min() > 0.85

    def test_parts_lie_one_under_the_other(self):
        shot = shoot_people(bare(standing(1.0, 0.0), standing(1.0, 5.5)), 0)
        _, top, _, height = shot.boxes[0]
        middles = shot.parts[0, :, 1] + shot.parts[0, :, 3] / 2
        assert (np.diff(middles) > 0).all() and shot.parts[0, 0, 1] == top
        knees = shot.parts[0, 2, 1] + shot.parts[0, 2, 3]
        assert 0.6 * height < knees - top < 0.85 * height

    def test_who_stands_in_front_hides(self):
        """The box stays that of the whole person, alone or not."""
        front, behind = standing(0.5, 0.0), standing(2.5, 0.0)
        alone, shot = (shoot_people(bare(behind, other), 0) for other in (standing(1.0, 5.5), front))
        assert shot.numbers.tolist() == [1, 2] and shot.visible[0] < 0.7 and shot.visible[1] > 0.97
        assert np.array_equal(shot.boxes[0], alone.boxes[0]) and np.array_equal(shot.parts[0], alone.parts[0])
        assert np.count_nonzero(shot.ids == 1) < 0.7 * np.count_nonzero(alone.ids == 1)

    def test_a_pillar_hides(self):
        pillar = Occluder(size=(0.8, 0.8, 4.0), place=(1.0, 0.0))
        hidden = shoot_people(bare(standing(2.5, 0.0), things=(pillar,)), 0)
        assert hidden.numbers.tolist() == [1] and hidden.visible[0] < 0.2 and hidden.boxes[0, 3] > 20

    def test_boxes_reach_beyond_the_picture(self):
        """Somebody half way out counts; somebody further out does not, though a few pixels are seen."""
        scene = bare(((1.0, 1.7, 0.0), (1.0, 5.5, 0.0)))
        shots = [shoot_people(scene, frame) for frame in range(20)]
        cut = [shot for shot in shots if len(shot.numbers) and shot.boxes[0, 0] < -2]
        assert cut and all(INSIDE - 0.1 < shot.visible[0] < 1 for shot in cut)
        assert any(not len(shot.numbers) and shot.mask.any() for shot in shots)

    def test_is_the_picture_of_every_other_way(self):
        """Who is far from the picture need not be drawn; shadows come from cells of another size."""
        scene = bare(standing(1.0, 0.0), standing(1.0, 5.5))
        whole = shoot(replace(scene, shadow=0.0), 3)[0]
        mine = shoot_people(replace(scene, shadow=0.0), 3)
        assert np.array_equal(mine.image, whole.image) and np.array_equal(mine.ids == 1, whole.mask)

    def test_frames(self):
        with pytest.raises(InputError, match="0 to 159"):
            shoot_people(hall(), 160)


class TestFiles:
    def test_scene_text_comes_back(self, tmp_path):
        (tmp_path / "scene.toml").write_text(scene_text(hall()))
        assert read(tmp_path / "scene.toml") == complete(hall())

    def test_keys(self, tmp_path):
        table = {"preset": "surveillance", "seed": 2, "duration": 16.0, "rate": 10.0, "people": 3, "size": SMALL}
        assert from_table(table, tmp_path) == hall()
        assert from_table({**table, "events": list(EVENTS), "linger": 8.0}, tmp_path) == hall()

    @pytest.mark.parametrize(
        ("table", "message"),
        [
            ({"people": 3}, "surveillance"),
            ({"preset": "surveillance", "cameras": 2}, "cameras"),
            ({"preset": "surveillance", "person": {"figure": "man"}}, "person"),
            ({"follow": "people"}, "one camera"),
        ],
    )
    def test_contradictions(self, table, message, tmp_path):
        with pytest.raises(InputError, match=message):
            from_table(table, tmp_path)

    def test_folder(self, tmp_path):
        """Truth as other programs read it; boxes in the file count from 1."""
        crate = Occluder(size=(0.6, 0.6, 0.6), place=(0.5, 0.0))
        scene = bare(standing(1.5, 0.0), standing(2.0, 1.0), things=(crate,))
        video = write_scene(scene, tmp_path / "out")
        assert video.name == "cam1.mp4" and not (tmp_path / "out/job.toml").exists()
        shot = shoot_people(scene, 7)
        boxes = read_mot(tmp_path / "out/gt.txt").between(7, 7)
        assert np.array_equal(boxes.boxes, shot.boxes) and boxes.ids.tolist() == [1, 2]
        parts = read_parts(tmp_path / "out/truth_parts.csv")
        now = parts.frames == 7
        assert np.array_equal(parts.boxes[now], shot.parts.reshape(-1, 4))
        assert np.abs(parts.scores[now] - shot.parts_visible.ravel()).max() <= 0.005
        with open_masks(tmp_path / "out/cam1_mask.mp4") as masks:
            mask = next(image for index, _, image in masks.frames() if index == 7)
        assert np.count_nonzero(mask != shot.mask) < 0.02 * np.count_nonzero(shot.mask)
        assert sorted(path.name for path in (tmp_path / "out/cam1_ids").iterdir())[-1] == "000019.png"
        write_scene(scene, tmp_path / "out")  # an earlier scene is replaced


def complete(scene: Scene) -> Scene:
    """The same with nothing left to the figures, as scene.toml has it."""
    return replace(scene, rig=Rig(scene.rig.cameras), person=scene.person.complete(),
                   others=tuple(other.complete() for other in scene.others))  # fmt: skip
