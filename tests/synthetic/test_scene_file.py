"""Scene files: what is written comes back, what is said wins, what is wrong is one line."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest

from conftest import shared_data
from muybridge.errors import InputError
from muybridge.io._tables import Table
from muybridge.synthetic import scene_tables
from muybridge.synthetic.presets import PRESETS, preset_scene
from muybridge.synthetic.scene import demo_scene, render
from muybridge.synthetic.scene_file import read
from muybridge.synthetic.scene_text import scene_text

PAGE = Path(__file__).resolve().parents[2] / "docs/scenes.md"
#: A room is written by its parts; no switch, and a thing that is always there, is what no preset decides.
NEVER_WRITTEN = {("RoomTable", "kind"), ("LightTable", "switch")}
NEVER_WRITTEN |= {("OccluderTable", "since"), ("OccluderTable", "until")}
CAMERA = "[[camera]]\nposition = [3.5, 0, 1.6]\nlook_at = [0, 0, 0.9]\n"


def written(folder: Path, text: str) -> Path:
    (folder / "scene.toml").write_text(text)
    return folder / "scene.toml"


@pytest.mark.parametrize("preset", PRESETS)
def test_a_preset_by_name(tmp_path: Path, preset: str) -> None:
    assert read(written(tmp_path, f'preset = "{preset}"\nseed = 4\n')) == preset_scene(preset, seed=4)


@pytest.mark.parametrize("preset", PRESETS)
def test_what_is_written_comes_back(tmp_path: Path, preset: str) -> None:
    """Exactly: numbers are written with all their digits."""
    scene = preset_scene(preset, seed=5)
    assert read(written(tmp_path, scene_text(scene))) == scene


def test_the_demo_comes_back(tmp_path: Path) -> None:
    """What it leaves to the figure is written out: the same clothes and hair, by name."""
    demo = demo_scene(2)
    found = read(written(tmp_path, scene_text(demo)))
    assert found == replace(demo, person=demo.person.complete())
    for mine, theirs in zip(render(found, 40)[0], render(demo, 40)[0], strict=True):
        assert np.array_equal(mine, theirs)


def test_what_is_written_names_every_key(tmp_path: Path) -> None:
    """Else a later change of a preset would change what the file renders."""
    text = scene_text(preset_scene("hard", seed=1))
    for table in ("RoomTable", "LightTable", "SensorTable", "OccluderTable", "GarmentTable"):
        for field in msgspec.structs.fields(getattr(scene_tables, table)):
            if (table, field.name) not in NEVER_WRITTEN:
                assert re.search(rf"^{field.name} = ", text, re.MULTILINE), (table, field.name)


def test_what_is_said_wins(tmp_path: Path) -> None:
    scene = read(
        written(
            tmp_path,
            'preset = "hard"\nother = []\nduration = 1.0\nrate = 25\n[person]\nfigure = "man"\noutfit = "green"\n'
            'cut = "shorts"\nhair = "bun"\n'
            'looseness = 0.01\n[[person.garment]]\nlabel = "shirt"\npattern = "checks"\n[motion]\nkind = "wave"\n'
            "heading = 0.5\n[room]\nclutter = 2\n[light]\nshadow = 0.2\nswitch = []\n[sensor]\nnoise = 1.0\n"
            "shutter = 0.0\n"
            '[[occluder]]\nkind = "table"\nplace = [1, 1]\nsize = [0.5, 0.5, 0.5]\n' + CAMERA,
        )
    )
    assert scene.others == () and scene.frame_count == 25 and scene.light.switches == () and len(scene.rig) == 1
    assert (scene.person.figure, scene.person.looseness, scene.person.motion.heading) == ("man", 0.01, 0.5)
    assert (scene.person.cut, scene.person.hair) == ("shorts", "bun")
    shirt = next(garment for garment in scene.person.outfit if garment.label == "shirt")
    assert shirt.pattern == "checks" and shirt.colour == (70, 116, 62)
    assert (scene.room.clutter, scene.shadow, scene.noise, scene.sensor.shutter) == (2, 0.2, 1.0, 0.0)
    assert [thing.kind for thing in scene.occluders] == ["table"] and scene.sensor.quality == 32


def test_the_command_line_wins_over_the_file(tmp_path: Path) -> None:
    path = written(tmp_path, "seed = 1\n" + CAMERA.replace("]]\n", ']]\nname = "left"\n'))
    scene = read(path, ["seed=7", "sensor.quality=30", "camera.left.focal=500", "motion.kind=crouch"])
    assert (scene.seed, scene.sensor.quality, scene.person.motion.kind) == (7, 30, "crouch")
    assert scene.rig["left"].matrix[0, 0] == 500


def test_a_camera_looks_where_it_is_told(tmp_path: Path) -> None:
    camera = read(written(tmp_path, CAMERA)).rig[0]
    np.testing.assert_allclose(camera.position, [3.5, 0, 1.6], atol=1e-12)
    np.testing.assert_allclose(camera.world_to_pixel(np.array([0, 0, 0.9])), [319.5, 239.5], atol=1e-9)


def test_somebody_else(tmp_path: Path) -> None:
    text = '[[other]]\nfigure = "man"\noutfit = "red"\nmotion = {kind = "wave", place = [1.5, 1.0]}\n'
    other = read(written(tmp_path, text)).others[0]
    assert (other.figure, other.motion.kind, other.motion.place) == ("man", "wave", (1.5, 1.0))


def test_a_recorded_motion(tmp_path: Path) -> None:
    """It lasts as long as the file says or `duration` does, and comes back from what is written."""
    pytest.importorskip("muybridge.synthetic.recorded")
    file = shared_data("mocap") / "02" / "02_01.amc"
    text = f'preset = "easy"\n[motion]\nfile = "{file}"\nstart = 0.5\n'
    scene = read(written(tmp_path, text + "end = 1.5\n"))
    assert scene.frame_count == 30 == read(written(tmp_path, "duration = 1.0\n" + text)).frame_count
    assert read(written(tmp_path, scene_text(scene))) == scene


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('prest = "easy"', "unknown prest: .*did you mean preset?"),
        ('[person]\noutfitt = "red"', "unknown person.outfitt: .*did you mean outfit?"),
        ("x = = 3", "a scene in TOML"),
        ("cameras = 2\n" + CAMERA, "cameras = N or .*got both"),
        ('view = "side"\n' + CAMERA, "view or .*got both"),
        ('view = "side"\ncameras = 3', "side with one camera"),
        ("camera = []", "at least one camera"),
        ("cameras = 9", "1 to 8"),
        (CAMERA.replace("look_at = [0, 0, 0.9]\n", ""), "got no look_at"),
        (CAMERA + "matrix = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\nrotation = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"
         "translation = [0, 0, 0]", "got both"),
        (CAMERA.replace("look_at = [0, 0, 0.9]", "look_at = [7, 0, 0.9]"), "camera cam1: expected to see the person"),
        (CAMERA.replace("look_at = [0, 0, 0.9]", "look_at = [3.5, 0, 0]"), "straight above or below"),
        (CAMERA.replace("3.5", "9.5") + "[room]\nhalf_width = 5.0", "camera cam1: expected a place inside the room"),
        (CAMERA + 'name = "a"\n' + CAMERA + 'name = "a"\n', "'a' twice"),
        ('[motion]\nkind = "walk"\nfile = "x.bvh"', "kind or file"),
        ('[motion]\nfile = "x.bvh"\nstart = 3\nend = 1', "start before end, got 3 and 1"),
        ('duration = 2\n[motion]\nfile = "x.bvh"\nend = 1', "duration or motion.end"),
        ("[motion]\nstart = 1", "start together with file"),
        ('[motion]\nkind = "fly"', "motion: kind: expected one of"),
        ("[motion]\nheading = nan", "motion.heading: expected a finite number"),
        (CAMERA + "[room]\nhalf_width = 4.0\n[motion]\nduration = 3", "unknown motion.duration"),
        (CAMERA + "[room]\nhalf_width = 3.6\n[motion]\nheading = 1.57\nplace = [0, 2.3]", "a way inside the room"),
        ('[[person.garment]]\nlabel = "hat"', "garment: label: expected one of"),
        ('[[person.garment]]\nlabel = "shirt"\npattern = "tartan"', "pattern: expected one of"),
        ('[person]\ncut = "toga"', "figure: cut: expected one of short_sleeves"),
        ('[person]\nhair = "mohawk"', "figure: hair: expected one of short"),
        ('[[other]]\ncut = "toga"', "figure: cut: expected one of short_sleeves"),
        ("[person]\nlooseness = 3", "looseness: expected 0 to 0.15 m"),
        ("[person]\nmotion = {kind = 'walk'}", "in .motion., got .person.motion."),
        ("[sensor]\nquality = 99", "quality: expected 0 .best. to 51"),
        ("[light]\ndirection = [1, 0, 0]", "a lamp above"),
        ("[[light.switch]]\ntime = 2\n[[light.switch]]\ntime = 1", "one after the other"),
        ("[[occluder]]\nplace = [3.5, 0]\nsize = [1, 1, 2]\n" + CAMERA, "outside every occluder"),
        ("duration = 0.01", "2 to 100000 frames"),
        ("seed = -1", "seed"),
    ],
)  # fmt: skip
def test_bad_input_is_one_line(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        read(written(tmp_path, text))
    assert "\n" not in str(caught.value)


def test_no_such_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a scene file"):
        read(tmp_path / "none.toml")


def test_the_page_names_every_key_and_no_other() -> None:
    page = PAGE.read_text(encoding="utf-8")
    keys_part = page[page.index("## Keys") : page.index("## What is simple")]
    documented = set(re.findall(r"^\| `(\w+)` \|", keys_part, re.MULTILINE))
    kinds = [kind for kind in vars(scene_tables).values() if isinstance(kind, type) and issubclass(kind, Table)]
    keys = {field.encode_name for kind in kinds for field in msgspec.structs.fields(kind)}
    tables = {"person", "camera", "room", "light", "sensor", "occluder", "other", "garment", "switch"}
    assert documented == keys - tables
    assert all(f"`[[{name}]]`" in page or f"`[{name}]`" in page or f".{name}]]`" in page for name in tables)
