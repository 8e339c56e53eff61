"""What is kept of an experiment, and whose folder it is."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from experiments.made_results import result
from muybridge.errors import InputError
from muybridge.experiments.store import CONFIGURATION_FILE, ROWS_FILE, Store, claim
from muybridge.experiments.trial import Trial

FIRST, SECOND = Trial(seed=1), Trial(seed=2)
OURS = {"experiment": "du-2005", "quick": True}


class TestStore:
    def test_results_come_back(self, tmp_path: Path) -> None:
        given = result(31.5, inside=(float("nan"), 0.8, 1.0))
        with Store(tmp_path) as store:
            store.append(FIRST, given)
        with Store(tmp_path) as store:
            assert FIRST in store and SECOND not in store
            found = store[FIRST]
        assert found.frame_mm == given.frame_mm and found.status == "tracked"
        np.testing.assert_array_equal(found.inside, given.inside)

    @pytest.mark.parametrize("kept", [1, 40, -1])
    def test_a_torn_last_line_is_dropped_and_written_over(self, tmp_path: Path, kept: int) -> None:
        with Store(tmp_path) as store:
            store.append(FIRST, result(1.0))
            whole = (tmp_path / ROWS_FILE).stat().st_size
            store.append(SECOND, result(2.0))
        data = (tmp_path / ROWS_FILE).read_bytes()
        (tmp_path / ROWS_FILE).write_bytes(data[: whole + kept] if kept > 0 else data[:kept])
        with Store(tmp_path) as store:
            assert FIRST in store and SECOND not in store
            store.append(SECOND, result(3.0))
        lines = (tmp_path / ROWS_FILE).read_text().splitlines()
        assert [json.loads(line)["digest"] for line in lines] == [FIRST.digest, SECOND.digest]

    def test_lines_of_another_version_are_left_alone(self, tmp_path: Path) -> None:
        (tmp_path / ROWS_FILE).write_text(json.dumps({"digest": FIRST.digest, "result": {"old": 1}}) + "\n")
        with Store(tmp_path) as store:
            assert FIRST not in store
            store.append(FIRST, result())
        with Store(tmp_path) as store:
            assert FIRST in store
        assert (tmp_path / ROWS_FILE).read_text().count('"old"') == 1

    def test_a_line_says_what_was_run(self, tmp_path: Path) -> None:
        with Store(tmp_path) as store:
            store.append(FIRST, result())
        entry = json.loads((tmp_path / ROWS_FILE).read_text())
        assert entry["trial"]["filter"]["particles"] == FIRST.filter_config.particles


class TestClaim:
    def test_a_new_folder(self, tmp_path: Path) -> None:
        claim(tmp_path / "new", OURS, resume=False)
        assert json.loads((tmp_path / "new" / CONFIGURATION_FILE).read_text()) == OURS

    def test_resume_of_nothing_begins(self, tmp_path: Path) -> None:
        assert claim(tmp_path / "new", OURS, resume=True).is_dir()

    def test_results_are_not_written_over(self, tmp_path: Path) -> None:
        claim(tmp_path, OURS, resume=False)
        with pytest.raises(InputError, match="--resume"):
            claim(tmp_path, OURS, resume=False)
        claim(tmp_path, OURS, resume=True)

    def test_another_configuration(self, tmp_path: Path) -> None:
        claim(tmp_path, OURS, resume=False)
        with pytest.raises(InputError, match="quick=False, got results of .*quick=True"):
            claim(tmp_path, {**OURS, "quick": False}, resume=True)

    def test_a_folder_of_something_else(self, tmp_path: Path) -> None:
        (tmp_path / "holiday.jpg").touch()
        with pytest.raises(InputError, match="other files"):
            claim(tmp_path, OURS, resume=True)
        assert not (tmp_path / CONFIGURATION_FILE).exists()

    def test_a_file(self, tmp_path: Path) -> None:
        (tmp_path / "file").touch()
        with pytest.raises(InputError, match="a folder, got a file"):
            claim(tmp_path / "file", OURS, resume=False)

    def test_broken(self, tmp_path: Path) -> None:
        (tmp_path / CONFIGURATION_FILE).write_text("{")
        with pytest.raises(InputError, match="JSON"):
            claim(tmp_path, OURS, resume=True)
