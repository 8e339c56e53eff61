"""Mixtures and pairs of pixels against their meaning, pixel by pixel."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge._kernels.mixture import mixture_densities, mixture_scores, mixture_update
from muybridge._kernels.pairs import (
    NONE,
    SEVERAL,
    choose_partners,
    pair_scores,
    pair_update,
    pooled_scores,
    slot_deviations,
)
from muybridge.segmentation.spatial import OFFSETS
from reference import mixture as literal

H, W, K, C = 9, 11, 6, 3
SETTINGS = {"limit": 2.5**2 * C, "rate": 0.05, "floor": 4.0, "wide": 225.0, "portion": 0.9}
SINGLE = 2e-4  # relative: some twenty roundings of float32 (6e-8 each) under an exponential of at most a hundred


class Mixtures:
    """Learnt by the kernel and by the reference from the same colours: three looks, noise, now and then anything."""

    def __init__(self, pictures: int = 60) -> None:
        rng = np.random.default_rng(3)
        self.looks = rng.integers(20, 230, (3, H, W, C))
        self.weights, self.kept = np.zeros((H, W, K), np.float32), np.zeros((H, W), np.uint8)
        self.means, self.variances = np.zeros((H, W, K, C), np.float32), np.ones((H, W, K, C), np.float32)
        self.known = np.zeros((H, W), bool)
        self.true = [array.astype(float) for array in (self.weights, self.means, self.variances)]
        self.pairs: list[tuple[np.ndarray, np.ndarray]] = []
        for _ in range(pictures):
            self.image = self.picture(rng)
            self.learn(self.image)

    def picture(self, rng: np.random.Generator) -> np.ndarray:
        colours = self.looks[rng.integers(3)] + rng.normal(0, 3, (H, W, C))
        odd = rng.uniform(size=(H, W)) < 0.05
        colours[odd] = rng.integers(0, 256, (odd.sum(), C))
        return np.clip(np.rint(colours), 0, 255).astype(np.uint8)

    def learn(self, image: np.ndarray) -> None:
        matched, fresh = np.zeros((H, W), np.int8), np.zeros((H, W), np.int8)
        mixture_update(image, np.ones((H, W), bool), self.weights, self.means, self.variances, self.kept,
                       **SETTINGS, matched=matched, fresh=fresh, background=self.known)  # fmt: skip
        self.pairs.append((matched, fresh))
        weights, means, variances = self.true
        for y, x in np.ndindex(H, W):
            found = literal.learn(image[y, x].astype(float), weights[y, x], means[y, x], variances[y, x],
                                  SETTINGS["limit"], SETTINGS["rate"], SETTINGS["floor"], SETTINGS["wide"])  # fmt: skip
            assert found == (matched[y, x], fresh[y, x])


MADE = Mixtures()
FEW = 6
PICTURES = [60, FEW]
"""Of which pairs learn: after few, most have shown one combination, or none."""


def test_learning_is_that_of_the_reference() -> None:
    for kernel, true in zip((MADE.weights, MADE.means, MADE.variances), MADE.true, strict=True):
        used = np.broadcast_to((MADE.true[0] > 0).reshape((H, W, K) + (1,) * (true.ndim - 3)), true.shape)
        np.testing.assert_allclose(kernel[used], true[used], rtol=SINGLE)
    np.testing.assert_allclose(MADE.weights.sum(axis=2), 1.0, rtol=1e-5)


def test_background_components() -> None:
    for y, x in np.ndindex(H, W):
        wanted = literal.background_slots(MADE.true[0][y, x], MADE.true[2][y, x], SETTINGS["portion"])
        assert {k for k in range(K) if MADE.kept[y, x] >> k & 1} == wanted


def test_densities_and_scores() -> None:
    found, scores = np.empty((H, W, K), np.float32), np.empty((H, W), np.float32)
    arrays = MADE.weights, MADE.means, MADE.variances, MADE.kept
    mixture_densities(MADE.image, *arrays[1:], found)
    mixture_scores(MADE.image, *arrays, scores)
    for y, x in np.ndindex(H, W):
        kept = np.array([MADE.kept[y, x] >> k & 1 for k in range(K)])
        wanted = kept * literal.densities(MADE.image[y, x].astype(float), MADE.means[y, x], MADE.variances[y, x])
        np.testing.assert_allclose(found[y, x], wanted, rtol=SINGLE)
        np.testing.assert_allclose(scores[y, x], -np.log(max(MADE.weights[y, x] @ wanted, literal.LEAST)), atol=1e-3)


def learnt_pairs(growth_rate: float, pictures: int | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    counts, totals = np.zeros((len(OFFSETS), H, W, K, K), np.float32), np.zeros((len(OFFSETS), H, W), np.float32)
    only = np.full(totals.shape, NONE, np.int8)
    for matched, fresh in MADE.pairs[:pictures]:
        pair_update(counts, totals, only, OFFSETS, matched, fresh, growth_rate)
    return counts, totals, only


def test_counts_are_of_components_that_matched_together_since_they_were_made() -> None:
    """With a rate so small that each picture counts one."""
    counts, totals, only = learnt_pairs(1e-9)
    (d, (down, right)), (y, x) = next(iter(enumerate(OFFSETS))), (2, 3)
    wanted = np.zeros((K, K))
    for matched, fresh in MADE.pairs:
        if fresh[y, x] >= 0:
            wanted[fresh[y, x]] = 0
        if fresh[y + down, x + right] >= 0:
            wanted[:, fresh[y + down, x + right]] = 0
        if matched[y, x] >= 0 and matched[y + down, x + right] >= 0:
            wanted[matched[y, x], matched[y + down, x + right]] += 1
    np.testing.assert_array_equal(counts[d, y, x], wanted)
    assert totals[d, y, x] == wanted.sum() > 10


@pytest.mark.parametrize("pictures", PICTURES)
def test_scores_and_partners(pictures: int) -> None:
    """(3.1): the pixel's own density and those with its two most informative partners, where something is known."""
    counts, totals, only = learnt_pairs(0.02, pictures)
    information, partners = np.zeros((len(OFFSETS), H, W), np.float32), np.zeros((H, W, 2), np.int8)
    choose_partners(counts, only, OFFSETS, 0, 1, information, partners)
    found, out = np.empty((H, W, K), np.float32), np.empty((H, W), np.float32)
    mixture_densities(MADE.image, MADE.means, MADE.variances, MADE.kept, found)
    pair_scores(MADE.weights, found, counts, totals, only, OFFSETS, partners, 4.0, out)
    for y, x in np.ndindex(H, W):
        candidates = {}
        for d, (down, right) in enumerate(OFFSETS):
            for side, sign in enumerate((1, -1)):
                qy, qx = y + sign * down, x + sign * right
                if 0 <= qy < H and 0 <= qx < W:
                    matrix = counts[d, y, x] if side == 0 else counts[d, qy, qx].T
                    candidates[2 * d + side] = matrix.astype(float), found[qy, qx].astype(float)
        gain = {n: literal.mutual_information(matrix) if matrix.any() else 0.0 for n, (matrix, _) in candidates.items()}
        chosen = [int(n) for n in partners[y, x] if n >= 0]
        assert len(chosen) == min(2, len(candidates))
        for rank, n in enumerate(sorted(gain.values(), reverse=True)[: len(chosen)]):
            np.testing.assert_allclose(gain[chosen[rank]], n, atol=1e-5)
        own = found[y, x].astype(float)
        wanted = -np.log(max(MADE.weights[y, x] @ own, literal.LEAST))
        known = [n for n in chosen if candidates[n][0].any()]
        wanted += sum(literal.joint(candidates[n][0], own, candidates[n][1], 4.0) for n in known)
        np.testing.assert_allclose(out[y, x], wanted, rtol=1e-4, atol=1e-3)


@pytest.mark.parametrize("pictures", PICTURES)
def test_pairs_of_which_one_combination_was_seen_are_known(pictures: int) -> None:
    """After forgetting, SEVERAL may stand where one is left."""
    counts, _, only = learnt_pairs(0.02, pictures)
    seen = (counts > 0).reshape(*only.shape, K * K)
    np.testing.assert_array_equal(only == NONE, seen.sum(axis=-1) == 0)
    single = only >= 0
    assert (seen[single].sum(axis=-1) == 1).all() and (seen[single].argmax(axis=-1) == only[single]).all()
    assert (only[seen.sum(axis=-1) > 1] == SEVERAL).all()
    assert single.any() == (pictures == FEW)


def test_one_combination_is_counted_until_its_share_cannot_change() -> None:
    """With a rate of 1 / 11 the newest picture's share is one in all until 10 were seen."""
    counts, totals = np.zeros((1, 6, 1, K, K), np.float32), np.zeros((1, 6, 1), np.float32)
    only, offset = np.full(totals.shape, NONE, np.int8), np.array([(5, 0)])
    matched, fresh = np.full((6, 1), 2, np.int8), np.full((6, 1), -1, np.int8)
    for _ in range(30):
        pair_update(counts, totals, only, offset, matched, fresh, 1 / 11)
    assert only[0, 0, 0] == 2 * K + 2 and totals[0, 0, 0] == counts[0, 0, 0, 2, 2]
    np.testing.assert_allclose(totals[0, 0, 0], 10, rtol=0.11)
    matched[5] = 3
    pair_update(counts, totals, only, offset, matched, fresh, 1 / 11)
    assert only[0, 0, 0] == SEVERAL
    np.testing.assert_allclose(counts[0, 0, 0, 2, 3] / totals[0, 0, 0], 1 / 11, rtol=0.01)


@pytest.mark.parametrize("pictures", PICTURES)
def test_deviations_and_pooled_scores(pictures: int) -> None:
    """The nearest component, where those that do not go with what the partners show lie further."""
    floor, match, limit = 16.0, 9.0, 3.0
    counts, totals, only = learnt_pairs(0.02, pictures)
    information, partners = np.zeros((len(OFFSETS), H, W), np.float32), np.zeros((H, W, 2), np.int8)
    choose_partners(counts, only, OFFSETS, 0, 1, information, partners)
    found, out = np.empty((H, W, K), np.float32), np.empty((H, W), np.float32)
    slot_deviations(MADE.image, MADE.weights, MADE.means, MADE.variances, MADE.kept, floor, found)
    pooled_scores(found, MADE.kept, counts, totals, only, OFFSETS, partners, match, limit, out)
    raised = 0
    for y, x in np.ndindex(H, W):
        kept = {k for k in range(K) if MADE.kept[y, x] >> k & 1}
        own = literal.deviations(MADE.image[y, x].astype(float), MADE.weights[y, x], MADE.means[y, x],
                                 MADE.variances[y, x], kept, floor)  # fmt: skip
        np.testing.assert_allclose(found[y, x], own, rtol=SINGLE)
        cost = own.copy()
        for n in partners[y, x][partners[y, x] >= 0] if len(kept) > 1 else ():
            (down, right), sign = OFFSETS[n >> 1], 1 - 2 * (n & 1)
            qy, qx = y + sign * down, x + sign * right
            matrix = counts[n >> 1, y, x] if sign > 0 else counts[n >> 1, qy, qx].T
            shown = int(found[qy, qx].argmin())
            if found[qy, qx, shown] <= match:
                cost += [2 * literal.surprise(matrix.astype(float), k, shown, limit) for k in range(K)]
        np.testing.assert_allclose(out[y, x], np.sqrt(cost.min()), rtol=1e-3)
        raised += cost.min() > own.min() + 0.1
    assert raised > 0
