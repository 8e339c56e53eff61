"""Joint angles over time, as tables of normal gait give them, and the rotations of a figure's bones they make."""

from __future__ import annotations

import numpy as np

from muybridge.synthetic.skinning import Figure

#: bone -> (T, 3) degrees: flexion forward, abduction outward, turn to the left
Angles = dict[str, np.ndarray]


def add(
    angles: Angles,
    bone: str,
    flexion: np.ndarray | float = 0.0,
    abduction: np.ndarray | float = 0.0,
    turn: np.ndarray | float = 0.0,
) -> None:
    """Add degrees to a bone's angles."""
    added = np.stack(np.broadcast_arrays(flexion, abduction, turn), axis=-1)
    angles[bone] = angles[bone] + added if bone in angles else added


def periodic(table: tuple[float, ...], phase: np.ndarray) -> np.ndarray:
    """Smooth periodic curve through equally spaced values: its Fourier series."""
    spectrum = np.fft.rfft(table) / len(table)
    spectrum[1:] *= 2.0
    if len(table) % 2 == 0:
        spectrum[-1] *= 0.5
    harmonics = np.exp(2j * np.pi * np.outer(phase, np.arange(len(spectrum))))
    return (harmonics @ spectrum).real


def smooth_step(x: np.ndarray) -> np.ndarray:
    """0 to 1 over [0, 1] with no corner."""
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def rotations(figure: Figure, angles: Angles, heading: np.ndarray) -> np.ndarray:
    """(T, B, 3, 3): turn, then abduction, then flexion of each bone in its parent; the root also has the heading."""
    local = np.tile(np.eye(3), (len(heading), len(figure.bone_names), 1, 1))
    for name, degrees in angles.items():
        flexion, abduction, turn = np.radians(np.broadcast_to(degrees, (len(heading), 3))).T
        outward = abduction if not name.startswith("right_") else -abduction
        local[:, figure.bone(name)] = about(2, turn) @ about(0, outward) @ about(1, -flexion)
    local[:, 0] = about(2, heading) @ local[:, 0]
    return local


def about(axis: int, angle: np.ndarray) -> np.ndarray:
    """(T, 3, 3): right-handed turns about a coordinate axis."""
    cosine, sine = np.cos(angle), np.sin(angle)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    out = np.zeros((*np.shape(angle), 3, 3))
    out[..., axis, axis] = 1.0
    out[..., first, first] = out[..., second, second] = cosine
    out[..., first, second], out[..., second, first] = -sine, sine
    return out
