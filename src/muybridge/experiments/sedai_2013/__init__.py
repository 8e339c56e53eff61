"""The experiments of Sedai, Bennamoun and Huynh (2013), section V, on rendered people who were not learnt from.

"A Gaussian process guided particle filter for tracking 3D human pose in video", IEEE Transactions on Image Processing
22(11). `papers/sedai-2013/README.md` holds its claims against our numbers.

| module | what |
|---|---|
| `conditions` | who is learnt from and who is tracked; the filters, printed and working |
| `guessing` | the regressor by itself: Table III, Figs. 8, 9, 13 |
| `tracking` | Table IV, Figs. 10 and 14, recovery |
| `facing` | which way a person before one camera is thought to face |
"""

from muybridge.experiments.experiment import Experiment
from muybridge.experiments.sedai_2013.conditions import prepare, scale_of
from muybridge.experiments.sedai_2013.facing import FACING
from muybridge.experiments.sedai_2013.guessing import ALPHA, GATES, MODES
from muybridge.experiments.sedai_2013.tracking import ANGLES, CURVE, PRINTED, RECOVERY, TABLE4

EXPERIMENT = Experiment(
    "sedai-2013",
    "Sedai et al. (2013), AGP-PF",
    (TABLE4, PRINTED, GATES, ALPHA, MODES, CURVE, RECOVERY, ANGLES, FACING),
    scale=scale_of,
    prepare=prepare,
)

__all__ = ["EXPERIMENT"]
