"""Cameras as they run: a server on this machine sends pictures, stalls, dies and comes back."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.io.live import LiveConfig, LiveSource, is_live, without_password

QUICK = LiveConfig(depth=4, stall_s=1.0, reconnects=2, wait_s=0.01)


def picture(grey: int, size: tuple[int, int] = (64, 48)) -> np.ndarray:
    return np.full((size[1], size[0], 3), grey, np.uint8)


@contextmanager
def server(send: Callable[[int, Callable[[np.ndarray], None]], None]) -> Iterator[str]:
    """An MJPEG camera; `send(connection, show)` shows pictures and returns where the connection ends."""
    import cv2

    connections = []

    class Camera(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            connections.append(self)
            self.send_response(200)
            self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=frame")
            self.end_headers()

            def show(image: np.ndarray) -> None:
                data = cv2.imencode(".jpg", image)[1].tobytes()
                head = f"--frame\r\nContent-Type: image/jpeg\r\nContent-Length: {len(data)}\r\n\r\n"
                self.wfile.write(head.encode() + data + b"\r\n")

            try:
                send(len(connections), show)
            except OSError:
                pass  # nobody listens any more

        def log_message(self, *args: object) -> None:
            """Nothing on the terminal."""

    camera = ThreadingHTTPServer(("127.0.0.1", 0), Camera)
    camera.daemon_threads = True
    thread = threading.Thread(target=camera.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{camera.server_port}/"
    finally:
        camera.shutdown()
        camera.server_close()


def given(*connections: list[np.ndarray]) -> Callable[[str, float], Iterator[np.ndarray]]:
    """A camera that gives one list of pictures a connection, and then does not open."""
    rest = list(connections)

    def connect(address: str, stall_s: float) -> Iterator[np.ndarray]:
        if not rest:
            raise InputError(address, expected="a stream", got="none")
        yield from rest.pop(0)

    return connect


class TestServer:
    def test_pictures_come(self):
        """The first one goes in finding out what is sent; the others rise by 20 grey values, within the compression."""
        with server(lambda _, show: [show(picture(20 * k)) for k in range(12)]) as address:
            source = LiveSource(address, LiveConfig(depth=100, stall_s=5.0, reconnects=0))
            found = list(source.frames())
        assert len(found) >= 11 and source.size == (64, 48) and source.reconnects == 0
        assert np.allclose(np.diff([image.mean() for _, _, image in found]), 20, atol=4)
        assert all(a[0] < b[0] and a[1] <= b[1] for a, b in zip(found, found[1:]))

    def test_a_server_that_dies_and_comes_back(self):
        def send(connection: int, show: Callable) -> None:
            for k in range(8):
                show(picture(10 * connection + k))

        with server(send) as address:
            source = LiveSource(address, LiveConfig(depth=1000, stall_s=5.0, reconnects=1, wait_s=0.01))
            frames = source.frames()
            levels = []
            for _, _, image in frames:
                levels.append(round(float(image.mean())))
                if levels[-1] > 29:
                    break
            frames.close()
        assert source.reconnects >= 2 and min(levels) < 20

    def test_a_stall_ends_the_connection(self):
        """The server sends and then is silent for far longer than a stall may be."""
        stopped = threading.Event()

        def send(connection: int, show: Callable) -> None:
            for k in range(8):
                show(picture(20 + k))
            stopped.wait(30)

        with server(send) as address:
            source = LiveSource(address, LiveConfig(depth=100, stall_s=1.0, reconnects=0))
            begun = time.monotonic()
            found = list(source.frames())
            took = time.monotonic() - begun
            stopped.set()
        assert len(found) >= 7 and source.ended and took < 20

    def test_nobody_there(self):
        with server(lambda _, show: None) as address:
            pass  # closed again
        with pytest.raises(InputError, match="127.0.0.1"):
            list(LiveSource(address, QUICK).frames())

    def test_no_pictures_in_it(self):
        with server(lambda _, show: None) as address, pytest.raises(InputError, match="expected a stream"):
            list(LiveSource(address, QUICK).frames())


class TestQueue:
    def test_late_pictures_are_dropped_and_counted(self):
        """The reader takes one and waits until all were sent: of 20, the queue's last 4 are left."""
        sent = threading.Event()

        def connect(address: str, stall_s: float) -> Iterator[np.ndarray]:
            for k in range(20):
                yield picture(k)
            sent.set()

        source = LiveSource("1", LiveConfig(depth=4, reconnects=0), connect=connect)
        frames = source.frames()
        first = next(frames)
        assert sent.wait(10)
        numbers = [first[0], *(number for number, _, _ in frames)]
        assert numbers[-4:] == [16, 17, 18, 19] and source.received == 20
        assert source.dropped == 20 - len(numbers) and len(numbers) <= 2 * 4

    def test_repeated_pictures_are_counted(self):
        source = LiveSource("1", QUICK, connect=given([picture(1), picture(1), picture(2), picture(1), picture(1)]))
        list(source.frames())
        assert source.repeated == 2 and source.facts()["repeated"] == 2

    def test_prepared_in_the_reading_thread(self):
        """An 8K camera's pictures wait at the size that is worked on."""
        large = np.zeros((4320, 7680, 3), np.uint8)
        source = LiveSource("1", QUICK, connect=given([large]), prepare=lambda image: image[::6, ::6])
        assert [image.shape for _, _, image in source.frames()] == [(720, 1280, 3)] and source.size == (7680, 4320)


class TestReconnecting:
    def test_so_many_tries_in_a_row(self):
        """Two connections have pictures; two tries after each other then have none."""
        source = LiveSource("1", QUICK, connect=given([picture(1)], [picture(2)]))
        assert len(list(source.frames())) == 2
        assert source.reconnects == 1 + 2 and source.ended == "it could not be opened again"

    def test_tries_count_anew_after_a_picture(self):
        source = LiveSource("1", QUICK, connect=given([picture(1)], [], [picture(2)], [], [picture(3)]))
        assert [int(image[0, 0, 0]) for _, _, image in source.frames()] == [1, 2, 3]

    def test_another_size_ends_it(self):
        source = LiveSource("1", QUICK, connect=given([picture(1)], [picture(2, (32, 24))]))
        assert len(list(source.frames())) == 1
        assert source.ended == "pictures of another size: 32 x 24 after 64 x 48"

    def test_what_goes_wrong_in_the_thread_is_raised(self):
        def fail(image: np.ndarray) -> np.ndarray:
            raise ZeroDivisionError

        with pytest.raises(ZeroDivisionError):
            list(LiveSource("1", QUICK, connect=given([picture(1)]), prepare=fail).frames())

    def test_settings(self):
        with pytest.raises(InputError, match="depth from 1"):
            LiveConfig(depth=0)


class TestAddress:
    @pytest.mark.parametrize(
        ("text", "live"), [("0", True), ("rtsp://camera/1", True), ("a.mp4", False), ("frames/%04d.png", False)]
    )
    def test_is_live(self, text, live):
        assert is_live(text) is live

    def test_a_file_of_that_name_wins(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "7").mkdir()
        assert not is_live("7")

    def test_passwords_are_not_told(self):
        assert without_password("http://me:secret@host:80/a@b") == "http://host:80/a@b"
        with pytest.raises(InputError) as error:
            list(LiveSource("http://me:secret@127.0.0.1:1/", QUICK).frames())
        assert "secret" not in str(error.value)

    def test_no_webcam(self):
        with pytest.raises(InputError, match="camera 97"):
            list(LiveSource("97", QUICK).frames())
