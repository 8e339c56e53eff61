"""Our own file: nothing is lost, and nothing is guessed."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from muybridge.cameras import Camera, Rig
from muybridge.cameras.json_format import read_json, write_rig
from muybridge.cameras.rotations import rotation_from_vector
from muybridge.errors import InputError

number = st.floats(-1e4, 1e4)


@st.composite
def rigs(draw) -> Rig:
    def camera(name: str) -> Camera:
        return Camera(
            name=name,
            size=(draw(st.integers(1, 9999)), 480),
            matrix=[[draw(st.floats(1, 1e5)), draw(number), draw(number)], [0, draw(st.floats(1, 1e5)), 9], [0, 0, 1]],
            distortion=[draw(number) for _ in range(5)],
            rotation=rotation_from_vector(np.array([draw(number) / 3000 for _ in range(3)])),
            translation=[draw(number) for _ in range(3)],
        )

    return Rig(tuple(camera(name) for name in ("links", "größer", "右")[: draw(st.integers(1, 3))]))


@pytest.fixture
def document(tmp_path) -> dict:
    camera = Camera("a", (640, 480), np.diag([600.0, 600, 1]), np.zeros(5), np.eye(3), (0, 0, 3))
    write_rig(tmp_path / "rig.json", Rig((camera,)))
    return json.loads((tmp_path / "rig.json").read_text())


@given(rigs())
def test_round_trip_is_exact(tmp_path_factory, rig):
    path = tmp_path_factory.mktemp("rig") / "rig.json"
    write_rig(path, rig)
    assert tuple(read_json([path])) == rig.cameras


def test_units_are_named(document):
    assert document["format"] == "muybridge-cameras" and document["version"] == 1
    assert {"size_px", "matrix_px", "translation_m"} < set(document["cameras"][0])


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda d: d.update(version=2), "version"),
        (lambda d: d.pop("version"), "version"),
        (lambda d: d.pop("format"), "another kind"),
        (lambda d: d.pop("cameras"), "'cameras'"),
        (lambda d: d.update(cameras={}), "list of objects"),
        (lambda d: d.update(cameras=[1]), "list of objects"),
        (lambda d: d["cameras"][0].pop("translation_m"), "camera 1.*'translation_m'"),
        (lambda d: d["cameras"][0].update(translation_m=[1, 2]), "3 numbers, got 2"),
        (lambda d: d["cameras"][0].update(translation_m=[1, 2, 10**400]), "numbers"),
        (lambda d: d["cameras"][0].update(translation_m=[1, 2, float("nan")]), "finite"),
        (lambda d: d["cameras"][0].update(name=5), "camera name"),
        (lambda d: d["cameras"][0].update(rotation_world_to_camera=[[1, 2, 3]]), "9 numbers"),
    ],
)
def test_errors_are_one_line(tmp_path, document, change, says):
    change(document)
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=says) as caught:
        read_json([path])
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["", "{", "[" * 100_000, "[1]", "9" * 5000])
def test_what_is_no_such_json(tmp_path, text):
    path = tmp_path / "bad.json"
    path.write_text(text)
    with pytest.raises(InputError, match="JSON"):
        read_json([path])
