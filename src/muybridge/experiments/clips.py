"""A clip's evidence: rendered, segmented by the product's own background model, reduced, and kept on disk.

Thousands of trials share a few dozen clips, so pictures are rendered and segmented once and no video is decoded. What a
job does otherwise: its videos are compressed, and its masks are cleaned around where the tracker expects the person;
here around where the person is.

A clip is two files in the evidence folder: DIGEST.npz (masks, true joints) and DIGEST-pictures.npz (reduced pictures,
which are large, made only for trials whose cues look at them).
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from muybridge.body import named_body
from muybridge.cameras.model import Rig
from muybridge.evaluation.names import JOINTS
from muybridge.experiments.scenes import scene_of
from muybridge.experiments.trial import Clip
from muybridge.io.disk import disk_errors, make_folder, temporary_name
from muybridge.io.run_folder import JointSeries
from muybridge.segmentation import Segmenter, build_segmenter, reduce_image
from muybridge.synthetic.scene import Scene, empty, render, truth
from muybridge.synthetic.write import stature
from muybridge.tracking.evidence import Eye
from muybridge.tracking.prepare import reductions_for

EMPTY_SECONDS = 1.0  # of the empty room, as `synthetic.write` has it


@dataclass(frozen=True, eq=False)
class Evidence:
    """What a tracker sees of a clip, and the truth it is held against.

    Attributes
    ----------
    clip : Clip
    rig : Rig
        As recorded.
    reductions : (C,) int
    own, true : C times (T, H', W') bool
        Masks by background subtraction and of the renderer, reduced.
    joints : (T, 15, 3) float64, metres, world
    stature : float, metres
        With shoes and hair: what a user would measure.
    pictures : C times (T, H', W', 3) uint8 BGR, reduced; empty where they were not asked for
    """

    clip: Clip
    rig: Rig
    reductions: tuple[int, ...]
    own: tuple[np.ndarray, ...]
    true: tuple[np.ndarray, ...]
    joints: np.ndarray
    stature: float
    pictures: tuple[np.ndarray, ...] = ()

    @property
    def interval(self) -> float:
        """Seconds between frames."""
        return 1.0 / self.clip.rate

    @property
    def truth(self) -> JointSeries:
        """The true joints, with deviations of 0."""
        count = len(self.joints)
        frames = np.arange(count)
        return JointSeries(JOINTS, frames, frames / self.clip.rate, self.joints, np.zeros((count, len(JOINTS))))


def evidence_of(clip: Clip, folder: Path, *, pictures: bool = False) -> Evidence:
    """The clip's evidence from `folder`, made and kept there where it is not yet."""
    masks_file, pictures_file = _files(clip, folder)
    if not masks_file.is_file() or (pictures and not pictures_file.is_file()):
        _make(clip, folder, pictures)
    scene = scene_of(clip)
    with disk_errors(masks_file), np.load(masks_file) as stored:
        own, true = ([_unpacked(stored, f"{kind}_{c}") for c in range(len(scene.rig))] for kind in ("own", "true"))
        joints, reductions = stored["joints"], tuple(map(int, stored["reductions"]))
        height = float(stored["stature"])
    shown: tuple[np.ndarray, ...] = ()
    if pictures:
        with disk_errors(pictures_file), np.load(pictures_file) as stored:
            shown = tuple(stored[f"pictures_{c}"] for c in range(len(scene.rig)))
    return Evidence(clip, scene.rig, reductions, tuple(own), tuple(true), joints, height, shown)


def drop_pictures(clip: Clip, folder: Path) -> None:
    """Delete the clip's pictures, which are large; they can be made again."""
    _files(clip, folder)[1].unlink(missing_ok=True)


def _files(clip: Clip, folder: Path) -> tuple[Path, Path]:
    return folder / f"{clip.digest}.npz", folder / f"{clip.digest}-pictures.npz"


def _make(clip: Clip, folder: Path, with_pictures: bool) -> None:
    """Render and segment the clip, and write it."""
    scene = scene_of(clip)
    reductions = clip_reductions(clip, scene)
    eyes = _eyes(scene, reductions)
    joints = truth(scene).joints
    views = range(len(scene.rig))
    own: list[list[np.ndarray]] = [[] for _ in views]
    true: list[list[np.ndarray]] = [[] for _ in views]
    shown: list[list[np.ndarray]] = [[] for _ in views]
    for frame in range(scene.frame_count):
        images, masks = render(scene, frame)
        for c in views:
            own[c].append(eyes[c].mask(images[c], joints[frame]))
            true[c].append(_shrunk(masks[c], reductions[c]))
            if with_pictures:
                shown[c].append(reduce_image(images[c], 1.0 / reductions[c]))
    arrays: dict[str, np.ndarray] = {"joints": joints, "reductions": np.array(reductions), "stature": np.array(0.0)}
    arrays["stature"] = np.array(stature(scene))
    for kind, masks_by_view in (("own", own), ("true", true)):
        for c in views:
            arrays |= _packed(f"{kind}_{c}", np.array(masks_by_view[c]))
    masks_file, pictures_file = _files(clip, folder)
    _save(masks_file, arrays)
    if with_pictures:
        _save(pictures_file, {f"pictures_{c}": np.array(shown[c]) for c in views})


def clip_reductions(clip: Clip, scene: Scene) -> tuple[int, ...]:
    """How much each camera's pictures are reduced: as the clip says, else as the tracker would."""
    if clip.reduction is not None:
        return (clip.reduction,) * len(scene.rig)
    return reductions_for(scene.rig, named_body("person").with_height(stature(scene)))


def _eyes(scene: Scene, reductions: tuple[int, ...]) -> list[Eye]:
    """The product's way from picture to mask, trained on the empty room as a job would be."""
    rooms = list(empty(scene, max(1, round(EMPTY_SECONDS * scene.person.motion.rate))))
    eyes = []
    for c, (camera, reduction) in enumerate(zip(scene.rig, reductions, strict=True)):
        segmenter: Segmenter = build_segmenter("plate", [room[c] for room in rooms], factor=1.0 / reduction)
        eyes.append(Eye(camera, reduction, segmenter))
    return eyes


def _shrunk(mask: np.ndarray, reduction: int) -> np.ndarray:
    """(H, W) bool -> (H', W') bool: more than half of the block; what is left over is cut off."""
    if reduction == 1:
        return mask
    height, width = (side // reduction for side in mask.shape)
    blocks = mask[: height * reduction, : width * reduction].reshape(height, reduction, width, reduction)
    return blocks.mean(axis=(1, 3)) > 0.5


def _packed(name: str, masks: np.ndarray) -> dict[str, np.ndarray]:
    return {name: np.packbits(masks, axis=2), f"{name}_width": np.array(masks.shape[2])}


def _unpacked(stored: np.lib.npyio.NpzFile, name: str) -> np.ndarray:
    return np.unpackbits(stored[name], axis=2, count=int(stored[f"{name}_width"])).view(bool)


def _save(path: Path, arrays: dict[str, np.ndarray]) -> None:
    """Write the whole file or none."""
    make_folder(path.parent)
    unfinished = temporary_name(path)
    save: Callable[..., None] = np.savez_compressed if "-pictures" not in path.stem else np.savez
    try:
        with disk_errors(path):
            save(unfinished, **arrays)
            os.replace(unfinished, path)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise
