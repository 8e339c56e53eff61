"""A page in the browser of this machine on which marks are drawn; nobody else can reach it."""

from __future__ import annotations

import json
from dataclasses import asdict
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from muybridge.errors import InputError
from muybridge.people.mark_page import PAGE
from muybridge.people.marks import Marks, marks_from, write_marks

LARGEST = 2**20  # bytes of marks that are read
HOSTS = ("127.0.0.1", "localhost")


class MarkServer(ThreadingHTTPServer):
    """Serves one picture (H, W, 3) uint8 BGR, and writes the marks that are drawn on it into a folder.

    port : 0 takes a free one
    """

    daemon_threads = True
    timeout = 0.2  # seconds: how often it is looked whether the last button was pressed

    def __init__(self, picture: NDArray[np.uint8], folder: Path, marks: Marks | None = None, port: int = 0) -> None:
        import cv2

        self.folder, self.marks = folder, marks or Marks()
        self.size = picture.shape[1], picture.shape[0]
        self.picture: bytes = cv2.imencode(".png", picture)[1].tobytes()
        self.finished = False
        try:
            super().__init__(("127.0.0.1", port), _Page)
        except OSError as error:
            raise InputError(f"port {port}", expected="a free one", got=error.strerror or str(error),
                             remedy="leave --port out") from None  # fmt: skip

    @property
    def address(self) -> str:
        """Where the page is."""
        return f"http://127.0.0.1:{self.server_port}/"

    def serve_until_done(self) -> None:
        """Until somebody presses the last button."""
        while not self.finished:
            self.handle_request()

    def save(self, marks: Marks) -> str:
        """Write them; what is to be said about it."""
        write_marks(self.folder, marks, self.size)
        self.marks = marks
        return f"saved in {self.folder}: {marks.mask(self.size).mean():.1%} of the picture hides people"


class _Page(BaseHTTPRequestHandler):
    server: MarkServer

    def do_GET(self) -> None:
        """The page, the picture, or the marks so far."""
        if not self._is_ours():
            return
        if self.path == "/":
            self._answer(200, "text/html; charset=utf-8", PAGE.encode())
        elif self.path == "/picture.png":
            self._answer(200, "image/png", self.server.picture)
        elif self.path == "/marks":
            self._tell(200, asdict(self.server.marks))
        else:
            self._tell(404, {"said": "there is nothing"})

    def do_POST(self) -> None:
        """Marks: to be saved, and perhaps the last ones."""
        if not self._is_ours():
            return
        if self.path not in ("/marks", "/done"):
            return self._tell(404, {"said": "there is nothing"})
        try:
            said = self.server.save(marks_from(self._body(), "marks"))
        except InputError as error:
            return self._tell(400, {"said": str(error)})
        self._tell(200, {"said": said if self.path == "/marks" else f"{said}; this page may be closed"})
        self.server.finished = self.path == "/done"

    def log_message(self, *args: object) -> None:
        """Nothing on the terminal."""

    def _is_ours(self) -> bool:
        """Whether the request is for this machine by name: other pages' names may be made to lead here."""
        ours = (self.headers.get("Host") or "").rsplit(":", 1)[0] in HOSTS
        origin = self.headers.get("Origin")
        ours = ours and (origin is None or origin.split("//")[-1].rsplit(":", 1)[0] in HOSTS)
        if not ours:
            self._tell(403, {"said": "only this machine's own browser is served"})
        return ours

    def _body(self) -> object:
        length = self.headers.get("Content-Length") or ""
        if not length.isdigit() or int(length) > LARGEST:
            raise InputError("marks", expected=f"up to {LARGEST} bytes", got=length or "an unknown length")
        try:
            return json.loads(self.rfile.read(int(length)))
        except ValueError:
            raise InputError("marks", expected="JSON", got="something else") from None

    def _tell(self, code: int, table: object) -> None:
        self._answer(code, "application/json", json.dumps(table).encode())

    def _answer(self, code: int, kind: str, content: bytes) -> None:
        self.send_response(code)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(content)
