"""Several people before one fixed colour camera (Zhao, 2009): table of contents.

| module | what | paper |
|---|---|---|
| `histograms` | bins fitted to the target, cumulative histogram maps | 4.2.1, 4.3 |
| `box` | a box's state and motion, how many particles it needs | 4.1, 4.4 |
| `colour_likelihood` | near the target's colours, far from the background's | 4.2 |
| `nummiaro` | the likelihood it is compared with | 6.2 |
| `masks`, `things`, `blobs` | the foreground, what stands in it and is nobody, regions of one person each | 5.1 |
| `parts`, `part_filters` | head, torso, hip-leg: cut, and followed one by one | 5.2 |
| `arrangement` | the three as one state on the body | ch. 7 |
| `failure`, `repair` | parts that went astray: told, and placed anew | 5.3, 5.4 |
| `ground`, `ground_fit`, `silhouette`, `occluders`, `scene` | what the clip tells before people are followed | ours |
| `evidence`, `detect` | what foreground says about boxes, and where somebody new is | ours |
| `appearance` | what somebody looks like from head to foot, and whose a pixel is | ours |
| `identity` | who is who after people met | ours |
| `down` | who crouches, bends or lies, and how large their box then is | ours |
| `filtered`, `person`, `tracker` | one box, one person, all of them | ch. 4, 5 |
| `tracks`, `run` | what comes out; a video from end to end | |
| `on_ground` | where people stand on the floor, of a calibrated camera | |

The particle filter is `filters.condensation`, as for everything else.
"""

from muybridge.people.run import PeopleConfig, PeopleSummary, look_over, run
from muybridge.people.scene import Scene, describe
from muybridge.people.tracker import PeopleTracker, TrackerConfig
from muybridge.people.tracks import Tracks

__all__ = [
    "PeopleConfig",
    "PeopleSummary",
    "PeopleTracker",
    "Scene",
    "TrackerConfig",
    "Tracks",
    "describe",
    "look_over",
    "run",
]
