"""What the seed decides about looks: how clothes are cut and how loose they are, hair and its colour."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from muybridge.synthetic.clip import Motion
from muybridge.synthetic.description import Person
from muybridge.synthetic.figure_file import cut_names
from muybridge.synthetic.outfits import BARE, Garment
from muybridge.synthetic.textures import Colour

WOMEN = ("old_woman", "slight_woman", "woman")
OLD = ("old_man", "old_woman")
#: What is worn by chance; women wear skirts too, but not to jog: knees would come through.
CUTS = tuple(name for name in cut_names() if name != "skirt")
#: Repeated by how common they are.
HAIR_OF_WOMEN, HAIR_OF_OTHERS = ("short", "long", "bun"), ("short", "short", "short", "long")
#: Blue, green, red: black, browns, fair, red; grey to white.
HAIR_COLOURS: tuple[Colour, ...] = (
    (30, 28, 28),
    (34, 44, 62),
    (42, 58, 84),
    (60, 86, 118),
    (104, 152, 186),
    (36, 62, 124),
)
GREYS: tuple[Colour, ...] = ((118, 120, 124), (150, 153, 156), (186, 189, 192))


def dressed(seed: Sequence[int], person: Person, looseness: tuple[float, float]) -> Person:
    """The person with all that is open decided, each with a draw of its own.

    Parameters
    ----------
    seed : of these draws alone: where people and cameras are does not depend on what is worn
    person : a cut or hair that is named stays
    looseness : metres, from and to
    """
    rng = np.random.default_rng([*seed, 30200])
    woman, old = person.figure in WOMEN, person.figure in OLD
    jogs = isinstance(person.motion, Motion) and person.motion.kind == "jog"
    cut = str(rng.choice((*CUTS, "skirt") if woman and not jogs else CUTS))
    hair = str(rng.choice(HAIR_OF_WOMEN if woman else HAIR_OF_OTHERS))
    colours = GREYS if old else HAIR_COLOURS
    colour = colours[int(rng.integers(len(colours)))]
    return replace(
        person,
        outfit=(*person.outfit, _hair(colour)),
        cut=person.cut or cut,
        hair=person.hair or hair,
        looseness=float(rng.uniform(*looseness)),
    ).complete()


def _hair(colour: Colour) -> Garment:
    """Hair of that colour, otherwise as everybody's."""
    own = next(garment for garment in BARE if garment.label == "hair")
    return replace(own, colour=colour)
