"""What people in scenes wear: cloth by the figure's labels, in colours that rooms do not have too much of."""

from __future__ import annotations

from dataclasses import dataclass

from muybridge.errors import InputError
from muybridge.synthetic.textures import PATTERNS, Colour


@dataclass(frozen=True)
class Garment:
    """Cloth on one label of the figure: pattern of `textures.PATTERNS`, BGR colours, tile size in metres."""

    label: str
    pattern: str
    colour: Colour
    second: Colour = (0, 0, 0)
    tile: float = 0.3

    def __post_init__(self) -> None:
        if self.pattern not in PATTERNS:
            raise InputError("cloth: pattern", expected=f"one of {', '.join(PATTERNS)}", got=repr(self.pattern))


Outfit = tuple[Garment, ...]

BARE: Outfit = (
    Garment("skin", "smooth", (150, 176, 220), tile=0.5),
    Garment("hair", "denim", (42, 58, 84), tile=0.25),
    Garment("eyes", "plain", (90, 90, 90)),
    Garment("soles", "plain", (70, 74, 78)),
)
OUTFITS: dict[str, Outfit] = {
    "striped": (
        Garment("shirt", "stripes", (58, 46, 176), (206, 210, 214), tile=0.28),
        Garment("trousers", "denim", (104, 66, 44), tile=0.4),
        Garment("shoes", "plain", (40, 40, 44)),
    ),
    "checked": (
        Garment("shirt", "checks", (120, 84, 36), (70, 40, 24), tile=0.24),
        Garment("trousers", "plain", (58, 62, 66), tile=0.4),
        Garment("shoes", "plain", (150, 152, 158)),
    ),
    "green": (
        Garment("shirt", "plain", (70, 116, 62), tile=0.4),
        Garment("trousers", "denim", (56, 50, 46), tile=0.4),
        Garment("shoes", "plain", (30, 36, 60)),
    ),
    "blotched": (
        Garment("shirt", "blotches", (64, 44, 92), (150, 120, 176), tile=0.5),
        Garment("trousers", "denim", (120, 84, 58), tile=0.4),
        Garment("shoes", "plain", (60, 50, 46)),
    ),
    "red": (
        Garment("shirt", "plain", (46, 40, 158), tile=0.4),
        Garment("trousers", "plain", (44, 42, 40), tile=0.4),
        Garment("shoes", "plain", (52, 60, 96)),
    ),
    "ochre": (
        Garment("shirt", "checks", (52, 128, 184), (36, 78, 130), tile=0.3),
        Garment("trousers", "denim", (52, 66, 74), tile=0.4),
        Garment("shoes", "plain", (34, 36, 40)),
    ),
}
"""By name. The first four are those of the demo, and their order is part of what its seeds mean."""

DEMO_OUTFITS: tuple[Outfit, ...] = tuple(OUTFITS.values())[:4]


def completed(worn: Outfit) -> Outfit:
    """The garments with BARE's for the labels that they leave open, one a label."""
    return tuple({garment.label: garment for garment in (*BARE, *worn)}.values())


def outfit(name: str) -> Outfit:
    """The outfit of that name."""
    if name not in OUTFITS:
        raise InputError("outfit", expected=f"one of {', '.join(OUTFITS)}", got=repr(name))
    return OUTFITS[name]
