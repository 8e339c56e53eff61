"""The outer border of a silhouette as an ordered closed curve, and its Fourier descriptor (Du 2005, 5.2.3).

The border is followed pixel by pixel (Moore's neighbour tracing) from its topmost, there leftmost pixel: the fixed
start. A table over the 3 x 3 neighbourhood and the direction of arrival says where to go, so that a step has no
branches.
"""

from __future__ import annotations

import math

import numpy as np

from muybridge._kernels._jit import kernel
from muybridge._kernels.bits import popcount

SAMPLES = 256  # points after resampling
SIDE = 16  # SAMPLES = SIDE * SIDE: the transform works on a square, all of whose columns are vector lanes
LOG_SIDE = 4
#: Directions 0..7 clockwise on the screen from east: dx, dy.
DX = np.array([1, 1, 0, -1, -1, -1, 0, 1], np.int64)
DY = np.array([0, 1, 1, 1, 0, -1, -1, -1], np.int64)
_0, _1, _2, _3, _6, _7, _8 = (np.uint64(i) for i in (0, 1, 2, 3, 6, 7, 8))
_62, _63 = np.uint64(62), np.uint64(63)


def _next_directions() -> np.ndarray:
    """(512 * 8,) uint8: code of the neighbourhood * 8 + direction of the last step -> direction of the next; 8:
    nowhere.

    Bit 3 (dy + 1) + dx + 1 of the code is the neighbour at (dx, dy). The search runs clockwise from two steps
    anticlockwise of the last direction: what lies before that was found empty from the pixel before.
    """
    table = np.full((512, 8), 8, np.uint8)
    for code in range(512):
        for last in range(8):
            for turn in range(8):
                d = (last + 6 + turn) % 8
                if code >> (3 * (DY[d] + 1) + DX[d] + 1) & 1:
                    table[code, last] = d
                    break
    return table.reshape(-1)


NEXT = _next_directions()
#: The same with the step beside it: direction + 16 (dx + 1) + 64 (dy + 1); one look-up a step.
STEPS = np.array([d if d == 8 else d + 16 * (DX[d] + 1) + 64 * (DY[d] + 1) for d in NEXT.tolist()], np.int64)


def _twiddles() -> tuple[np.ndarray, np.ndarray]:
    """exp(-2 pi j n / SAMPLES) for n < SAMPLES, real and imaginary."""
    angle = -2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    return np.cos(angle), np.sin(angle)


COSINES, SINES = _twiddles()
REVERSED = np.array([int(f"{i:0{LOG_SIDE}b}"[::-1], 2) for i in range(SIDE)], np.int64)


@kernel
def neighbourhood(flat, rows, x, row):
    """The 3 x 3 bits round (x, row) of a canvas, row by row from the top left, as a number below 512.

    flat (words * rows,) uint64: the canvas; indices are unsigned, which spares the test for negative ones.
    """
    b = x & 63
    here = np.uint64((x >> 6) * rows + row)
    above, middle, below = flat[here - _1], flat[here], flat[here + _1]
    if 0 < b < 63:
        shift = np.uint64(b - 1)
        above, middle, below = above >> shift, middle >> shift, below >> shift
    elif b == 0:
        above, middle, below = above << _1, middle << _1, below << _1
        if x > 0:
            left = here - np.uint64(rows)
            above, middle, below = (
                above | (flat[left - _1] >> _63),
                middle | (flat[left] >> _63),
                below | (flat[left + _1] >> _63),
            )
    else:
        above, middle, below = above >> _62, middle >> _62, below >> _62
        right = here + np.uint64(rows)
        if right < np.uint64(flat.shape[0]):
            above, middle, below = (
                above | ((flat[right - _1] & _1) << _2),
                middle | ((flat[right] & _1) << _2),
                below | ((flat[right + _1] & _1) << _2),
            )
    return (above & _7) | ((middle & _7) << _3) | ((below & _7) << _6)


@kernel
def start_pixel(canvas, top, bottom):
    """The leftmost pixel of the topmost row, among rows [top, bottom) of the picture, that has one; (-1, -1) if
    none has.
    """
    for y in range(top, bottom):
        for w in range(canvas.shape[0]):
            word = canvas[w, y + 1]
            if word != _0:
                return (w << 6) + popcount(~word & (word - _1)), y
    return -1, -1


@kernel
def trace_border(canvas, x, y, xs, ys):
    """Follow the outer border from its start pixel, clockwise on the screen; returns its length and twice its signed
    area.

    canvas (words, rows) uint64 with empty spare rows; xs, ys int32 take the pixels. Stops when one place is left.
    """
    limit, rows = xs.shape[0] - 1, canvas.shape[1]
    flat = canvas.reshape(canvas.shape[0] * rows)
    xs[0], ys[0] = x, y
    first = STEPS[neighbourhood(flat, rows, x, y + 1) * _8]
    if first == 8:
        return 1, 0
    start_x, start_y, step = x, y, first
    count, area = 1, 0
    while True:
        dx, dy = ((step >> 4) & 3) - 1, (step >> 6) - 1
        area += x * dy - y * dx
        x, y = x + dx, y + dy
        step = STEPS[neighbourhood(flat, rows, x, y + 1) * _8 + np.uint64(step & 7)]
        if (x == start_x and y == start_y and step == first) or count == limit:
            return count, area
        xs[np.uint64(count)], ys[np.uint64(count)] = x, y
        count += 1


@kernel
def erase_component(canvas, xs, ys, count):
    """Clear the runs of pixels that begin on a traced border; what lies behind holes stays, smaller than what went."""
    words = canvas.shape[0]
    for i in range(count):
        x, row = xs[i], ys[i] + 1
        while x < words * 64 and (canvas[x >> 6, row] >> np.uint64(x & 63)) & _1 != _0:
            canvas[x >> 6, row] &= ~(_1 << np.uint64(x & 63))
            x += 1


@kernel
def trace_largest(canvas, top, bottom, pixels, spare, xs, ys):
    """Trace the component that encloses most, among rows [top, bottom); returns its border's length, 0 for an empty
    canvas.

    `pixels` is how many the canvas holds. Nearly always the topmost component has more than half of them and is the
    answer; otherwise it is erased from the copy `spare` and the next one is tried.
    """
    x, y = start_pixel(canvas, top, bottom)
    if x < 0:
        return 0
    count, area = trace_border(canvas, x, y, xs, ys)
    if area + count + 2 >= pixels:  # Pick: area / 2 + count / 2 + 1 pixels lie on or inside the border
        return count
    spare[:] = canvas
    best_x, best_y, best = x, y, area + count
    while x >= 0:
        erase_component(spare, xs, ys, count)
        x, y = start_pixel(spare, top, bottom)
        if x >= 0:
            count, area = trace_border(spare, x, y, xs, ys)
            if area + count > best:
                best_x, best_y, best = x, y, area + count
    return trace_border(canvas, best_x, best_y, xs, ys)[0]


@kernel
def resample_closed(xs, ys, count, real, imaginary):
    """SAMPLES points at equal steps along a closed curve of `count` pixels, linear between them, from its start.

    xs, ys have room for one more: the first pixel is repeated there.
    """
    xs[count], ys[count] = xs[0], ys[0]
    step = count / SAMPLES
    for i in range(SAMPLES):
        place = i * step
        j = np.uint64(place)
        part = place - np.float64(j)
        real[i] = (1.0 - part) * xs[j] + part * xs[j + _1]
        imaginary[i] = (1.0 - part) * ys[j] + part * ys[j + _1]


@kernel
def column_transforms(real, imaginary):
    """Radix-2 Fourier transforms down all columns of a (SIDE, SIDE) array at once, in place, output in reversed
    order.
    """
    half = SIDE >> 1
    while half >= 1:
        stride = SAMPLES // (2 * half)
        for start in range(0, SIDE, 2 * half):
            for i in range(half):
                c, s = COSINES[i * stride], SINES[i * stride]
                ar, ai = real[start + i], imaginary[start + i]
                br, bi = real[start + i + half], imaginary[start + i + half]
                for lane in range(SIDE):
                    dr, di = ar[lane] - br[lane], ai[lane] - bi[lane]
                    ar[lane], ai[lane] = ar[lane] + br[lane], ai[lane] + bi[lane]
                    br[lane], bi[lane] = dr * c - di * s, dr * s + di * c
        half >>= 1


@kernel
def fourier_descriptor(real, imaginary, work_real, work_imaginary):
    """DFT / SAMPLES, (5.10), of a curve held as (SIDE, SIDE) arrays; the result lies in `real`, `imaginary` in order.

    n = SIDE a + b, f = c + SIDE d: transforms over a for every b, a turn by exp(-2 pi j b c / SAMPLES), transforms
    over b for every c. Both times the other index is the vector lane.
    """
    column_transforms(real, imaginary)
    for i in range(SIDE):
        c = REVERSED[i]
        for b in range(SIDE):
            cosine, sine = COSINES[(b * c) % SAMPLES] / SAMPLES, SINES[(b * c) % SAMPLES] / SAMPLES
            work_real[b, c] = real[i, b] * cosine - imaginary[i, b] * sine
            work_imaginary[b, c] = real[i, b] * sine + imaginary[i, b] * cosine
    column_transforms(work_real, work_imaginary)
    for i in range(SIDE):
        for c in range(SIDE):
            real[REVERSED[i], c] = work_real[i, c]
            imaginary[REVERSED[i], c] = work_imaginary[i, c]


@kernel
def descriptor_distance(real, imaginary, reference_real, reference_imaginary, coefficients):
    """Euclidean distance, pixels, between the lowest `coefficients` frequencies of two descriptors (SIDE, SIDE).

    Frequencies run from -coefficients / 2 to coefficients / 2 - 1, modulo SAMPLES.
    """
    total = 0.0
    for i in range(coefficients):
        f = i - coefficients // 2
        f = f if f >= 0 else f + SAMPLES
        r, c = f // SIDE, f % SIDE
        dr, di = real[r, c] - reference_real[r, c], imaginary[r, c] - reference_imaginary[r, c]
        total += dr * dr + di * di
    return math.sqrt(total)
