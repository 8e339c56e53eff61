"""`muybridge synth SCENE.toml`."""

from __future__ import annotations

from pathlib import Path

from muybridge.cli.reporting import DEFAULT_REPORTING, Reporting
from muybridge.cli.track import Overrides


def synth(
    scene: Path,
    /,
    *,
    out: Path | None = None,
    seed: int | None = None,
    set_: Overrides = None,
    reporting: Reporting = DEFAULT_REPORTING,
) -> None:
    """Render a scene with known truth into a folder that `track`, or `people`, takes.

    Parameters
    ----------
    scene
        The scene, a TOML file; see docs/scenes.md.
    out
        Where the folder is made; scenes/NAME where absent. An earlier scene there is replaced.
    seed
        Wins over the scene's seed.
    set_
        One setting of the scene, KEY=VALUE, such as sensor.quality=30; may be repeated.
    """
    from muybridge.synthetic.scene_file import read
    from muybridge.synthetic.write import check_replaceable, write_scene

    overrides = [*(set_ or []), *([] if seed is None else [f"seed={seed}"])]
    described = read(scene, overrides)
    out = out or Path("scenes") / scene.stem
    check_replaceable(out)
    try:
        with reporting.progress("render") as progress:
            made = write_scene(described, out, progress=progress)
    except KeyboardInterrupt:
        raise KeyboardInterrupt("interrupted while rendering; nothing was written") from None
    next_ = "people" if described.follow == "people" else "track"
    reporting.say(f"{described.frame_count} frames of {len(described.rig)} cameras in {out}; muybridge {next_} {made}")
    reporting.finish(
        {
            "out": out,
            **({"video": made} if described.follow == "people" else {"job": made}),
            "frames": described.frame_count,
            "cameras": list(described.rig.names),
            "rate": described.rate,
            "seed": described.seed,
            "figure": described.person.figure,
        }
    )
