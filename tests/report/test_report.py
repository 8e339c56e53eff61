"""The report is one file that needs no other, says what happened, and survives whatever a run left out."""

from __future__ import annotations

import re
from html.parser import HTMLParser

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.evaluation import JOINTS
from muybridge.io.run_folder import JointSeries, write_joints, write_summary
from muybridge.report import gather, write_report
from muybridge.report.content import read_diagnostics
from muybridge.report.plots import write_plots

SUMMARY = {
    "status": "done",
    "frames": 30,
    "seed": 1,
    "settings": {"filter": {"particles": 200}},
    "versions": {"muybridge": "0.1.0"},
    "evaluations_per_frame": 900,
    "ms_per_frame": {"median": 21.4, "p95": 27.0},
    "peak_memory_mb": 410.0,
}


def make_run(folder, names=JOINTS, summary=SUMMARY, frames=30, shift=0.0):
    folder.mkdir(exist_ok=True)
    points = (
        np.random.default_rng(4).normal(size=(15, 3))[None, : len(names)] + np.linspace(0, 0.1, frames)[:, None, None]
    )
    sd = np.full(points.shape[:2], 0.01)
    write_joints(
        folder / "joints.csv", JointSeries(names, np.arange(frames), np.arange(frames) / 50, points + shift, sd)
    )
    write_summary(folder, summary)
    return folder


class Checker(HTMLParser):
    """Tags closed as opened, and every address that the page would fetch."""

    VOID = {"meta", "img", "source", "br", "link"}

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.addresses: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.addresses += [value for name, value in attrs if name in ("src", "srcset", "href")]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def check(text: str) -> Checker:
    checker = Checker()
    checker.feed(text)
    assert checker.open == []
    assert all(address.startswith("data:") for address in checker.addresses)
    return checker


class TestWriteReport:
    def test_a_whole_run(self, tmp_path):
        run = make_run(tmp_path / "run")
        truth = make_run(tmp_path / "truth", shift=0.01)
        rows = "".join(f"{frame},{frame / 50},{150 if frame != 7 else 3},0.3\n" for frame in range(30))
        (run / "diagnostics.csv").write_text("frame,time_s,ess,acceptance\n" + rows)
        write_summary(run, SUMMARY | {"cameras": {"cam01": {"shift_px": [10.0, -0.25], "residual_px": 1.5}}})
        text = write_report(run, truth, alignment="none").read_text()
        checker = check(text)
        assert len(checker.addresses) == 2 * 4  # errors, angles, certainty, path; each light and dark
        for part in (
            "17.3 mm",
            "mean error, alignment none",
            "21 ms",
            "900",
            "effective sample size below 5 %",
            "Self-check of the cameras",
            "+10.0, -0.2",
            "Joint angles",
            "All numbers",
        ):
            assert part in text
        assert not re.search(r"https?://(?!www\.w3\.org)", text)

    def test_without_truth_and_diagnostics(self, tmp_path):
        text = write_report(make_run(tmp_path / "run")).read_text()
        check(text)
        assert "Nothing that can be seen from the outside" in text
        assert "Error against the truth" not in text
        assert "Self-check" not in text

    def test_a_body_that_is_no_person(self, tmp_path):
        text = write_report(make_run(tmp_path / "run", names=("nose", "tail"))).read_text()
        check(text)
        assert "Joint angles" not in text

    @pytest.mark.parametrize("frames", [1, 2])
    def test_short_runs(self, tmp_path, frames):
        check(write_report(make_run(tmp_path / "run", frames=frames)).read_text())

    def test_long_runs_are_drawn_as_pixels(self, tmp_path, monkeypatch):
        monkeypatch.setattr("muybridge.report.figures.MOST_VECTOR_FRAMES", 20)
        text = write_report(make_run(tmp_path / "run")).read_text()
        check(text)
        assert "data:image/png" in text
        assert "data:image/svg" not in text

    def test_nothing_unknown_breaks_it(self, tmp_path):
        odd = dict.fromkeys(SUMMARY) | {"status": "lost", "cameras": "unknown"}
        text = write_report(make_run(tmp_path / "run", summary=odd)).read_text()
        check(text)
        assert 'class="status bad">lost' in text

    def test_names_are_escaped(self, tmp_path):
        text = write_report(make_run(tmp_path / "a<script>b", summary=SUMMARY | {"status": "<b>"})).read_text()
        check(text)
        assert "<script" not in text
        assert "a&lt;script&gt;b" in text

    def test_the_same_run_gives_the_same_bytes(self, tmp_path):
        run = make_run(tmp_path / "run")
        assert write_report(run).read_bytes() == write_report(run).read_bytes()


class TestOverlays:
    def test_contact_sheets(self, tmp_path):
        from muybridge.io.video_writer import VideoWriter

        run = make_run(tmp_path / "run")
        with VideoWriter(run / "overlay_cam01.mp4", 50) as video:
            for frame in range(30):
                video.write(np.full((48, 64, 3), 8 * frame, np.uint8))
        (run / "overlay_broken.mp4").write_bytes(b"no video")
        assert set(gather(run).sheets) == {"cam01"}
        text = write_report(run).read_text()
        check(text)
        assert "data:image/jpeg" in text


class TestPlots:
    def test_one_file_for_each_figure_there_is(self, tmp_path):
        run = make_run(tmp_path / "run")
        written = write_plots(run, gather(run, make_run(tmp_path / "truth")))
        assert [path.stem for path in written] == ["angles", "errors", "health", "path"]
        assert all(path.read_bytes().startswith(b"\x89PNG") for path in written)

    def test_nothing_to_draw(self, tmp_path):
        run = make_run(tmp_path / "run", names=("nose",))
        assert [path.stem for path in write_plots(run, gather(run))] == ["health"]


class TestErrors:
    def test_no_folder(self, tmp_path):
        with pytest.raises(InputError, match="run folder"):
            write_report(tmp_path / "absent")

    def test_no_summary(self, tmp_path):
        run = make_run(tmp_path / "run")
        (run / "run.json").unlink()
        with pytest.raises(InputError, match=r"run\.json"):
            write_report(run)


class TestDiagnostics:
    def test_rows_find_their_frames(self, tmp_path):
        (tmp_path / "d.csv").write_text("frame,ess,empty\n5,50,\n4,40,\nx,1,\n9,90,\n")
        found = read_diagnostics(tmp_path / "d.csv", np.array([4, 5, 6]))
        assert set(found) == {"ess"}
        np.testing.assert_array_equal(found["ess"], [40, 50, np.nan])

    def test_absent(self, tmp_path):
        assert read_diagnostics(tmp_path / "d.csv", np.arange(3)) == {}
