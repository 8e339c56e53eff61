"""Clips of a hall under one fixed camera, rendered once and kept on disk while trials look at them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from muybridge.experiments.experiment import Amount
from muybridge.experiments.trial import EVIDENCE
from muybridge.experiments.zhao_2009.conditions import digest_of
from muybridge.io.disk import disk_errors, make_folder, replace_file

VERSION = 1  # raise it when a clip of the same description looks otherwise
HAPPENS: dict[str, tuple[str, ...]] = {"calm": (), "lamp": ("lamp",), "door": ("door",), "linger": ("linger",)}
"""What happens: nothing; the light goes off, and on again; a door opens; somebody stands for half of the clip."""
FIRST_SEED = 40
"""Clips have seeds from here on; settings were chosen on those from 901 on."""


@dataclass(frozen=True)
class HallClip:
    """A clip of people who come and go; `empty` pictures of the hall come first."""

    scene: str
    seed: int
    seconds: float
    rate: float
    size: tuple[int, int] = (320, 240)
    people: int = 3
    empty: int = 60

    @property
    def digest(self) -> str:
        """The name of its files."""
        return digest_of({"version": VERSION, **asdict(self)})

    def prepare(self, folder: Path, trials: Sequence[Any]) -> None:
        """Render it, unless it is there."""
        pictures, masks = self._files(folder)
        if pictures.is_file() and masks.is_file():
            return
        shown, true = self._rendered()
        make_folder(pictures.parent)
        for path, array in ((pictures, shown), (masks, true)):
            replace_file(path, _as_npy(array))

    def drop(self, folder: Path) -> None:
        """Delete the pictures, which are large."""
        self._files(folder)[0].unlink(missing_ok=True)

    def load(self, folder: Path) -> tuple[NDArray, NDArray]:
        """Pictures (E + T, H, W, 3) uint8 BGR, of which the first E are empty; true masks (T, H, W) bool."""
        return _loaded(*self._files(folder))

    def _files(self, folder: Path) -> tuple[Path, Path]:
        return folder / EVIDENCE / f"{self.digest}-pictures.npy", folder / EVIDENCE / f"{self.digest}-masks.npy"

    def _rendered(self) -> tuple[NDArray, NDArray]:
        from muybridge.synthetic.crowd import shoot_people
        from muybridge.synthetic.scene import empty
        from muybridge.synthetic.surveillance import surveillance_scene

        made = surveillance_scene(seed=self.seed, duration=self.seconds, rate=self.rate, people=self.people,
                                  size=self.size, events=HAPPENS[self.scene])  # fmt: skip
        shots = [shoot_people(made, frame) for frame in range(made.frame_count)]
        before = [views[0] for views in empty(made, self.empty)][::-1]  # they come latest first
        return np.stack([*before, *(shot.image for shot in shots)]), np.stack([shot.mask for shot in shots])


def clips(scale: Amount) -> tuple[HallClip, ...]:
    """Every happening for every seed: 16 s at 10 Hz of 160 x 120 for a quick look, else 40 at 15 of 320 x 240."""
    seconds, rate, size = (16.0, 10.0, (160, 120)) if scale.quick else (40.0, 15.0, (320, 240))
    numbers = range(FIRST_SEED, FIRST_SEED + scale.seeds)
    return tuple(HallClip(scene, seed, seconds, rate, size) for seed in numbers for scene in HAPPENS)


@lru_cache(maxsize=1)
def _loaded(pictures: Path, masks: Path) -> tuple[NDArray, NDArray]:
    with disk_errors(pictures):
        return np.load(pictures, mmap_mode="r"), np.load(masks)


def _as_npy(array: NDArray) -> bytes:
    import io

    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()
