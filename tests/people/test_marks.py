"""Marks: from a file, from the page, and taken up by `people`; sizes learnt from the clip or from a calibration."""

from __future__ import annotations

import http.client
import json
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from made_people import CROWD, HEIGHT, OFFSET, SLOPE, WIDTH, empty_scene, picture_of
from muybridge.cameras.json_format import write_rig
from muybridge.cameras.model import Rig
from muybridge.cli import app
from muybridge.errors import InputError
from muybridge.io.video import open_pictures
from muybridge.people.mark_server import LARGEST, MarkServer
from muybridge.people.marks import (
    Marks,
    calibrated_smallest,
    learnt_smallest,
    read_marks,
    read_polygons,
    write_marks,
)
from muybridge.people.run import PeopleConfig
from muybridge.synthetic.rigs import looking_at

SQUARE = ((10.0, 20.0), (29.0, 20.0), (29.0, 59.0), (10.0, 59.0))
MARKS = Marks((SQUARE,), 52.0)


class TestMarks:
    def test_mask(self) -> None:
        """Corners are pixels, and belong to it."""
        mask = MARKS.mask((64, 48))
        assert mask.shape == (48, 64) and np.count_nonzero(mask) == 20 * 28 and mask[20, 10] and not mask[19, 10]

    def test_outside_is_cut_off(self) -> None:
        around = Marks((((-1e9, -1e9), (1e9, -1e9), (1e9, 1e9), (-1e9, 1e9)),))
        assert around.mask((64, 48)).all()

    def test_there_and_back(self, tmp_path: Path) -> None:
        write_marks(tmp_path, MARKS, (64, 64))
        assert read_polygons(tmp_path / "marks.json") == MARKS
        mask, settings = read_marks(tmp_path)
        assert np.array_equal(mask, MARKS.mask((64, 64)))
        config = PeopleConfig().with_settings(settings)
        assert config.tracker.smallest == 52 and config.tracker.blobs.smallest == round(0.12 * 52**2)

    def test_nothing_marked(self, tmp_path: Path) -> None:
        write_marks(tmp_path, Marks(), (64, 64))
        assert read_marks(tmp_path) == (None, [])

    @pytest.mark.parametrize(
        ("text", "words"),
        [
            ("[", "no JSON"),
            ("[1]", "expected"),
            ('{"polygon": []}', "expected"),
            ('{"polygons": [[[1, 2], [3, 4]]]}', "three corners"),
            ('{"polygons": [[[1, 2], [3, 4], [5]]]}', "something else"),
            ('{"polygons": [[[1, 2], [3, 4], [5, NaN]]]}', "finite"),
            ('{"smallest": 3}', "8 to 10000"),
        ],
    )
    def test_wrong_files(self, tmp_path: Path, text: str, words: str) -> None:
        (tmp_path / "marks.json").write_text(text)
        with pytest.raises(InputError, match=words):
            read_polygons(tmp_path / "marks.json")


@pytest.fixture
def server(tmp_path: Path) -> Iterator[MarkServer]:
    with MarkServer(np.full((48, 64, 3), 7, np.uint8), tmp_path / "marks", MARKS) as server:
        thread = threading.Thread(target=server.serve_until_done, daemon=True)
        thread.start()
        yield server
        if not server.finished:
            ask(server, "POST", "/done", {"polygons": []})
        thread.join(10)
        assert not thread.is_alive()


def ask(
    server: MarkServer, method: str, path: str, table: object = None, headers: dict[str, str] | None = None
) -> tuple[int, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=10)
    try:
        connection.request(method, path, None if table is None else json.dumps(table), headers or {})
        answer = connection.getresponse()
        return answer.status, answer.read()
    finally:
        connection.close()


class TestServer:
    def test_the_page_needs_nothing_from_elsewhere(self, server: MarkServer) -> None:
        code, page = ask(server, "GET", "/")
        assert code == 200 and b"<canvas" in page and b"http" not in page and b" src=" not in page

    def test_picture_and_marks(self, server: MarkServer) -> None:
        import cv2

        picture = cv2.imdecode(np.frombuffer(ask(server, "GET", "/picture.png")[1], np.uint8), cv2.IMREAD_COLOR)
        assert picture.shape == (48, 64, 3) and (picture == 7).all()
        assert json.loads(ask(server, "GET", "/marks")[1]) == {"polygons": [[[*p] for p in SQUARE]], "smallest": 52}
        assert ask(server, "GET", "/etc/passwd")[0] == 404 and ask(server, "POST", "/", {})[0] == 404

    def test_saving(self, server: MarkServer) -> None:
        code, said = ask(server, "POST", "/marks", {"polygons": [[[0, 0], [31, 0], [31, 47], [0, 47]]], "smallest": 20})
        assert code == 200 and "50.0%" in json.loads(said)["said"] and not server.finished
        mask, settings = read_marks(server.folder)
        assert mask is not None and mask.mean() == 0.5 and "tracker.smallest=20" in settings

    def test_the_last_button(self, server: MarkServer) -> None:
        assert ask(server, "POST", "/done", {"polygons": [], "smallest": None})[0] == 200
        until = time.monotonic() + 10  # the answer comes first, so that the browser has it
        while not server.finished and time.monotonic() < until:
            time.sleep(0.01)
        assert server.finished and read_marks(server.folder) == (None, [])

    @pytest.mark.parametrize("table", [{"polygons": [[[1, 2]]]}, [], {"smallest": "tall"}])
    def test_wrong_marks_are_said_and_not_saved(self, server: MarkServer, table: object) -> None:
        code, said = ask(server, "POST", "/marks", table)
        assert code == 400 and "expected" in json.loads(said)["said"] and not server.folder.exists()

    def test_too_much(self, server: MarkServer) -> None:
        assert ask(server, "POST", "/marks", headers={"Content-Length": str(LARGEST + 1)})[0] == 400

    @pytest.mark.parametrize("headers", [{"Host": "evil.example"}, {"Origin": "http://evil.example"}])
    def test_other_pages_are_refused(self, server: MarkServer, headers: dict[str, str]) -> None:
        assert ask(server, "GET", "/marks", headers=headers)[0] == 403
        assert ask(server, "POST", "/marks", {"polygons": []}, headers)[0] == 403 and not server.folder.exists()

    def test_a_port_that_is_taken(self, server: MarkServer, tmp_path: Path) -> None:
        with pytest.raises(InputError, match="a free one"):
            MarkServer(np.zeros((4, 4, 3), np.uint8), tmp_path, port=server.server_port)


class TestSizes:
    def test_calibrated(self) -> None:
        """A level camera 2 m high with 500 pixels focal length: 1.5 m are 500 x 1.5 / depth pixels, and 10 m away from
        the camera is a depth of sqrt(100 - 4) m at most; the grid of places may miss the furthest by a metre."""
        camera = looking_at("cam", np.array([0.0, 0, 2]), np.array([5.0, 0, 2]), focal=500, size=(640, 480))
        least = 500 * 1.5 / np.sqrt(96)
        assert least - 1 <= calibrated_smallest(camera, 10.0) <= least * np.sqrt(96) / (np.sqrt(96) - 1.5)

    def test_no_floor(self) -> None:
        up = looking_at("cam", np.array([0.0, 0, 2]), np.array([5.0, 0, 9]), focal=500, size=(640, 480))
        with pytest.raises(InputError, match="within 10 m"):
            calibrated_smallest(up, 10.0)

    def test_learnt(self, tmp_path: Path) -> None:
        """The furthest feet of the crowd are in row 110, and such a person is this tall; a mask's edge is a pixel off,
        and the lowest percentiles of the heights are those of people a little nearer."""
        import cv2

        for frame in range(90):
            cv2.imwrite(str(tmp_path / f"{frame:03d}.png"), picture_of(CROWD, frame, empty_scene())[0])
        with open_pictures(tmp_path, 10) as pictures:
            found = learnt_smallest(pictures)
        least = OFFSET + SLOPE * 110
        assert 0.9 * (least - 2) - 1 <= found <= least * 1.15

    def test_too_few_people_to_learn_from(self, tmp_path: Path) -> None:
        import cv2

        for frame in range(5):
            cv2.imwrite(str(tmp_path / f"{frame}.png"), empty_scene())
        with open_pictures(tmp_path) as pictures, pytest.raises(InputError, match="12 people"):
            learnt_smallest(pictures)


class TestCommand:
    @pytest.fixture
    def picture(self, tmp_path: Path) -> Path:
        import cv2

        cv2.imwrite(str(tmp_path / "camera.png"), empty_scene())
        return tmp_path / "camera.png"

    def test_from_a_file(self, picture: Path, tmp_path: Path, capfd: pytest.CaptureFixture) -> None:
        (tmp_path / "mine.json").write_text('{"polygons": [[[0, 0], [159, 0], [159, 239], [0, 239]]]}')
        options = ["--polygons", str(tmp_path / "mine.json"), "--smallest", "40", "--json"]
        assert app.run(["mark", str(picture), "--out", str(tmp_path / "out"), *options]) == 0
        record = json.loads(capfd.readouterr().out.splitlines()[-1])
        assert record["occluded_share"] == 0.5 and record["smallest"] == 40 and record["polygons"] == 1
        assert read_marks(tmp_path / "out")[0].shape == (HEIGHT, WIDTH)

    def test_from_a_calibration(self, picture: Path, tmp_path: Path) -> None:
        camera = looking_at("cam", np.array([0.0, 0, 3]), np.array([5.0, 0, 1]), focal=300, size=(WIDTH, HEIGHT))
        write_rig(tmp_path / "rig.json", Rig((camera,)))
        assert (
            app.run(["mark", str(picture), "--out", str(tmp_path / "out"), "--calibration", str(tmp_path / "rig.json")])
            == 0
        )
        assert read_polygons(tmp_path / "out/marks.json").smallest == calibrated_smallest(camera, 20.0)

    @pytest.mark.parametrize(
        ("options", "words"),
        [
            (["--learn", "--smallest", "40"], "one of --smallest"),
            (["--polygons", "none.json"], "none.json"),
            (["--smallest", "2"], "8 to 10000"),
        ],
    )
    def test_errors(
        self, picture: Path, tmp_path: Path, capfd: pytest.CaptureFixture, options: list[str], words: str
    ) -> None:
        assert app.run(["mark", str(picture), "--out", str(tmp_path / "out"), *options]) == 2
        assert words in capfd.readouterr().err and not (tmp_path / "out").exists()
