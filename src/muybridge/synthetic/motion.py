"""Motions that need no recording: walk, wave, crouch, each a list of joint angles over time, varied by a seed.

The walk's joint angles are tables of normal gait over one stride (heel strike to heel strike; after D. A. Winter,
Biomechanics and Motor Control of Human Movement, 4th ed., chapter 4, smoothed). The body is then moved so that the foot
that bears it stays nearly still, and raised so that it touches the floor: steps and speed follow from the legs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from muybridge.errors import InputError
from muybridge.synthetic.skinning import Figure

#: Degrees at equal steps of the stride of the same leg: flexion of hip and knee, dorsiflexion of ankle and toes. They
#: were fitted, near normal gait, so that a body carried by them goes at an even speed and a steady height.
HIP = (19, 17, 16.4, 14.8, 11.1, 5.5, -1.2, -7.5, -11.3, -12, -10.7, -7.8, -3.3, 4, 11, 17, 21, 22.5, 22, 20.5)
KNEE = (5, 13, 17, 9, 4, 18, 38, 61, 50, 19)
ANKLE = (2, -2, 2, 8, 8, 11, -12, -7, 5, 1)
TOES = (8, 0, 0, 0, 4, 24, 26, 8, 6, 8)
#: Share of the stride at which a foot takes and gives up the body's weight (begin, end of each change).
TAKES, GIVES = (0.0, 0.10), (0.50, 0.62)
#: Seconds (standard deviation) over which the body's speed is evened out; the price is a foot that slips a little.
SURGE = 0.06
KINDS = ("walk", "wave", "crouch")


@dataclass(frozen=True)
class Motion:
    """What the figure does.

    Parameters
    ----------
    kind : "walk", "wave" (standing, one arm up) or "crouch" (down and up again)
    duration, rate : seconds, frames per second
    heading : radians, direction walked at the middle of the clip, counter-clockwise from +x
    turn_rate : radians per second, to the left; only a walk turns
    place : (x, y) metres, world, of the pelvis at the middle of the clip
    cadence : strides (two steps) per second, or waves or crouches per second
    vigour : factor on the amplitudes, 1 = table
    """

    kind: str = "walk"
    duration: float = 3.0
    rate: float = 30.0
    heading: float = 0.0
    turn_rate: float = 0.0
    place: tuple[float, float] = (0.0, 0.0)
    cadence: float = 0.9
    vigour: float = 1.0
    seed: int = 0

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError("motion: kind", expected=f"one of {', '.join(KINDS)}", got=repr(self.kind))
        for name in ("duration", "rate", "cadence", "vigour"):
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) > 0):
                raise InputError(f"motion: {name}", expected="a positive number", got=str(getattr(self, name)))

    @property
    def times(self) -> np.ndarray:
        """(T,) seconds."""
        return np.arange(max(1, round(self.duration * self.rate))) / self.rate


@dataclass(frozen=True, eq=False)
class Track:
    """A motion of one figure: bone frames over time.

    Parameters
    ----------
    times : (T,) seconds
    rotations : (T, B, 3, 3), world
    places : (T, B, 3) metres, world: bone heads
    joints : (T, 15, 3) metres, world
    """

    times: np.ndarray
    rotations: np.ndarray
    places: np.ndarray
    joints: np.ndarray


def perform(figure: Figure, motion: Motion) -> Track:
    """Let the figure do the motion: angles, then feet on the floor without sliding, then the path's place."""
    rng = np.random.default_rng([motion.seed, KINDS.index(motion.kind)])
    angles, bearing = {"walk": _walk, "wave": _wave, "crouch": _crouch}[motion.kind](rng, motion)
    turn_rate = motion.turn_rate if motion.kind == "walk" else 0.0
    heading = motion.heading + turn_rate * (motion.times - 0.5 * motion.times[-1])
    local = _rotations(figure, angles, heading)
    worlds, places = zip(*(figure.frames(turns, np.zeros(3)) for turns in local), strict=True)
    worlds, places = np.array(worlds), np.array(places)
    places += _planted(figure, worlds, places, bearing, motion)[:, None]
    joints = np.array([figure.joints(world, place) for world, place in zip(worlds, places, strict=True)])
    return Track(motion.times, worlds, places, joints)


# ---- what is done: angles, and the share (T, 2) of the weight on the left and right foot --------------------------

#: bone -> (T, 3) degrees: flexion forward, abduction outward, turn to the left
Angles = dict[str, np.ndarray]


def _walk(rng: np.random.Generator, motion: Motion) -> tuple[Angles, np.ndarray]:
    phase = rng.uniform() + motion.cadence * motion.times
    swing, lag = rng.uniform(17, 25), rng.uniform(-0.03, 0.03)
    angles = _standing(rng, motion)
    for side, shift in (("left", 0.0), ("right", 0.5)):
        own = phase + shift
        lean = np.sin(2 * np.pi * own)
        _add(angles, f"{side}_thigh", motion.vigour * _periodic(HIP, own), -1.5 - 5.0 * lean)
        _add(angles, f"{side}_shank", -motion.vigour * _periodic(KNEE, own))
        _add(angles, f"{side}_foot", _periodic(ANKLE, own))
        _add(angles, f"{side}_toes", _periodic(TOES, own))
        arm = -np.cos(2 * np.pi * (own + lag - 0.03)) * motion.vigour  # back at the heel strike of its own side
        _add(angles, f"{side}_upper_arm", 1.0 + swing * arm)
        _add(angles, f"{side}_forearm", 12.0 + 0.6 * swing * np.maximum(0.0, arm + 0.35))
    left = 2 * np.pi * phase
    _add(angles, "pelvis", -2.0 + 1.0 * np.cos(2 * left), 3.5 * np.sin(left), -5.0 * np.cos(left))
    _add(angles, "abdomen", 1.0, -2.5 * np.sin(left), 5.0 * np.cos(left))
    _add(angles, "thorax", -1.0, -1.0 * np.sin(left), 5.0 * np.cos(left))
    _add(angles, "neck", 0.0, 0.5 * np.sin(left), -4.5 * np.cos(left))
    return angles, np.stack([_bearing(phase), _bearing(phase + 0.5)], axis=1)


def _wave(rng: np.random.Generator, motion: Motion) -> tuple[Angles, np.ndarray]:
    side = "right" if rng.uniform() < 0.7 else "left"
    angles = _standing(rng, motion)
    raised = _smooth_step(motion.times / 0.9) * motion.vigour
    swing = np.sin(2 * np.pi * 1.6 * motion.cadence * motion.times)
    _add(angles, f"{side}_clavicle", 0.0, 14.0 * raised)
    _add(angles, f"{side}_upper_arm", 84.0 * raised, 0.0, (-48.0 if side == "right" else 48.0) * raised)
    _add(angles, f"{side}_forearm", 78.0 * raised, (6.0 + 26.0 * swing) * raised)
    _add(angles, "thorax", 0.0, (-4.0 if side == "right" else 4.0) * raised)
    _add(angles, "head", 0.0, 0.0, (8.0 if side == "left" else -8.0) * raised)
    return angles, np.ones((len(motion.times), 2))


def _crouch(rng: np.random.Generator, motion: Motion) -> tuple[Angles, np.ndarray]:
    angles = _standing(rng, motion)
    depth = 0.5 - 0.5 * np.cos(2 * np.pi * np.clip(motion.cadence * motion.times / 2.4, 0, 1))
    depth = depth * min(motion.vigour, 1.1) * rng.uniform(0.85, 1.0)
    for side in ("left", "right"):
        _add(angles, f"{side}_thigh", 85.0 * depth, 9.0 * depth)
        _add(angles, f"{side}_shank", -105.0 * depth)
        _add(angles, f"{side}_foot", 28.0 * depth)
        _add(angles, f"{side}_upper_arm", 62.0 * depth, 8.0 * depth)
        _add(angles, f"{side}_forearm", 25.0 * depth)
    _add(angles, "pelvis", -8.0 * depth)
    _add(angles, "abdomen", -14.0 * depth)
    _add(angles, "thorax", -10.0 * depth)
    _add(angles, "neck", 14.0 * depth)
    return angles, np.ones((len(motion.times), 2))


def _standing(rng: np.random.Generator, motion: Motion) -> Angles:
    """Upright and alive: arms a little off the body, slow sway, breathing."""
    sway = [np.sin(2 * np.pi * (rng.uniform(0.2, 0.45) * motion.times + rng.uniform())) for _ in range(4)]
    angles: Angles = {}
    for side, k in (("left", 0), ("right", 1)):
        _add(angles, f"{side}_upper_arm", 2.0 * sway[k], 9.0 + 1.0 * sway[1 - k])
        _add(angles, f"{side}_forearm", 6.0 + 2.0 * sway[k])
        _add(angles, f"{side}_hand", 6.0)
        _add(angles, f"{side}_thigh", 0.0, 1.0)
    _add(angles, "thorax", 0.6 * sway[2], 0.8 * sway[3])
    _add(angles, "head", 2.0 * sway[2], 0.0, 4.0 * sway[3])
    return angles


def _add(
    angles: Angles,
    bone: str,
    flexion: np.ndarray | float = 0.0,
    abduction: np.ndarray | float = 0.0,
    turn: np.ndarray | float = 0.0,
) -> None:
    """Add degrees to a bone's angles."""
    added = np.stack(np.broadcast_arrays(flexion, abduction, turn), axis=-1)
    angles[bone] = angles[bone] + added if bone in angles else added


def _periodic(table: tuple[float, ...], phase: np.ndarray) -> np.ndarray:
    """Smooth periodic curve through equally spaced values: its Fourier series."""
    spectrum = np.fft.rfft(table) / len(table)
    spectrum[1:] *= 2.0
    if len(table) % 2 == 0:
        spectrum[-1] *= 0.5
    harmonics = np.exp(2j * np.pi * np.outer(phase, np.arange(len(spectrum))))
    return (harmonics @ spectrum).real


def _bearing(phase: np.ndarray) -> np.ndarray:
    """(T,) share of the weight that a leg bears at this phase of its stride."""
    phase = phase % 1.0
    taken = _smooth_step((phase - TAKES[0]) / (TAKES[1] - TAKES[0]))
    return taken * (1.0 - _smooth_step((phase - GIVES[0]) / (GIVES[1] - GIVES[0])))


def _smooth_step(x: np.ndarray) -> np.ndarray:
    """0 to 1 over [0, 1] with no corner."""
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


# ---- from angles to a body on the floor ------------------------------------------------------------------------------


def _rotations(figure: Figure, angles: Angles, heading: np.ndarray) -> np.ndarray:
    """(T, B, 3, 3): turn, then abduction, then flexion of each bone in its parent; the root also has the heading."""
    local = np.tile(np.eye(3), (len(heading), len(figure.bone_names), 1, 1))
    for name, degrees in angles.items():
        flexion, abduction, turn = np.radians(np.broadcast_to(degrees, (len(heading), 3))).T
        outward = abduction if not name.startswith("right_") else -abduction
        local[:, figure.bone(name)] = _about(2, turn) @ _about(0, outward) @ _about(1, -flexion)
    local[:, 0] = _about(2, heading) @ local[:, 0]
    return local


def _about(axis: int, angle: np.ndarray) -> np.ndarray:
    """(T, 3, 3): right-handed turns about a coordinate axis."""
    cosine, sine = np.cos(angle), np.sin(angle)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    out = np.zeros((*np.shape(angle), 3, 3))
    out[..., axis, axis] = 1.0
    out[..., first, first] = out[..., second, second] = cosine
    out[..., first, second], out[..., second, first] = -sine, sine
    return out


def _planted(figure: Figure, worlds: np.ndarray, places: np.ndarray, bearing: np.ndarray, motion: Motion) -> np.ndarray:
    """(T, 3) metres: shift of the body so that soles touch the floor, and the foot that bears it stays where it is."""
    soles = np.stack([_sole(figure, worlds, places, side) for side in ("left", "right")], axis=1)  # (T, 2, points, 3)
    lowest = soles[..., 2].min(axis=2)
    shift = np.zeros((len(worlds), 3))
    shift[:, 2] = -_smoothed(lowest.min(axis=1), width=0.02 * motion.rate)
    grip = np.exp(-(soles[..., 2] - lowest[..., None]) / 0.01)
    share = (bearing + 1e-6)[..., None] * grip / grip.sum(axis=2, keepdims=True)
    weight = share[1:] + share[:-1]
    steps = np.diff(soles[..., :2], axis=0)
    slide = (weight[..., None] * steps).sum(axis=(1, 2)) / weight.sum(axis=(1, 2))[:, None]
    # The legs alone would make the body surge twice a stride more than people do.
    speed = np.stack([_smoothed(column, width=SURGE * motion.rate) for column in slide.T], axis=1)
    shift[1:, :2] = -np.cumsum(speed, axis=0)
    shift[:, :2] += np.asarray(motion.place) - (places[:, 0] + shift)[len(shift) // 2, :2]
    return shift


def _sole(figure: Figure, worlds: np.ndarray, places: np.ndarray, side: str) -> np.ndarray:
    """(T, points, 3): heel, ball and tip of a shoe's sole; they stand for the mesh's lowest vertices."""
    shoes = np.flatnonzero(figure.labels == figure.label_names.index("shoes"))
    left = figure.vertices[shoes, 1] > 0
    own = figure.vertices[shoes[left if side == "left" else ~left]]
    foot, toes = figure.bone(f"{side}_foot"), figure.bone(f"{side}_toes")
    low = own[own[:, 2] < 0.025]
    ball = figure.heads[toes][0]
    heel, tip = low[np.argmin(low[:, 0])], low[np.argmax(low[:, 0])]
    middle = low[np.argmin(np.abs(low[:, 0] - ball) + low[:, 2])]
    points = []
    for point, bone in ((heel, foot), (middle, foot), (tip, toes)):
        reach = figure.to_neutral[bone] @ (point * (1, 1, 0) - figure.heads[bone])
        points.append(places[:, bone] + worlds[:, bone] @ reach)
    return np.stack(points, axis=1)


def _smoothed(values: np.ndarray, width: float) -> np.ndarray:
    """Gaussian running mean, so that the change of feet has no corner."""
    reach = max(1, int(np.ceil(3 * width)))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / max(width, 1e-6)) ** 2)
    padded = np.pad(values, reach, mode="edge")
    return np.convolve(padded, kernel / kernel.sum(), mode="valid")
