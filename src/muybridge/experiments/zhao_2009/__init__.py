"""The experiments of Zhao (2009), chapter 6, on rendered surveillance clips whose truth is known.

"Multi-part tracking of people in surveillance video", dissertation. `papers/zhao-2009/README.md` holds its claims
against our numbers.

| module | what |
|---|---|
| `conditions` | how much is run, and what kinds of trials share |
| `hall` | clips of a hall: nothing happens, the light goes, a door opens, somebody stays |
| `subtraction`, `roc` | background models on them: one trial; ROC curves, tables, pictures |
| `speed` | background models, frames a second |
| `people_clips` | rendered clips, and the trials that look at them |
| `tracking` | one box a person by colour, against Nummiaro's: Tables 1 to 4 |
| `parts` | parts with and without repair: Fig. 6.15; boxes mistaken for parts |
"""

from muybridge.experiments.experiment import Experiment
from muybridge.experiments.zhao_2009.conditions import amount_of
from muybridge.experiments.zhao_2009.parts import ALARMS, HARD_RATES, RATES
from muybridge.experiments.zhao_2009.roc import PICTURES, ROC
from muybridge.experiments.zhao_2009.speed import SPEED
from muybridge.experiments.zhao_2009.tracking import BOXES

EXPERIMENT = Experiment(
    "zhao-2009",
    "Zhao (2009), multi-part tracking in surveillance video",
    (ROC, PICTURES, SPEED, BOXES, ALARMS, RATES, HARD_RATES),
    scale=amount_of,
)

__all__ = ["EXPERIMENT"]
