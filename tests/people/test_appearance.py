"""What people look like from head to foot, and whose a pixel is, on people made by hand."""

from __future__ import annotations

import numpy as np
import pytest

from made_people import SKIN, Walker, picture_of
from muybridge._kernels.appearance import CODES
from muybridge.people.appearance import (
    BANDS,
    CLEAREST,
    Appearance,
    AppearanceLikelihood,
    anybody,
    colour_codes,
    log_ratios,
)
from muybridge.people.box import states_from_boxes
from muybridge.people.evidence import Claim, Evidence
from muybridge.people.histograms import to_luma_chroma
from people.made import EMPTY, known

NEAR, FAR = Walker((150, 190), (150, 190), 0, 9, 0), Walker((160, 176), (160, 176), 0, 9, 1)


def seen(*walkers: Walker) -> tuple[np.ndarray, np.ndarray]:
    """Codes (H, W), and the foreground."""
    picture, mask = picture_of(list(walkers), 0, EMPTY)
    return colour_codes(to_luma_chroma(picture)), mask


def state_of(walker: Walker) -> np.ndarray:
    return states_from_boxes(np.array([walker.box(0)]))[0]


def appearance_of(walker: Walker) -> Appearance:
    learnt = Appearance.learn(*seen(walker), state_of(walker))
    assert learnt is not None
    return learnt


def test_bands_are_shares() -> None:
    learnt = appearance_of(NEAR)
    assert learnt.histograms.shape == (BANDS, CODES)
    np.testing.assert_allclose(learnt.histograms.sum(axis=1), 1, atol=1e-5)  # float32
    assert learnt.colours.min() > 0


def test_nobody_is_learnt_from_half_a_person() -> None:
    codes, mask = seen(NEAR)
    mask[200 - 30 :] = False  # no legs: bands without a pixel
    assert Appearance.learn(codes, mask, state_of(NEAR)) is None


def test_what_is_not_seen_stays_as_it_was() -> None:
    codes, mask = seen(FAR)
    box = state_of(FAR)
    mask[: int(box[1])] = False  # legs only
    before = appearance_of(FAR)
    after = before.updated(codes, mask, box)
    np.testing.assert_array_equal(after.histograms[0], before.histograms[0])
    assert after.looks == 2


def test_of_two_pixels_go_to_whom_they_look_like() -> None:
    """The nearer one's red shirt hides the other from the right to the left; what shows of green is the other's."""
    codes, mask = seen(NEAR, FAR)
    picture, _ = picture_of([NEAR, FAR], 0, EMPTY)
    _, near_mask = seen(NEAR)
    evidence = Evidence(mask, known().silhouette, codes=codes)
    near, far = (Claim(state_of(walker), appearance_of(walker).colours) for walker in (NEAR, FAR))
    own = mask & ~near_mask
    assert own.sum() > 100
    # Heads and hands are of one colour, and may go either way. Clothes are bins apart: in its band the one's colour is
    # thousands of times as dense as what is even (0.02 of 2048 bins), and boxes speak 19 to 1 at most (HIGHEST).
    clothes = np.abs(picture.astype(int) - SKIN).max(axis=2) > 12
    behind, before = evidence.of(far, [near], []), evidence.of(near, [], [far])
    assert behind.shown[own & clothes].mean() > 0.99 and behind.shown[near_mask & clothes].mean() < 0.01
    assert before.share[near_mask & clothes].mean() > 0.99 and before.share[own & clothes].mean() < 0.01
    unknown = evidence.of(Claim(far.box), [Claim(near.box)], [])
    assert unknown.shown[own].mean() < behind.shown[own].mean()  # negative control: by the box alone less of them shows


def test_evidence_for_one_leaves_that_of_all_alone() -> None:
    codes, mask = seen(NEAR, FAR)
    evidence = Evidence(mask, known().silhouette, codes=codes)
    near, far = (Claim(state_of(walker), appearance_of(walker).colours) for walker in (NEAR, FAR))
    evidence.of(far, [near], [])
    evidence.of(near, [], [far])
    assert (evidence.weights == 1).all() and (evidence.share == mask).all() and evidence.shown.all()


def test_colours_draw_a_box_to_the_person_they_are_of() -> None:
    """Both stand apart: of places at either, one's own is the likelier for each, by the colours alone."""
    walkers = [Walker((100, 180), (100, 180), 0, 0, 0), Walker((200, 180), (200, 180), 0, 0, 1)]
    codes, mask = seen(*walkers)
    looks = [appearance_of(walker) for walker in walkers]
    boxes = np.array([state_of(walker) for walker in walkers])
    scores = np.array(
        [
            AppearanceLikelihood(codes, mask.astype(np.float32), log_ratios(look, anybody(looks)), 1.0).log_prob(boxes)
            for look in looks
        ]
    )
    assert (np.diag(scores) > 0).all() and (scores[[0, 1], [1, 0]] < 0).all()


def test_nobody_says_more_than_the_limit() -> None:
    looks = [appearance_of(walker) for walker in (NEAR, FAR)]
    ratios = log_ratios(looks[0], anybody(looks))
    assert ratios.shape == (CODES, BANDS) and np.abs(ratios).max() == pytest.approx(CLEAREST)
