"""One person in 3D: from calibrated pictures to joints with error bars.

====================  ==================================================================
Tracker               body + rig + settings; `init`, `step`: the loop over frames is yours
automatic_start       the first pose from one frame's masks
fit_body              the body's measures, and the cameras' shifts, from several frames
run                   a whole job: pictures in, a run folder out
====================  ==================================================================
"""

from muybridge.tracking.fit import Fit, FitConfig, fit_body
from muybridge.tracking.run import RunSummary, run
from muybridge.tracking.start import Start, StartConfig, automatic_start
from muybridge.tracking.tracker import Estimate, Tracker, TrackerConfig, TrackState

__all__ = [
    "Estimate",
    "Fit",
    "FitConfig",
    "RunSummary",
    "Start",
    "StartConfig",
    "TrackState",
    "Tracker",
    "TrackerConfig",
    "automatic_start",
    "fit_body",
    "run",
]
