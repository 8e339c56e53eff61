"""The experiments of Du (2005), chapter 7, on scenes whose truth is known.

"Articulated human motion tracking with the DE-MC particle filter", thesis. `papers/du-2005/README.md` holds its claims
against our numbers.

| module | what |
|---|---|
| `conditions` | the filters as printed and as they work, at the thesis' shapes and at any budget |
| `budgets` | E1, error against evaluations, from printed to working, coverage |
| `settings` | E2 (layers), one setting at a time, and how far each search climbs |
| `cues` | E3 (cues), E4 (colour weights) |
| `robustness` | faults one at a time; what the product reaches |
| `pictures` | Figs. 5.3, 5.4 and 7.7 |
"""

from muybridge.experiments.du_2005.budgets import COVERAGE, CURVES, E1, PRINTED
from muybridge.experiments.du_2005.cues import E3, E4
from muybridge.experiments.du_2005.pictures import ANGLES, DESCRIPTORS, SURFACE
from muybridge.experiments.du_2005.robustness import MATTERS, REACH
from muybridge.experiments.du_2005.settings import CHOICE, E2, SEARCH
from muybridge.experiments.experiment import Experiment

EXPERIMENT = Experiment(
    "du-2005",
    "Du (2005), DE-MC particle filter",
    (REACH, E1, CURVES, PRINTED, E2, E3, E4, CHOICE, SEARCH, COVERAGE, MATTERS, SURFACE, DESCRIPTORS, ANGLES),
)

__all__ = ["EXPERIMENT"]
