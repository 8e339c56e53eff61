"""Evidence: what is on disk is what was made, and the masks are of the person."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from muybridge.experiments import clips
from muybridge.experiments.clips import Evidence, drop_pictures, evidence_of
from muybridge.experiments.scenes import known_figures, known_motions, scene_of
from muybridge.experiments.trial import Clip
from muybridge.segmentation import mask_scores

CLIP = Clip(frames=2, reduction=2, seed=1)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("evidence")


@pytest.fixture(scope="module")
def evidence(folder: Path) -> Evidence:
    return evidence_of(CLIP, folder, pictures=True)


def test_shapes(evidence: Evidence) -> None:
    assert len(evidence.own) == len(evidence.true) == len(evidence.pictures) == len(evidence.rig) == 3
    assert evidence.own[0].shape == evidence.true[0].shape == (2, 240, 320) and evidence.own[0].dtype == bool
    assert evidence.pictures[0].shape == (2, 240, 320, 3)
    assert evidence.joints.shape == (2, 15, 3) and 1.4 < evidence.stature < 2.1
    assert evidence.truth.times[1] == pytest.approx(1 / 30)


def test_own_masks_are_nearly_the_true_ones(evidence: Evidence) -> None:
    """Background subtraction of an ordinary room: an IoU of .9 is usual; a mask of another frame's camera has none."""
    for own, true in zip(evidence.own, evidence.true, strict=True):
        assert mask_scores(own[0], true[0])["iou"] > 0.75


def test_joints_lie_on_the_true_mask(evidence: Evidence) -> None:
    """Hips, knees and the trunk are inside the person: their pixels are foreground in every camera."""
    inside = [evidence.truth.names.index(name) for name in ("pelvis", "thorax", "left_hip", "right_knee")]
    for camera, mask in zip(evidence.rig, evidence.true, strict=True):
        x, y = np.round((camera.world_to_pixel(evidence.joints[0, inside]) + 0.5) / 2 - 0.5).astype(int).T
        assert mask[0][y, x].all()


def test_it_is_read_back_and_not_made_again(folder: Path, evidence: Evidence, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clips, "_make", lambda *arguments: pytest.fail("made again"))
    again = evidence_of(CLIP, folder)
    assert again.pictures == ()
    for kind in ("own", "true"):
        for before, after in zip(getattr(evidence, kind), getattr(again, kind), strict=True):
            np.testing.assert_array_equal(before, after)
    np.testing.assert_array_equal(evidence.joints, again.joints)


def test_pictures_can_be_dropped(tmp_path: Path) -> None:
    clip = Clip(frames=2, reduction=8, view="side", cameras=1)
    evidence_of(clip, tmp_path, pictures=True)
    drop_pictures(clip, tmp_path)
    drop_pictures(clip, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == [f"{clip.digest}.npz"]


def test_the_seed_decides_the_scene() -> None:
    assert scene_of(Clip(seed=1)) == scene_of(Clip(seed=1)) != scene_of(Clip(seed=2))


def test_a_side_view_looks_across_the_path() -> None:
    scene = scene_of(Clip(view="side", cameras=1, seed=3))
    ahead = np.array([np.cos(scene.person.motion.heading), np.sin(scene.person.motion.heading), 0.0])
    assert len(scene.rig) == 1 and abs(scene.rig[0].rotation[2] @ ahead) < np.sin(np.radians(15))


def test_walking_comes_first() -> None:
    assert known_motions()[0] == "walk" and known_figures()[0] == "man" and len(known_motions()) >= 3
