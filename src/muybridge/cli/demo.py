"""`muybridge demo`."""

from __future__ import annotations

from pathlib import Path

from muybridge.cli.reporting import DEFAULT_REPORTING, Reporting
from muybridge.cli.track import Overrides


def demo(
    *,
    out: Path = Path("runs/demo"),
    seed: int = 1,
    set_: Overrides = None,
    overlay: bool = True,
    reporting: Reporting = DEFAULT_REPORTING,
) -> int:
    """Render a scene with known truth, track it, and say how far off the track is.

    Parameters
    ----------
    out
        The run folder; the scene goes into scene/ inside.
    seed
        Of the scene (what is worn, how it walks, the noise) and of the tracking.
    set_
        One setting of the job, KEY=VALUE, such as filter.name=annealed; may be repeated.
    overlay
        Draw the run over the pictures of each camera.
    """
    from muybridge.cli.track import run_and_tell
    from muybridge.io.job import check_settings, read
    from muybridge.synthetic.scene import demo_scene
    from muybridge.synthetic.write import write_scene

    try:
        with reporting.progress("render") as progress:
            path = write_scene(demo_scene(seed), out / "scene", progress=progress)
    except KeyboardInterrupt:
        raise KeyboardInterrupt("interrupted while rendering the scene; nothing was tracked yet") from None
    job = read(path, [*(set_ or []), f"seed={seed}"])
    check_settings(job)
    return run_and_tell(job, out, reporting, overlay=overlay)
