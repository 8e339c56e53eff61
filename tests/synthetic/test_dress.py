"""Loose clothes: bounded, never inside the skin, late, and tight where nothing is asked."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.synthetic.dress import FOLDS, hang
from muybridge.synthetic.motion import Motion, perform
from muybridge.synthetic.posture import posture_at
from muybridge.synthetic.skinning import load_figure

FIGURE = load_figure("man", cut="long_sleeves")
TRACK = perform(FIGURE, Motion("walk", 1.5))
LOOSE = 0.03
FRAME = 20


def at(frame: int) -> tuple[np.ndarray, np.ndarray]:
    return TRACK.rotations[frame], TRACK.places[frame]


class TestHang:
    def cloth(self, rng, late: float):
        skin = rng.normal(size=(500, 3))
        normals = rng.normal(size=(500, 3))
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        loose = rng.uniform(0, 0.05, 500)
        before = skin + late * rng.normal(size=(500, 3))
        return skin, normals, loose, hang(skin, normals, before, loose, rng.uniform(-1, 1, 500))

    @pytest.mark.parametrize("late", [0.0, 0.01, 1.0])
    def test_never_inside_the_skin_and_never_far(self, late):
        skin, normals, loose, cloth = self.cloth(np.random.default_rng(2), late)
        assert (np.einsum("vi,vi->v", cloth - skin, normals) >= -1e-12).all()
        # (1 + k) L outward and less than (1 - k) L towards where the skin was
        assert (np.linalg.norm(cloth - skin, axis=1) <= 2 * loose + 1e-12).all()

    def test_hangs_straight_out_at_rest(self):
        skin, normals, loose, cloth = self.cloth(np.random.default_rng(3), 0.0)
        out = np.einsum("vi,vi->v", cloth - skin, normals)
        np.testing.assert_allclose(cloth - skin, out[:, None] * normals, atol=1e-12)
        assert ((1 - FOLDS) * loose - 1e-12 <= out).all() and (out <= (1 + FOLDS) * loose + 1e-12).all()


class TestMesh:
    def test_tight_is_the_skin(self):
        mesh = FIGURE.mesh(*at(FRAME), earlier=at(FRAME - 3), looseness=0.0)
        assert np.array_equal(mesh.vertices, FIGURE.skin(*at(FRAME)))

    def test_collar_waistband_hands_and_head_stay(self):
        moved = np.linalg.norm(self.loose().vertices - FIGURE.skin(*at(FRAME)), axis=1)
        names = np.array(FIGURE.label_names)[FIGURE.labels]
        assert moved[np.isin(names, ["skin", "hair", "shoes", "eyes"])].max() == 0
        assert moved[names == "shirt"].max() > 0.02 and moved[names == "trousers"].max() > 0.02

    def loose(self, frame: int = FRAME, lag: float = 3.0):
        return FIGURE.mesh(*at(frame), earlier=posture_at(TRACK, frame - lag), looseness=LOOSE)

    def test_moves_late(self):
        """Against cloth that stands still: shifted towards where the skin was, everywhere, never the other way."""
        skin = FIGURE.skin(*at(FRAME))
        world, places = at(FRAME - 3)
        was = FIGURE.skin(world, places - places[0] + TRACK.places[FRAME, 0]) - skin
        shift = self.loose().vertices - FIGURE.mesh(*at(FRAME), looseness=LOOSE).vertices
        along = np.einsum("vi,vi->v", shift, was)
        assert along.min() >= -1e-15
        wrist = (FIGURE.looseness > 0.9) & (FIGURE.labels == FIGURE.label_names.index("shirt"))
        assert np.linalg.norm(shift[wrist], axis=1).max() > 0.3 * LOOSE
        # control: cloth that led would be shifted against it
        assert np.einsum("vi,vi->v", -shift, was).min() < -1e-5

    def test_walking_on_drags_nothing(self):
        world, places = at(FRAME)
        carried = FIGURE.mesh(world, places, earlier=(world, places - (0.2, 0.1, 0.0)), looseness=LOOSE)
        still = FIGURE.mesh(world, places, looseness=LOOSE)
        np.testing.assert_allclose(carried.vertices, still.vertices, atol=1e-12)

    def test_normals_are_the_cloths(self):
        mesh = self.loose()
        np.testing.assert_allclose(mesh.normals, FIGURE.normals(mesh.vertices), atol=1e-12)
