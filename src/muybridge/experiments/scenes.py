"""From a clip's description to the scene that is rendered, and the body that is right for its figure."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from importlib import resources
from importlib.util import find_spec
from typing import Any

import numpy as np

from muybridge.body import Body, named_body
from muybridge.cameras.model import Rig
from muybridge.errors import InputError
from muybridge.experiments.trial import Clip
from muybridge.synthetic import motion as motions
from muybridge.synthetic import skinning
from muybridge.synthetic.motion import Motion, perform
from muybridge.synthetic.rigs import looking_at, ring
from muybridge.synthetic.room import Room
from muybridge.synthetic.scene import Person, Scene
from muybridge.synthetic.skinning import load_figure

#: In this order motions are taken for experiments; the thesis has walking and hopping.
PREFERRED_MOTIONS = ("walk", "hop", "wave", "jog", "turn", "crouch")
PREFERRED_FIGURES = ("man", "woman", "heavy_man")
TRIES, EDGE = 200, 16.0  # draws of a scene; pixels that the joints stay inside the picture
SIDE_DISTANCE = 4.2  # metres, of the camera that looks across the path


def known_motions() -> tuple[str, ...]:
    """Motions that need no recording, in the order in which experiments take them."""
    kinds = tuple(motions.KINDS)
    return tuple(k for k in PREFERRED_MOTIONS if k in kinds) + tuple(k for k in kinds if k not in PREFERRED_MOTIONS)


def known_figures() -> tuple[str, ...]:
    """The baked people, in the order in which experiments take them."""
    names = _figure_names()
    return tuple(n for n in PREFERRED_FIGURES if n in names) + tuple(n for n in names if n not in PREFERRED_FIGURES)


def _figure_names() -> list[str]:
    named = getattr(skinning, "figure_names", None)
    if named is not None:
        return list(named())
    folder = resources.files("muybridge.synthetic") / "bodies"
    return sorted(entry.name[:-4] for entry in folder.iterdir() if entry.name.endswith(".npz"))


@lru_cache(maxsize=8)
def scene_of(clip: Clip) -> Scene:
    """The scene of a clip: everything else than what the clip says follows from its seed."""
    presets: Any = _optional("muybridge.synthetic.presets")
    duration = clip.frames / clip.rate
    if presets is None:
        return _plain_scene(clip, Motion(clip.motion, duration, clip.rate, seed=clip.seed))
    scene = presets.preset_scene(
        clip.preset,
        seed=clip.seed,
        figure=clip.figure,
        motion=clip.motion,
        cameras=clip.cameras,
        view=clip.view,
        duration=duration,
        rate=clip.rate,
    )
    if len(scene.rig) != clip.cameras or scene.frame_count != clip.frames:
        expected = f"{clip.cameras} cameras and {clip.frames} frames"
        raise InputError(f"preset {clip.preset!r}", expected=expected, got=f"{len(scene.rig)} and {scene.frame_count}")
    return scene


def right_body(figure: str) -> Body:
    """The tracker's body with the joint centres and girths of a baked figure."""
    measure: Any = _optional("muybridge.synthetic.measure")
    if measure is not None:
        return measure.tracker_body(figure)
    height = float(np.ptp(load_figure(figure).vertices[:, 2]))
    return named_body("person").with_height(height)


def _optional(module: str) -> Any:
    """The module, or None where it is not there."""
    from importlib import import_module

    return import_module(module) if find_spec(module) is not None else None


def _plain_scene(clip: Clip, motion: Motion) -> Scene:
    """An ordinary room; walked through in any direction, or across the picture of a camera to the side."""
    rng = np.random.default_rng([clip.seed, 20052])
    figure = load_figure(clip.figure)
    for _ in range(TRIES):
        moved, rig = _staged(rng, clip, motion)
        if _in_view(rig, perform(figure, moved).joints):
            room = Room(floor=str(rng.choice(["planks", "tiles"])), seed=clip.seed)
            return Scene(rig, Person(clip.figure, moved), room, seed=clip.seed)
    raise InputError(f"clip {clip.motion!r}", expected="a motion that stays in view", got=f"none of {TRIES} draws did")


def _staged(rng: np.random.Generator, clip: Clip, motion: Motion) -> tuple[Motion, Rig]:
    varied = replace(motion, cadence=rng.uniform(0.80, 0.92), vigour=rng.uniform(0.92, 1.05))
    if clip.view == "ring":
        turn_rate = float(rng.choice([-1.0, 1.0])) * rng.uniform(0.2, 0.6)
        return replace(varied, heading=rng.uniform(-np.pi, np.pi), turn_rate=turn_rate), ring(rng, clip.cameras)
    place = np.array([rng.uniform(-0.2, 0.2), -SIDE_DISTANCE, rng.uniform(1.0, 1.4)])
    camera = looking_at("cam1", place, np.array([0.0, 0.0, 0.9]), focal=rng.uniform(0.84, 0.9) * 640)
    return replace(varied, heading=float(rng.choice([0.0, np.pi]))), Rig((camera,))


def _in_view(rig: Rig, joints: np.ndarray) -> bool:
    """Whether all joints (T, J, 3) stay inside every picture."""
    for camera in rig:
        pixels = camera.world_to_pixel(joints)
        if not ((pixels > EDGE) & (pixels < np.array(camera.size) - EDGE)).all():
            return False
    return True
