"""What people look at. Functions take `ax`, return artists, and never show anything.

| module | what |
|---|---|
| `style` | the one look: `LIGHT`, `DARK`, `new_figure`, `to_png`, `to_svg` |
| `angles` | joint angles over time with their error bands |
| `errors` | error per joint, error over time |
| `diagnostics` | effective sample size and acceptance |
| `path` | where somebody went, from above |
| `overlay` | limbs, joints and uncertainty over pictures; contact sheets |
"""

from muybridge.plotting.angles import plot_joint_angles
from muybridge.plotting.diagnostics import plot_acceptance, plot_effective_sample_size
from muybridge.plotting.errors import plot_error_over_time, plot_joint_errors
from muybridge.plotting.overlay import contact_sheet, draw_joints, draw_label, draw_limbs
from muybridge.plotting.path import plot_top_view
from muybridge.plotting.style import DARK, LIGHT, Theme, new_figure, styled, to_png, to_svg

__all__ = [
    "DARK",
    "LIGHT",
    "Theme",
    "contact_sheet",
    "draw_joints",
    "draw_label",
    "draw_limbs",
    "new_figure",
    "plot_acceptance",
    "plot_effective_sample_size",
    "plot_error_over_time",
    "plot_joint_angles",
    "plot_joint_errors",
    "plot_top_view",
    "styled",
    "to_png",
    "to_svg",
]
