"""The background models that a job's cameras get."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from muybridge.io.job import BackgroundInput, CameraInput
from muybridge.segmentation import Segmenter, ShadowConfig
from muybridge.tracking.evidence import build_segmenter

GREY, COLOUR = "grey_%02d.png", "colour_%02d.png"


def segmenter_of(folder: Path, empty: str | None, kind: str = "plate", shadows: bool | None = None) -> Segmenter:
    """What a camera gets with such pictures of the empty scene."""
    file = None if empty is None else folder / empty
    return build_segmenter(CameraInput("c", folder / COLOUR, background=BackgroundInput(kind, file, None, shadows)), 2)


class TestShadows:
    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        """The empty scene in colour, and in grey, which is read as three equal channels."""
        for frame, picture in enumerate(np.random.default_rng(0).integers(0, 256, (5, 24, 32, 3), dtype=np.uint8)):
            cv2.imwrite(str(tmp_path / (COLOUR % frame)), picture)
            cv2.imwrite(str(tmp_path / (GREY % frame)), picture[..., 0])
        return tmp_path

    @pytest.mark.parametrize("kind", ["plate", "gaussian"])
    def test_go_where_there_is_colour(self, folder: Path, kind: str) -> None:
        assert segmenter_of(folder, COLOUR, kind).shadows == ShadowConfig()
        assert segmenter_of(folder, GREY, kind).shadows is None

    def test_stay_where_nothing_says_what_was_there_before(self, folder: Path) -> None:
        assert segmenter_of(folder, None, "hue_key").shadows is None

    def test_as_the_job_says(self, folder: Path) -> None:
        assert segmenter_of(folder, COLOUR, shadows=False).shadows is None
        assert segmenter_of(folder, GREY, shadows=True).shadows == ShadowConfig()
