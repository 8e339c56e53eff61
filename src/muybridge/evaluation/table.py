"""Errors as a table in plain text."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from muybridge.evaluation.joints import JointErrors


def error_table(result: JointErrors) -> str:
    """One line a joint, then the whole, then the events that a mean hides."""
    lines = [
        f"joint errors in mm, alignment {result.alignment}",
        result.overlap.describe() + (f"; {result.missing} joints missing" if result.missing else ""),
        "",
        f"{'joint':<16}{'mean':>8}{'median':>8}{'p95':>8}{'worst':>8}{'frame':>7}   bias x, y, z",
    ]
    for joint in result.joints:
        bias = "".join(f"{value:z7.0f}" for value in joint.bias_mm)
        lines.append(
            f"{joint.joint:<16}{joint.mean_mm:8.1f}{joint.median_mm:8.1f}{joint.p95_mm:8.1f}"
            f"{joint.worst_mm:8.1f}{joint.worst_frame:7d}  {bias}"
        )
    lines += [
        f"{'all':<16}{result.mean_mm:8.1f}{result.median_mm:8.1f}{result.p95_mm:8.1f}{result.worst_joint_mm:8.1f}",
        "",
        f"worst frame     {result.worst_frame} with {result.worst_frame_mm:.1f} mm",
        f"lost frames     {result.lost_share:.1%} (mean above 200 mm)",
    ]
    if result.lost_wrists:
        wrists = ", ".join(f"{name.replace('_', ' ')} {share:.1%}" for name, share in result.lost_wrists.items())
        lines.append(f"lost wrists     {wrists} of frames (above 200 mm)")
    lines.append(f"legs swapped    {len(result.swapped_frames)} frames" + _listed(result.swapped_frames))
    if result.calibration:
        lines.append(f"uncertainty     {result.calibration.describe()}")
    return "\n".join(lines)


def _listed(frames: tuple[int, ...], most: int = 8) -> str:
    if not frames:
        return ""
    return f" ({', '.join(map(str, frames[:most]))}{', ...' if len(frames) > most else ''})"
