"""Looks by chance: repeatable, various, as people are, and without a say in where anything is."""

from __future__ import annotations

import pytest

from muybridge.synthetic.clip import Motion
from muybridge.synthetic.description import Person
from muybridge.synthetic.figure_file import HAIR, cut_names
from muybridge.synthetic.presets import PRESETS, preset_scene
from muybridge.synthetic.skinning import figure_names
from muybridge.synthetic.wardrobe import GREYS, HAIR_COLOURS, OLD, WOMEN, dressed

SEEDS = range(40)


def looks(name: str) -> list[Person]:
    return [dressed([seed], Person(name), (0.01, 0.02)) for seed in SEEDS]


def colour_of_hair(person: Person) -> tuple[int, int, int]:
    return next(garment.colour for garment in person.outfit if garment.label == "hair")


def test_women_and_old_people_are_figures() -> None:
    assert {*WOMEN, *OLD} <= set(figure_names())


def test_the_same_again() -> None:
    assert looks("man") == looks("man")


@pytest.mark.parametrize("name", figure_names())
class TestEverybody:
    def test_cut_and_hair_vary(self, name: str) -> None:
        """The rarest has a chance of 1 in 4: 40 draws miss one with a chance of 1e-5, and the seeds are fixed."""
        cuts, hair = {person.cut for person in looks(name)}, {person.hair for person in looks(name)}
        assert cuts == set(cut_names()) - (set() if name in WOMEN else {"skirt"})
        assert hair == (set(HAIR) if name in WOMEN else {"short", "long"})

    def test_hair_is_grey_with_age_only(self, name: str) -> None:
        colours = {colour_of_hair(person) for person in looks(name)}
        assert len(colours) > 2 and colours <= set(GREYS if name in OLD else HAIR_COLOURS)

    def test_looseness(self, name: str) -> None:
        """Each end is missed by a fifth of the range with a chance of 0.8^40: 1e-4."""
        found = [person.looseness for person in looks(name)]
        assert 0.01 <= min(found) < 0.012 and 0.018 < max(found) <= 0.02


def test_nobody_jogs_in_a_skirt_by_chance() -> None:
    cuts = {dressed([seed], Person("woman", Motion("jog")), (0.0, 0.0)).cut for seed in SEEDS}
    assert cuts == set(cut_names()) - {"skirt"}


def test_what_is_named_stays() -> None:
    for seed in SEEDS:
        person = dressed([seed], Person("man", cut="skirt", hair="bun"), (0.0, 0.0))
        assert (person.cut, person.hair, person.looseness) == ("skirt", "bun", 0.0)


@pytest.mark.parametrize("preset", PRESETS)
def test_presets_are_dressed(preset: str) -> None:
    least, most = PRESETS[preset].looseness
    for seed in range(3):
        scene = preset_scene(preset, seed=seed)
        assert all(person == person.complete() and least <= person.looseness <= most for person in scene.people)


def test_clothes_move_nothing() -> None:
    plain, skirt = (preset_scene("studio", seed=1, figure="woman", cut=cut) for cut in ("shorts", "skirt"))
    assert plain.person.cut == "shorts" and skirt.person.cut == "skirt"
    assert skirt.rig == plain.rig and skirt.person.motion == plain.person.motion
    assert (skirt.person.hair, skirt.person.looseness) == (plain.person.hair, plain.person.looseness)
