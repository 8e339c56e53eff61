"""How far estimates are from the truth.

| module | what |
|---|---|
| `alignment` | none, root, rigid, similarity: what is forgiven before distances are taken |
| `joints` | errors per joint and frame, and the events a mean hides |
| `calibration` | whether stated standard deviations are true |
| `matching` | frames and joints two series share |
| `angles` | joint angles from joint positions |
| `truth` | joints.csv, truth_joints.csv, TRC markers |
| `names` | the 15 joints, and what other files call them |
| `boxes` | several people's boxes: HOTA, MOTA, IDF1 |
| `run` | `evaluate(run, truth)` |
"""

from muybridge.evaluation.alignment import ALIGNMENTS, align
from muybridge.evaluation.joints import JointErrors, JointStatistics, joint_errors
from muybridge.evaluation.matching import Overlap, match
from muybridge.evaluation.names import JOINTS
from muybridge.evaluation.run import evaluate
from muybridge.evaluation.truth import read_truth

__all__ = [
    "ALIGNMENTS",
    "JOINTS",
    "JointErrors",
    "JointStatistics",
    "Overlap",
    "align",
    "evaluate",
    "joint_errors",
    "match",
    "read_truth",
]
