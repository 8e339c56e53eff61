"""The job file: what is read is what was meant, and what was not meant is said in one line."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from muybridge.errors import InputError
from muybridge.io import _toml, job

TEXT = """
name = "walk"
frames = [10, 20]

[calibration]
file = "calibration.toml"
unit = "mm"

[[camera]]
name = "left"
pictures = "left.mp4"
masks = "masks/left_%04d.png"

[[camera]]
name = "right"
pictures = "/elsewhere/right.mp4"
background = { kind = "plate", file = "plate.png", threshold = 12 }

[body]
file = "body.toml"
measures = { left_thigh = 0.41 }

[start]
pose = "first.csv"

[filter]
name = "annealed"
particles = 200
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "job.toml").write_text(TEXT)
    return tmp_path / "job.toml"


def line_of(error: pytest.ExceptionInfo[InputError]) -> str:
    assert "\n" not in str(error.value)
    return str(error.value)


class TestRead:
    def test_values(self, path: Path) -> None:
        read = job.read(path)
        assert read.name == "walk" and read.frames == (10, 20) and read.calibration.unit == "mm"
        assert [camera.name for camera in read.cameras] == ["left", "right"]
        assert read.filter.name == "annealed" and read.filter.settings == {"particles": 200}
        assert read.cameras[1].background is not None
        assert read.cameras[1].background.settings == {"threshold": 12}

    def test_relative_paths_start_from_the_files_folder(self, path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.chdir(path.parent)
        for read in (job.read(path), job.read("job.toml")):
            assert read.calibration.file == path.parent / "calibration.toml"
            assert read.cameras[0].masks == path.parent / "masks/left_%04d.png"
            assert read.cameras[1].pictures == Path("/elsewhere/right.mp4")
            assert read.start.file == path.parent / "first.csv"

    @pytest.mark.parametrize("word", ["auto", "reference"])
    def test_start_words_are_no_paths(self, path: Path, word: str) -> None:
        read = job.read(path, [f"start.pose={word}", "reference.file=truth.trc"])
        assert read.start.pose == word and read.start.file is None

    def test_defaults(self) -> None:
        table = {"calibration": {"file": "c"}, "camera": [{"name": "a", "pictures": "a.mp4"}]}
        read = job.from_table(table, Path("/data"))
        assert read.seed == 1 and read.frames is None and read.filter.name == "auto"
        assert read.start.pose == "auto" and read.body.fit and not read.calibration.corrected


class TestChosenFilter:
    CAMERAS = [{"name": name, "pictures": f"{name}.mp4"} for name in "ab"]

    def chosen(self, cameras: int, overrides: list[str]) -> job.FilterInput:
        table = {"calibration": {"file": "c"}, "camera": self.CAMERAS[:cameras]}
        return job.from_table(table, Path("/data"), overrides=overrides).chosen_filter

    def test_several_cameras_climb_and_one_searches(self) -> None:
        assert self.chosen(2, []) == job.FilterInput(name="guided")
        one = self.chosen(1, [])
        assert one.name == "annealed" and one.settings == {"particles": 500, "layers": 10, "by_limb": False}

    def test_what_is_given_wins(self) -> None:
        assert self.chosen(1, ["filter.layers=3"]).settings["layers"] == 3
        assert self.chosen(1, ["filter.name=guided"]) == job.FilterInput(name="guided")

    def test_a_paper_is_not_mended(self) -> None:
        one = self.chosen(1, ["filter.preset=printed"])
        assert one == job.FilterInput(name="annealed", preset="printed")


class TestOverrides:
    def test_values_keep_their_type(self, path: Path) -> None:
        read = job.read(path, ["filter.particles=1000", "likelihood.colour=0.5", "body.fit=false", "name=run 3"])
        assert read.filter.settings["particles"] == 1000 and read.likelihood.colour == 0.5
        assert read.body.fit is False and read.name == "run 3"

    def test_a_camera_by_name_or_by_number(self, path: Path) -> None:
        read = job.read(path, ["camera.right.frame_rate=60", "camera.0.background.kind=hue_key"])
        assert read.cameras[1].frame_rate == 60
        assert read.cameras[0].background is not None and read.cameras[0].background.kind == "hue_key"

    @pytest.mark.parametrize(
        ("override", "words"),
        [
            ("particles", ["KEY=VALUE"]),
            ("filter..particles=1", ["KEY=VALUE"]),
            ("camera.middle.frame_rate=1", ["middle", "left, right"]),
            ("name.first=1", ["name to be a table"]),
            ("camera.left=1", ["camera.NAME"]),
        ],
    )
    def test_errors(self, path: Path, override: str, words: list[str]) -> None:
        with pytest.raises(InputError) as error:
            job.read(path, [override])
        assert all(word in line_of(error) for word in words)


class TestErrors:
    @pytest.mark.parametrize(
        ("override", "words"),
        [
            ("filtre.name=x", ["unknown filtre", "did you mean filter?"]),
            ("camera.left.pictrues=x", ["camera[0].pictrues", "did you mean pictures?"]),
            ("camera.left.frame_rate=-3", ["camera[0].frame_rate", "> 0"]),
            ("camera.left.name=right", ["different camera names"]),
            ("calibration.unit=km", ["m or cm or mm", "'km'"]),
            ("calibration.files=['a.cal']", ["calibration", "either file or files"]),
            ("frames=[20,10]", ["first <= last", "[20, 10]"]),
            ("frames=[-1,10]", [">= 0"]),
            ("seed='one'", ["seed", "expected int", "got str"]),
            ("camera=[]", ["camera", "length >= 1"]),
            ("start.pose=reference", ["needs a [reference]"]),
            ("body.name=du-2005", ["name or file"]),
            ("body.measures={left_thigh=-1}", ["body.measures", "> 0"]),
            ("likelihood={silhouette=0, edges=0}", ["at least one weight"]),
            ("likelihood.reduction=0", ["reduction", ">= 1"]),
            ("camera.right.background.file=3", ["expected a path", "3"]),
        ],
    )
    def test_one_line_says_where_what_and_what_instead(self, path: Path, override: str, words: list[str]) -> None:
        with pytest.raises(InputError) as error:
            job.read(path, [override])
        for word in ["job.toml", *words]:
            assert word in line_of(error)

    def test_missing_file(self, tmp_path: Path) -> None:
        with pytest.raises(InputError, match=r"none\.toml: expected a job file, got No such file"):
            job.read(tmp_path / "none.toml")

    @pytest.mark.parametrize("content", [b"name = \n", b"\xff\xfe\x00"])
    def test_not_toml(self, tmp_path: Path, content: bytes) -> None:
        (tmp_path / "bad.toml").write_bytes(content)
        with pytest.raises(InputError, match=r"bad\.toml: expected a job in TOML"):
            job.read(tmp_path / "bad.toml")

    def test_empty_file_names_what_is_missing(self, tmp_path: Path) -> None:
        (tmp_path / "empty.toml").write_text("")
        with pytest.raises(InputError, match="calibration"):
            job.read(tmp_path / "empty.toml")


@dataclass(frozen=True)
class Config:
    particles: int = 500
    survival: float = 0.1


PRINTED, WORKING = Config(survival=0.5), Config(particles=300)


class TestSettings:
    @pytest.fixture(autouse=True)
    def one_method(self, monkeypatch: pytest.MonkeyPatch) -> None:
        from muybridge import filters

        monkeypatch.setattr(
            filters, "METHODS", {"annealed": SimpleNamespace(PRINTED=PRINTED, WORKING=WORKING)}, raising=False
        )

    def test_the_jobs_settings_replace_the_presets(self, path: Path) -> None:
        assert job.filter_config(job.read(path)) == Config(particles=200)
        assert job.filter_config(job.read(path, ["filter.preset=printed"])) == Config(particles=200, survival=0.5)
        assert job.filter_config(job.read(path, ["filter={name='annealed'}"])) == WORKING

    @pytest.mark.parametrize(
        ("override", "words"),
        [
            ("filter.name=anealed", ["anealed", "did you mean annealed?"]),
            ("filter.particle=3", ["filter annealed", "particle", "did you mean particles?"]),
            ("filter.particles=many", ["particles", "expected int", "got str"]),
            ("camera.right.background.kind=plait", ["camera right", "did you mean plate?"]),
            ("camera.right.background.treshold=3", ["treshold", "did you mean threshold?"]),
            ("camera.left.background.kind=gaussian", ["camera left", "the empty scene", "empty = [first, last]"]),
        ],
    )
    def test_errors(self, path: Path, override: str, words: list[str]) -> None:
        with pytest.raises(InputError) as error:
            job.check_settings(job.read(path, [override]))
        assert all(word in line_of(error) for word in words)


class TestWrite:
    def test_round_trip(self, path: Path) -> None:
        written = path.with_name("copy.toml")
        job.write(written, job.read(path))
        assert job.read(written) == job.read(path)

    def test_a_folder_can_be_moved_as_a_whole(self, path: Path) -> None:
        text = job.dumps(job.read(path), path.parent)
        assert str(path.parent) not in text and "/elsewhere/right.mp4" in text

    def test_a_job_written_elsewhere_still_finds_its_files(self, path: Path, tmp_path: Path) -> None:
        (tmp_path / "other").mkdir()
        job.write(tmp_path / "other/job.toml", job.read(path))
        assert job.read(tmp_path / "other/job.toml") == job.read(path)

    def test_measures_from_a_file(self, path: Path) -> None:
        read = job.read(path, ["body.measures=lengths.toml"])
        assert read.body.measures == str(path.parent / "lengths.toml")
        assert 'measures = "lengths.toml"' in job.dumps(read, path.parent)


scalars = st.one_of(st.booleans(), st.integers(-(2**62), 2**62), st.floats(allow_nan=False), st.text())
tables = st.recursive(
    st.dictionaries(st.text(), scalars, max_size=3),
    lambda inner: st.dictionaries(st.text(), st.one_of(scalars, inner, st.lists(inner, min_size=1, max_size=2))),
    max_leaves=8,
)


@given(tables)
def test_toml_written_is_toml_read(table: dict) -> None:
    import tomllib

    assert tomllib.loads(_toml.dumps(table)) == table
