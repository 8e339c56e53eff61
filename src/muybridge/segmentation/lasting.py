"""The empty scene from moments of a clip, where somebody stood in one place for much of it.

A median takes for empty what is seen most often, and so learns whoever stands for half of the time. But who came and
went was neither there before nor after, and the floor was. So each pixel takes the colour that lasts: the share of the
clip between the first time it is seen and the last, plus a quarter of the share of moments that show it. The latter
decides where several are seen from beginning to end: the floor, and clothes of one colour that pass early and late.
What came after the beginning and went before the end counts half: before a door that opens meanwhile, neither look of
it lasts as long as somebody who lingers there.

What changes and never changes back (that door) is learnt as it is for the longer time; so is somebody who stays until
the end, or was there from the beginning.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.lasting import over_rows_lasting
from muybridge.errors import InputError
from muybridge.segmentation.pictures import median_picture

TOLERANCE = 14
"""Grey values, in each channel: four to five deviations of a sensor's noise."""
FEWEST = 3  # moments that show a colour; fewer are chance
OFTEN = 0.25  # weight of how often against how long: who stays for up to five sixths of the time is not learnt
PASSING = 0.5  # of that counts for what came after the beginning and went before the end, as somebody who lingers
TRIED = 20  # colours a pixel, evenly spread over the moments
ENOUGH = 8  # moments; of fewer there is only a median


def lasting_picture(pictures: Sequence[NDArray[np.uint8]], *, ended: bool = True) -> NDArray[np.uint8]:
    """(H, W, C) uint8: the median of the moments that show what lasts, from pictures (H, W, C) in the order of time.

    ended : whether the last is the end of a clip; in a stream, who came and is still there may go yet
    """
    if len(pictures) < ENOUGH:
        return median_picture(pictures)
    if len({picture.shape for picture in pictures}) > 1:
        raise InputError("background pictures", expected="one size", got="several sizes")
    pixels = np.stack(pictures, axis=2)
    shown = np.zeros(pixels.shape[:3], np.bool_)
    over_rows_lasting(pixels, -(-len(pictures) // TRIED), TOLERANCE, FEWEST, OFTEN, PASSING, ended, shown)
    return median_picture(pictures, list(np.moveaxis(shown, 2, 0)))
