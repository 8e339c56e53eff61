"""Which bone of a recording is which of the figure's: the families of names that motion files use."""

from __future__ import annotations

from muybridge.errors import InputError

#: Bones that a recording must have, and names for them, sides left out; "left hip" is `lefthip`, `lhip` or `hipl`.
#: A family is taken as a whole, for a "shoulder" is the clavicle in one and the upper arm in another.
FAMILIES: dict[str, dict[str, tuple[str, ...]]] = {
    "CMU's ASF (lfemur)": {
        "pelvis": ("root",),
        "head": ("head",),
        "clavicle": ("clavicle",),
        "upper_arm": ("humerus",),
        "forearm": ("radius",),
        "hand": ("hand", "wrist"),
        "thigh": ("femur",),
        "shank": ("tibia",),
        "foot": ("foot",),
        "toes": ("toes",),
    },
    "BVH by segments (LeftUpLeg), as CMU's and Mixamo's": {
        "pelvis": ("hips", "pelvis", "hip"),
        "head": ("head",),
        "clavicle": ("shoulder", "collar", "clavicle"),
        "upper_arm": ("arm", "uparm", "upperarm"),
        "forearm": ("forearm", "lowarm", "lowerarm"),
        "hand": ("fingerbase", "hand"),
        "thigh": ("upleg", "upperleg", "thigh"),
        "shank": ("leg", "lowleg", "lowerleg", "shin", "calf"),
        "foot": ("foot",),
        "toes": ("toebase", "toe", "toes"),
    },
    "BVH by joints (LeftHip)": {
        "pelvis": ("hips", "pelvis", "root"),
        "head": ("head",),
        "clavicle": ("collar", "clavicle"),
        "upper_arm": ("shoulder",),
        "forearm": ("elbow",),
        "hand": ("wrist", "hand"),
        "thigh": ("hip",),
        "shank": ("knee",),
        "foot": ("ankle",),
        "toes": ("toe", "toebase", "foot"),
    },
}
CENTRAL = ("pelvis", "head")
OPTIONAL = ("clavicle", "toes")


def matched(names: tuple[str, ...], where: str) -> dict[str, int]:
    """Figure bone -> index of a recording's bone, in the family that leaves the fewest out.

    Parameters
    ----------
    names : names of a recording's bones, with or without a prefix that ends in a colon
    where : the file, for the error
    """
    known = {_plain(name): index for index, name in reversed(list(enumerate(names)))}
    found = {family: _found(table, known) for family, table in FAMILIES.items()}
    lost = {family: [bone for bone in _needed() if bone not in found[family]] for family in FAMILIES}
    best = min(lost, key=lambda family: len(lost[family]))
    if lost[best]:
        raise InputError(
            f"bones of {where}",
            expected=f"bones for {', '.join(lost[best])} by the names of {best}",
            got=", ".join(names[:40]),
            remedy="rename the file's bones",
        )
    return found[best]


def _needed() -> list[str]:
    parts = [part for part in next(iter(FAMILIES.values())) if part not in (*CENTRAL, *OPTIONAL)]
    return [*CENTRAL, *(f"{side}_{part}" for side in ("left", "right") for part in parts)]


def _found(table: dict[str, tuple[str, ...]], known: dict[str, int]) -> dict[str, int]:
    """Figure bone -> index, of the bones that one family finds."""
    found = {}
    for part, words in table.items():
        for bone, spelt in _spellings(part, words):
            index = next((known[name] for name in spelt if name in known), None)
            if index is not None:
                found[bone] = index
    return found


def _spellings(part: str, words: tuple[str, ...]) -> list[tuple[str, list[str]]]:
    """Figure bones of a part, each with the plain names it may have, the first choice first."""
    if part in CENTRAL:
        return [(part, list(words))]
    return [
        (f"{side}_{part}", [name for word in words for name in (side + word, side[0] + word, word + side[0])])
        for side in ("left", "right")
    ]


def _plain(name: str) -> str:
    """Lower case, without prefix and punctuation: "mixamorig:LeftUpLeg" -> "leftupleg"."""
    return "".join(letter for letter in name.rpartition(":")[2].lower() if letter.isalnum())
