"""The foreground: what is faint counts where it belongs to somebody, and a lamp that is switched does not."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.people.masks import MaskConfig, Masks
from muybridge.segmentation import BACKGROUND_MODELS

FLOOR = (120, 130, 140)
COAT, LEGS = (150, 30, 30), (105, 128, 150)
"""BGR; in CIE Lab, lightness at half weight, 83 and 9 from the floor: over the threshold of 15, and over 0.4 of it."""


def scene() -> np.ndarray:
    return np.full((120, 160, 3), FLOOR, np.uint8)


def with_somebody(legs_at: int) -> np.ndarray:
    """A coat in columns 60 to 80, and legs that begin in some column."""
    picture = scene()
    picture[30:60, 60:80] = COAT
    picture[60:90, legs_at : legs_at + 20] = LEGS
    return picture


MASKS = Masks.train([scene()])


def test_legs_belong_to_a_coat() -> None:
    mask = MASKS.apply(with_somebody(60))
    assert mask[32:58, 62:78].all() and mask[62:88, 62:78].all() and mask.sum() <= 60 * 20


def test_what_is_faint_alone_is_nobody() -> None:
    mask = MASKS.apply(with_somebody(110))
    assert mask[32:58, 62:78].all() and not mask[:, 105:].any()
    alone = Masks.train([scene()], MaskConfig(threshold=6.0, faint=1.0)).apply(with_somebody(110))
    assert alone[62:88, 112:128].all()  # negative control: by one low threshold they are


def test_a_shadow_is_nobody() -> None:
    picture = with_somebody(60)
    picture[62:88, 80:140] = (0.6 * scene()[62:88, 80:140]).astype(np.uint8)
    assert not MASKS.apply(picture)[:, 83:].any()
    assert Masks.train([scene()], MaskConfig(shadows=False)).apply(picture)[64:86, 85:135].all()  # negative control


def test_a_lamp_that_is_switched() -> None:
    dim = (0.6 * with_somebody(60)).astype(np.uint8)
    mask = MASKS.apply(MASKS.relit(dim))
    assert mask[32:58, 62:78].all() and mask[:, 85:].mean() == 0


@pytest.mark.parametrize("wrong", [{"faint": 0.0}, {"faint": 1.5}, {"threshold": 0.0}, {"model": "nothing"}])
def test_what_is_refused(wrong: dict) -> None:
    with pytest.raises(InputError):
        MaskConfig(**wrong)


@pytest.mark.parametrize("model", ["spatial", "auto"])
def test_light_is_taken_out_once(model: str) -> None:
    """Pictures are relit before they come: the model inside leaves light alone, which in Python it takes out itself."""
    rng = np.random.default_rng(0)
    pictures = [np.clip(scene() + rng.normal(0, 2, (120, 160, 3)), 0, 255).astype(np.uint8) for _ in range(12)]
    masks = Masks.train(pictures, MaskConfig(model=model, threshold=4.0))
    assert masks.model.config.light is False and BACKGROUND_MODELS[model].config().light is True
    darker = (0.7 * pictures[0]).astype(np.uint8)
    assert masks.model.apply(darker).mean() > 0.9  # 30 % darker is 36 grey values or more, 9 of the largest floor
    assert not masks.apply(masks.relit(darker)).any()
