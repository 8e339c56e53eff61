"""Mixtures and pairs of pixels against their meaning, pixel by pixel."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge._kernels.mixture import calm_deviations, mixture_look, mixture_nearest, mixture_scores, mixture_update
from muybridge._kernels.pairs import choose_partners, pair_scores, pair_update
from muybridge.segmentation.spatial import OFFSETS
from reference import mixture as literal

H, W, K, C = 9, 11, 6, 3
LIMIT = 2.5**2 * C
SETTINGS = {"rate": 0.05, "floor": 4.0, "wide": 225.0, "portion": 0.9}
SINGLE = 2e-4  # relative: some twenty roundings of float32 (6e-8 each) under an exponential of at most a hundred


class Mixtures:
    """Learnt by the kernel and by the reference from the same colours: three looks, noise, now and then anything."""

    def __init__(self, pictures: int = 60) -> None:
        rng = np.random.default_rng(3)
        self.looks = rng.integers(20, 230, (3, H, W, C))
        self.weights, self.kept = np.zeros((H, K, W), np.float32), np.zeros((H, W), np.uint8)
        self.means, self.variances = np.zeros((H, K, C, W), np.float32), np.ones((H, K, C, W), np.float32)
        self.known = np.zeros((H, W), bool)
        self.true = [np.zeros((H, W, K)), np.zeros((H, W, K, C)), np.ones((H, W, K, C))]
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
        nearest = np.zeros((H, W), np.int8)
        mixture_nearest(image, self.weights, self.means, self.variances, LIMIT, nearest)
        mixture_update(image, np.ones((H, W), bool), nearest, self.weights, self.means, self.variances, self.kept,
                       **SETTINGS, matched=matched, fresh=fresh, background=self.known)  # fmt: skip
        self.pairs.append((matched, fresh))
        weights, means, variances = self.true
        for y, x in np.ndindex(H, W):
            found = literal.learn(image[y, x].astype(float), weights[y, x], means[y, x], variances[y, x],
                                  LIMIT, SETTINGS["rate"], SETTINGS["floor"], SETTINGS["wide"])  # fmt: skip
            assert found == (matched[y, x], fresh[y, x])

    def look(self) -> tuple[np.ndarray, ...]:
        """As `mixture_look` fills them: nearest, squares, heights, densities, alone."""
        slots = (np.empty((H, K, W), np.float32) for _ in range(3))
        out = (np.empty((H, W), np.int8), *slots, np.empty((H, W), np.float32))
        mixture_look(self.image, self.weights, self.means, self.variances, self.kept, LIMIT, *out)
        return out


MADE = Mixtures()
FEW = 6
PICTURES = [60, FEW]
"""Of which pairs learn: after few, most have shown one combination, or none."""


def test_learning_is_that_of_the_reference() -> None:
    found = (np.moveaxis(MADE.weights, 1, 2), *(array.transpose(0, 3, 1, 2) for array in (MADE.means, MADE.variances)))
    for kernel, true in zip(found, MADE.true, strict=True):
        used = np.broadcast_to((MADE.true[0] > 0).reshape((H, W, K) + (1,) * (true.ndim - 3)), true.shape)
        np.testing.assert_allclose(kernel[used], true[used], rtol=SINGLE)
    np.testing.assert_allclose(MADE.weights.sum(axis=1), 1.0, rtol=1e-5)


def test_background_components() -> None:
    for y, x in np.ndindex(H, W):
        wanted = literal.background_slots(MADE.true[0][y, x], MADE.true[2][y, x], SETTINGS["portion"])
        assert {k for k in range(K) if MADE.kept[y, x] >> k & 1} == wanted


def test_densities_and_scores() -> None:
    nearest, squares, heights, found, alone = MADE.look()
    scores, again = np.empty((H, W), np.float32), np.empty((H, W), np.int8)
    mixture_scores(MADE.image, MADE.weights, MADE.means, MADE.variances, MADE.kept, scores)
    mixture_nearest(MADE.image, MADE.weights, MADE.means, MADE.variances, LIMIT, again)
    np.testing.assert_array_equal(nearest, again)
    for y, x in np.ndindex(H, W):
        kept = np.array([MADE.kept[y, x] >> k & 1 for k in range(K)])
        wanted = kept * literal.densities(
            MADE.image[y, x].astype(float), MADE.means[y, :, :, x], MADE.variances[y, :, :, x]
        )
        np.testing.assert_allclose(found[y, :, x], wanted, rtol=SINGLE)
        np.testing.assert_allclose(heights[y, :, x], kept * literal.heights(MADE.variances[y, :, :, x]), rtol=SINGLE)
        far = literal.distances(MADE.image[y, x].astype(float), MADE.means[y, :, :, x], MADE.variances[y, :, :, x])
        np.testing.assert_allclose(squares[y, :, x], far, rtol=SINGLE)
        np.testing.assert_allclose(alone[y, x], MADE.weights[y, :, x] @ wanted, rtol=SINGLE, atol=literal.LEAST)
        np.testing.assert_allclose(scores[y, x], -np.log(max(MADE.weights[y, :, x] @ wanted, literal.LEAST)), atol=1e-3)


def learnt_pairs(growth_rate: float, pictures: int | None = None) -> tuple[np.ndarray, np.ndarray]:
    counts, totals = (
        np.zeros((H, len(OFFSETS), K, K, W), np.float32),
        np.zeros((len(OFFSETS), H, W), np.float32),
    )
    for matched, fresh in MADE.pairs[:pictures]:
        pair_update(counts, totals, OFFSETS, matched, fresh, growth_rate)
    return counts, totals


def matrix_of(counts: np.ndarray, n: int, y: int, x: int) -> tuple[np.ndarray, tuple[int, int]] | None:
    """Counts (K, K) of a pixel's and its partner n's components, and the partner's place; None outside the picture."""
    d, (down, right), sign = n >> 1, OFFSETS[n >> 1], 1 - 2 * (n & 1)
    qy, qx = y + sign * down, x + sign * right
    if not (0 <= qy < H and 0 <= qx < W):
        return None
    return (counts[y, d, :, :, x] if sign > 0 else counts[qy, d, :, :, qx].T).astype(float), (qy, qx)


def test_counts_are_of_components_that_matched_together_since_they_were_made() -> None:
    """With a rate so small that each picture counts one."""
    counts, totals = learnt_pairs(1e-9)
    (d, (down, right)), (y, x) = next(iter(enumerate(OFFSETS))), (2, 3)
    wanted = np.zeros((K, K))
    for matched, fresh in MADE.pairs:
        if fresh[y, x] >= 0:
            wanted[fresh[y, x]] = 0
        if fresh[y + down, x + right] >= 0:
            wanted[:, fresh[y + down, x + right]] = 0
        if matched[y, x] >= 0 and matched[y + down, x + right] >= 0:
            wanted[matched[y, x], matched[y + down, x + right]] += 1
    np.testing.assert_array_equal(counts[y, d, :, :, x], wanted)
    assert totals[d, y, x] == wanted.sum() > 10


@pytest.mark.parametrize("pictures", PICTURES)
def test_scores_and_partners(pictures: int) -> None:
    """(3.1): the pixel's own density and those with its two most informative partners, where something is known."""
    counts, totals = learnt_pairs(0.02, pictures)
    information, partners = np.zeros((len(OFFSETS), H, W), np.float32), np.zeros((H, W, 2), np.int8)
    choose_partners(counts, OFFSETS, 0, 1, information, partners)
    _, squares, heights, found, alone = MADE.look()
    out = np.empty((H, W), np.float32)

    def side(y: int, x: int) -> tuple[np.ndarray, np.ndarray]:
        return squares[y, :, x].astype(float), heights[y, :, x].astype(float)

    pair_scores(alone, squares, heights, found, MADE.kept, counts, totals, OFFSETS, partners, 4.0, out)
    for y, x in np.ndindex(H, W):
        candidates = {}
        for n in range(2 * len(OFFSETS)):
            pair = matrix_of(counts, n, y, x)
            if pair is not None:
                candidates[n] = pair[0], *(side(*place) for place in ((y, x), pair[1]))
        gain = {
            n: literal.mutual_information(matrix) if matrix.any() else 0.0 for n, (matrix, *_) in candidates.items()
        }
        chosen = [int(n) for n in partners[y, x] if n >= 0]
        assert len(chosen) == min(2, len(candidates))
        for rank, n in enumerate(sorted(gain.values(), reverse=True)[: len(chosen)]):
            np.testing.assert_allclose(gain[chosen[rank]], n, atol=1e-5)
        own = found[y, :, x].astype(float)
        wanted = -np.log(max(MADE.weights[y, :, x] @ own, literal.LEAST))
        known = [n for n in chosen if candidates[n][0].any()]
        wanted += sum(literal.joint(*candidates[n], 4.0) for n in known)
        np.testing.assert_allclose(out[y, x], wanted, rtol=1e-4, atol=1e-3)


def test_the_newest_picture_has_one_share_in_all_and_later_the_rate() -> None:
    """With a rate of 1 / 11 from 10 pictures on."""
    counts, totals = np.zeros((6, 1, K, K, 1), np.float32), np.zeros((1, 6, 1), np.float32)
    offset, matched, fresh = np.array([(5, 0)]), np.full((6, 1), 2, np.int8), np.full((6, 1), -1, np.int8)
    for number in range(1, 31):
        pair_update(counts, totals, offset, matched, fresh, 1 / 11)
        np.testing.assert_allclose(totals[0, 0, 0], counts[0, 0, 2, 2, 0], rtol=1e-5)
        assert number > 10 or totals[0, 0, 0] == number
    matched[5] = 3
    pair_update(counts, totals, offset, matched, fresh, 1 / 11)
    np.testing.assert_allclose(counts[0, 0, 2, 3, 0] / totals[0, 0, 0], 1 / 11, rtol=1e-3)


def test_counts_that_have_grown_large_are_made_small_again() -> None:
    """A rate of 1 / 2 doubles them at each picture; shares stay."""
    counts, totals = np.zeros((6, 1, K, K, 1), np.float32), np.zeros((1, 6, 1), np.float32)
    matched, fresh = np.full((6, 1), 2, np.int8), np.full((6, 1), -1, np.int8)
    for number in range(300):
        matched[5] = number % 2
        pair_update(counts, totals, np.array([(5, 0)]), matched, fresh, 1 / 2)
        assert 0 < totals[0, 0, 0] < 1e31
    np.testing.assert_allclose(counts[0, 0, 2, :2, 0] / totals[0, 0, 0], [1 / 3, 2 / 3], rtol=1e-5)


SOME = 0.4
"""Of the weight: some pixels have a component of more."""


@pytest.mark.parametrize("calm", [0.0, SOME, 1.1])
def test_deviations_of_the_heaviest_component_where_it_is_calm(calm: float) -> None:
    found, floor = np.empty((H, W), np.float32), 16.0
    calm_deviations(MADE.image, MADE.weights, MADE.means, MADE.variances, calm, floor, found)
    for y, x in np.ndindex(H, W):
        k = int(MADE.weights[y, :, x].argmax())
        off = MADE.image[y, x].astype(float) - MADE.means[y, k, :, x]
        wanted = np.sqrt((off**2 / np.maximum(MADE.variances[y, k, :, x], floor)).max())
        np.testing.assert_allclose(found[y, x], wanted * (MADE.weights[y, k, x] >= calm), rtol=SINGLE)
    share = (found > 0).mean()
    assert share == {0.0: 1.0, 1.1: 0.0}[calm] if calm != SOME else 0 < share < 1
