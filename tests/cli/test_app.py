"""The command line as its user meets it: exit codes, one line for bad input, one JSON object where asked for."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from muybridge.cli import app, reporting
from muybridge.errors import InputError

ROOT = Path(__file__).resolve().parents[2]


def say(monkeypatch: pytest.MonkeyPatch, command: object) -> int:
    """The exit code of a command that does what `command` does."""
    monkeypatch.setattr(app, "build", lambda: lambda *_, **__: command())  # type: ignore[operator]
    return app.run([])


class TestExitCodes:
    def test_done_and_lost_are_the_commands_own(self, monkeypatch: pytest.MonkeyPatch) -> None:
        assert say(monkeypatch, lambda: None) == 0
        assert say(monkeypatch, lambda: 3) == 3

    @pytest.mark.parametrize(
        ("error", "code", "words"),
        [
            (InputError("body", expected="a tree", got="a cycle"), 2, "body: expected a tree, got a cycle"),
            (OSError(28, "No space left on device", "joints.csv"), 2, "joints.csv: No space left on device"),
            (KeyboardInterrupt(), 130, "kept"),
            (KeyboardInterrupt("interrupted after\nframe 3"), 130, "interrupted after frame 3"),
        ],
    )
    def test_expected_trouble_is_one_line(
        self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture, error: BaseException, code: int, words: str
    ) -> None:
        def fail() -> None:
            raise error

        assert say(monkeypatch, fail) == code
        out, line = capfd.readouterr()
        assert out == "" and line.count("\n") == 1 and words in line

    def test_warnings_are_a_line_each_once(self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture) -> None:
        def warn() -> None:
            for _ in range(3):
                warnings.warn("left.mp4: two frames\nare damaged", stacklevel=1)

        assert say(monkeypatch, warn) == 0
        assert capfd.readouterr().err == "muybridge: note: left.mp4: two frames are damaged\n"

    def test_an_error_is_the_only_line(self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture) -> None:
        def fail() -> None:
            warnings.warn("left.mp4: truncated", stacklevel=1)
            raise InputError("left.mp4", expected="10 frames", got="1")

        assert say(monkeypatch, fail) == 2
        assert capfd.readouterr().err == "muybridge: left.mp4: expected 10 frames, got 1\n"

    def test_a_mistake_of_ours_is_not_hidden(self, monkeypatch: pytest.MonkeyPatch) -> None:
        with pytest.raises(ZeroDivisionError):
            say(monkeypatch, lambda: 1 // 0)


class TestArguments:
    @pytest.mark.parametrize(
        ("arguments", "words"),
        [
            (["trak"], 'Did you mean "track"'),
            (["track"], "JOB"),
            (["track", "a.toml", "--sed", "3"], "--seed"),
            (["track", "a.toml", "--seed", "three"], "int"),
            (["track", "none.toml"], "none.toml: expected a job file"),
            (["evaluate", "none", "--truth", "x"], "none"),
            (["evaluate", "none", "--truth", "x", "--alignment", "all"], "rigid"),
        ],
    )
    def test_bad_ones_are_one_line(self, capfd: pytest.CaptureFixture, arguments: list[str], words: str) -> None:
        assert app.run(arguments) == 2
        out, line = capfd.readouterr()
        assert out == "" and line.count("\n") == 1 and words in line

    @pytest.mark.parametrize("command", app.COMMANDS)
    def test_every_command_explains_itself(self, capfd: pytest.CaptureFixture, command: str) -> None:
        assert app.run([command, "--help"]) == 0
        out = capfd.readouterr().out
        assert command in out and "--quiet" in out and "--json" in out

    def test_help_names_every_command(self, capfd: pytest.CaptureFixture) -> None:
        assert app.run(["--help"]) == 0
        out = capfd.readouterr().out
        assert all(f" {command} " in out for command in app.COMMANDS)


def test_help_waits_for_nothing_heavy() -> None:
    """Modules loaded stand for the time: numpy, numba and OpenCV are what takes it."""
    code = "import sys; from muybridge.cli import app; app.run(['--help']); "
    code += "sys.exit(' '.join({'numpy', 'numba', 'cv2', 'av', 'scipy'} & set(sys.modules)))"
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    result = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert "track" in result.stdout and result.stderr.strip() == ""


class TestReporting:
    def test_quiet_leaves_the_json_line(self, capfd: pytest.CaptureFixture) -> None:
        said = reporting.Reporting(quiet=True, json=True)
        said.say("hello")
        said.finish({"a": 1})
        assert capfd.readouterr().out == '{"a": 1}\n'

    def test_without_json_there_is_no_json_line(self, capfd: pytest.CaptureFixture) -> None:
        said = reporting.Reporting()
        said.say("hello")
        said.finish({"a": 1})
        assert capfd.readouterr().out == "hello\n"

    def test_json_is_strict(self) -> None:
        import numpy as np

        value = {"mean": np.float32("nan"), "at": Path("a/b"), "all": (np.int64(3), float("inf")), "ok": np.bool_(True)}
        assert json.loads(json.dumps(reporting.plain(value), allow_nan=False)) == {
            "mean": None, "at": "a/b", "all": [3, None], "ok": True,
        }  # fmt: skip

    def test_progress_is_silent_where_nobody_watches(self, capfd: pytest.CaptureFixture) -> None:
        with reporting.Reporting().progress("frames") as progress:
            progress(1, 10)
        assert capfd.readouterr() == ("", "")


def test_doctor(capfd: pytest.CaptureFixture) -> None:
    assert app.run(["doctor", "--json"]) == 0
    record = json.loads(capfd.readouterr().out.splitlines()[-1])
    assert record["problems"] == {} and record["numpy"]
