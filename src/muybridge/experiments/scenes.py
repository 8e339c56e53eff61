"""From a clip's description to the scene that is rendered, and the body that is right for its figure."""

from __future__ import annotations

from functools import lru_cache

from muybridge.body import Body
from muybridge.errors import InputError
from muybridge.experiments.trial import Clip
from muybridge.synthetic.measure import tracker_body
from muybridge.synthetic.motion import KINDS
from muybridge.synthetic.presets import preset_scene
from muybridge.synthetic.scene import Scene
from muybridge.synthetic.skinning import figure_names

#: In this order motions are taken for experiments; the thesis has walking and hopping.
PREFERRED_MOTIONS = ("walk", "hop", "wave", "jog", "turn", "crouch")
PREFERRED_FIGURES = ("man", "woman", "heavy_man")


def known_motions() -> tuple[str, ...]:
    """Motions that need no recording, in the order in which experiments take them."""
    kinds = tuple(KINDS)
    return tuple(k for k in PREFERRED_MOTIONS if k in kinds) + tuple(k for k in kinds if k not in PREFERRED_MOTIONS)


def known_figures() -> tuple[str, ...]:
    """The baked people, in the order in which experiments take them."""
    names = figure_names()
    return tuple(n for n in PREFERRED_FIGURES if n in names) + tuple(n for n in names if n not in PREFERRED_FIGURES)


@lru_cache(maxsize=8)
def scene_of(clip: Clip) -> Scene:
    """The scene of a clip: everything else than what the clip says follows from its seed."""
    scene = preset_scene(
        clip.preset,
        seed=clip.seed,
        figure=clip.figure,
        motion=clip.motion,
        cameras=clip.cameras,
        view=clip.view,  # type: ignore[arg-type]  # checked by Clip
        duration=clip.frames / clip.rate,
        rate=clip.rate,
    )
    if len(scene.rig) != clip.cameras or scene.frame_count != clip.frames:
        expected = f"{clip.cameras} cameras and {clip.frames} frames"
        raise InputError(f"preset {clip.preset!r}", expected=expected, got=f"{len(scene.rig)} and {scene.frame_count}")
    return scene


def right_body(clip: Clip) -> Body:
    """The tracker's body with the joint centres and girths of the clip's person, as dressed."""
    person = scene_of(clip).person
    return tracker_body(person.figure, person.cut, person.hair)
