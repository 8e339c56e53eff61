"""`muybridge train TRAIN.toml`."""

from __future__ import annotations

from pathlib import Path

from muybridge.cli.reporting import DEFAULT_REPORTING, Reporting
from muybridge.cli.track import Overrides


def train(
    training: Path,
    /,
    *,
    out: Path = Path("model.npz"),
    seed: int | None = None,
    workers: int | None = None,
    set_: Overrides = None,
    reporting: Reporting = DEFAULT_REPORTING,
) -> None:
    """Learn to guess poses from silhouettes, from scenes and recordings whose poses are known.

    Parameters
    ----------
    training
        What is learnt from, a TOML file; see docs/train.md.
    out
        The model, one file; replaced only when the new one is whole.
    seed
        Wins over the file's seed.
    workers
        Threads; one for each core where absent. The model does not depend on it.
    set_
        One setting of the file, KEY=VALUE, such as held_out=0.3; may be repeated.
    """
    import os
    import time

    from muybridge.io.training_file import read
    from muybridge.regression import save_regressor
    from muybridge.tracking.training import train as learn

    overrides = [*(set_ or []), *([] if seed is None else [f"seed={seed}"])]
    asked = read(training, overrides)
    if workers is None:
        workers = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    out.parent.mkdir(parents=True, exist_ok=True)
    began = time.perf_counter()
    try:
        with reporting.progress("clips") as progress:
            trained = learn(asked, workers=workers, progress=progress)
    except KeyboardInterrupt:
        raise KeyboardInterrupt("interrupted while training; nothing was written") from None
    save_regressor(out, trained.regressor)
    seconds = time.perf_counter() - began
    calibration = trained.calibration
    reporting.say(f"{trained.examples} silhouettes of {trained.clips} clips learnt in {seconds:.0f} s; {out}")
    reporting.say(f"held out: {calibration.describe()}")
    reporting.finish(
        {
            "out": out,
            "body": trained.regressor.body,
            "examples": trained.examples,
            "clips": trained.clips,
            "clusters": len(trained.regressor.clusters),
            "trusted_variance": calibration.trusted_variance,
            "good_share": float(calibration.good.mean()),
            "seconds": seconds,
        }
    )
