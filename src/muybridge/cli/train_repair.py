"""`muybridge train-repair`."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

from muybridge.cli.reporting import DEFAULT_REPORTING, Reporting
from muybridge.cli.track import Overrides


def train_repair(
    *,
    out: Path = Path("repair.npz"),
    seed: int = 0,
    set_: Overrides = None,
    reporting: Reporting = DEFAULT_REPORTING,
) -> None:
    """Learn to tell when a part of a person was lost, from rendered people who are followed by colours alone.

    Parameters
    ----------
    out
        The machines, one file, for `people --set repair=FILE`; replaced only when the new one is whole.
    seed
        Of the scenes and the tracker.
    set_
        One setting, KEY=VALUE, such as scenes=8 or false_alarms=0.005; may be repeated.
    """
    import time

    from muybridge.people.failure import save_detector
    from muybridge.people.repair_training import RepairTraining
    from muybridge.people.repair_training import train_repair as learn

    config = RepairTraining().with_settings(set_ or [])
    out.parent.mkdir(parents=True, exist_ok=True)
    began = time.perf_counter()
    try:
        with reporting.progress("scenes") as progress:
            detector, judged = learn(config, seed=seed, progress=progress)
    except KeyboardInterrupt:
        raise KeyboardInterrupt("interrupted while training; nothing was written") from None
    save_detector(out, detector, {"seed": seed, "settings": asdict(config), "judged": [asdict(one) for one in judged]})
    for one in judged:
        reporting.say(one.describe())
    reporting.say(f"learnt in {time.perf_counter() - began:.0f} s; {out}")
    reporting.finish({"out": out, "seed": seed, "judged": [asdict(one) for one in judged]})
