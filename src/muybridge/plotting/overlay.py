"""The estimate drawn over the picture: limb outlines, joints, the circles of their uncertainty; and sheets of such
pictures.

These work on pictures, (H, W, 3) uint8 BGR, not on axes, since they also make the frames of overlay videos.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from muybridge.errors import InputError
from muybridge.plotting.style import DARK, bgr, side_of

SIDE_COLOURS = {"left": bgr(DARK.left), "right": bgr(DARK.right), "": (235, 235, 235)}
"""BGR colours of the sides. Pictures are mostly dark and busy, so the bright ones serve both themes."""
SUBPIXEL_BITS = 4
SHADOW = (20, 20, 20)


def draw_limbs(
    image: np.ndarray,
    outlines: Sequence[np.ndarray],
    names: Sequence[str],
    *,
    fill: float = 0.22,
    thickness: int | None = None,
) -> np.ndarray:
    """Outlines of the projected segments over a picture.

    Parameters
    ----------
    image : (H, W, 3) uint8, BGR
    outlines : S arrays (K, 2) float64, pixels
        One polygon a segment, drawn in this order; with a NaN or fewer than 3 corners it is left out.
    names : S str
        Segment names or sides: what begins with left or right has that side's colour.
    fill : float
        How much of the colour lies over the inside, 0 to 1.
    thickness : int, pixels, optional
        Default: 1 per 400 pixels of height, at least 1.

    Returns
    -------
    (H, W, 3) uint8, BGR
        A new picture.
    """
    import cv2

    _check_picture(image)
    thickness = thickness or line_width(image)
    drawn = [
        (np.rint(_bounded(outline) * 2**SUBPIXEL_BITS).astype(np.int32), SIDE_COLOURS[side_of(name)])
        for outline, name in zip(outlines, names, strict=True)
        if len(outline) >= 3 and np.isfinite(outline).all()
    ]
    tinted = image.copy()
    for polygon, colour in drawn:
        cv2.fillPoly(tinted, [polygon], colour, cv2.LINE_AA, SUBPIXEL_BITS)
    result = cv2.addWeighted(image, 1.0 - fill, tinted, fill, 0.0)
    for extra, shade in ((2, True), (0, False)):
        for polygon, colour in drawn:
            cv2.polylines(
                result, [polygon], True, SHADOW if shade else colour, thickness + extra, cv2.LINE_AA, SUBPIXEL_BITS
            )
    return result


def draw_joints(
    image: np.ndarray, pixels: np.ndarray, names: Sequence[str], deviations_px: np.ndarray | None = None
) -> np.ndarray:
    """Joints as dots, and the circle of two standard deviations around each.

    Parameters
    ----------
    image : (H, W, 3) uint8, BGR
    pixels : (J, 2) float64
        NaN is left out.
    names : J str
    deviations_px : (J,) float64, pixels, optional

    Returns
    -------
    (H, W, 3) uint8, BGR
        A new picture.
    """
    import cv2

    _check_picture(image)
    result, one, width = image.copy(), 2**SUBPIXEL_BITS, line_width(image)
    for j, (pixel, name) in enumerate(zip(pixels, names, strict=True)):
        if not np.isfinite(pixel).all():
            continue
        x, y = (int(value) for value in np.rint(_bounded(pixel) * one))
        colour = SIDE_COLOURS[side_of(name)]
        if deviations_px is not None and np.isfinite(deviations_px[j]):
            radius = int(min(2 * deviations_px[j], 4 * max(image.shape)) * one)
            cv2.circle(result, (x, y), radius, colour, width, cv2.LINE_AA, SUBPIXEL_BITS)
        cv2.circle(result, (x, y), (2 * width + 2) * one, SHADOW, -1, cv2.LINE_AA, SUBPIXEL_BITS)
        cv2.circle(result, (x, y), (2 * width + 1) * one, colour, -1, cv2.LINE_AA, SUBPIXEL_BITS)
    return result


def draw_label(image: np.ndarray, text: str) -> np.ndarray:
    """A line of text on a dark strip in the upper left corner; a new picture."""
    import cv2

    _check_picture(image)
    result, scale = image.copy(), max(0.5, image.shape[0] / 1100)
    width = max(1, round(1.6 * scale))
    (text_width, height), below = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, scale, width)
    strip = result[: height + below + 10, : text_width + 16]
    strip[:] = strip // 4
    cv2.putText(result, text, (8, height + 6), cv2.FONT_HERSHEY_SIMPLEX, scale, (240, 240, 240), width, cv2.LINE_AA)
    return result


def contact_sheet(
    images: Sequence[np.ndarray], labels: Sequence[str] = (), *, columns: int = 4, width: int = 1600, gap: int = 6
) -> np.ndarray:
    """Pictures side by side in rows, all at one size.

    Parameters
    ----------
    images : sequence of (H, W, 3) uint8, BGR
        Each keeps its proportions inside a cell of the first one's.
    labels : sequence of str
        One a picture, or none.
    columns : int
    width : int, pixels
        Of the whole sheet.
    gap : int, pixels

    Returns
    -------
    (H', width, 3) uint8, BGR
    """
    if not images or (labels and len(labels) != len(images)):
        raise InputError(
            "contact sheet", expected="pictures, and a label for each or none", got=f"{len(images)} and {len(labels)}"
        )
    columns = min(columns, len(images))
    cell_width = (width - gap * (columns - 1)) // columns
    cell_height = max(1, round(cell_width * images[0].shape[0] / images[0].shape[1]))
    rows = -(-len(images) // columns)
    sheet = np.full((rows * cell_height + (rows - 1) * gap, width, 3), bgr(DARK.surface), np.uint8)
    for n, image in enumerate(images):
        cell = _fit(image, cell_width, cell_height)
        cell = draw_label(cell, labels[n]) if labels else cell
        y, x = (n // columns) * (cell_height + gap), (n % columns) * (cell_width + gap)
        sheet[y : y + cell_height, x : x + cell_width] = cell
    return sheet


def line_width(image: np.ndarray) -> int:
    """Width of lines in pixels, in proportion to the picture."""
    return max(1, round(image.shape[0] / 400))


def _fit(image: np.ndarray, width: int, height: int) -> np.ndarray:
    """The whole picture in a cell, its proportions kept."""
    import cv2

    _check_picture(image)
    scale = min(width / image.shape[1], height / image.shape[0])
    size = (max(1, min(width, round(image.shape[1] * scale))), max(1, min(height, round(image.shape[0] * scale))))
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)
    cell = np.full((height, width, 3), bgr(DARK.surface), np.uint8)
    y, x = (height - size[1]) // 2, (width - size[0]) // 2
    cell[y : y + size[1], x : x + size[0]] = small
    return cell


def _bounded(points: np.ndarray) -> np.ndarray:
    """Points far outside every picture, brought to where the drawing's integers still hold them."""
    return np.clip(points, -30_000.0, 30_000.0)


def _check_picture(image: np.ndarray) -> None:
    if image.ndim != 3 or image.shape[2] != 3 or image.dtype != np.uint8:
        raise InputError("picture to draw on", expected="(H, W, 3) uint8", got=f"{image.shape} {image.dtype}")
