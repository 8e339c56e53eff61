"""The outer border of a silhouette as an ordered closed curve, and its Fourier descriptor (Du 2005, 5.2.3).

The border is followed pixel by pixel (Moore's neighbour tracing) from its topmost, there leftmost pixel: the fixed start. A
table over the 3 x 3 neighbourhood and the direction of arrival says where to go, so that a step has no branches.
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
_0, _1, _3, _7, _62, _63 = np.uint64(0), np.uint64(1), np.uint64(3), np.uint64(7), np.uint64(62), np.uint64(63)


def _next_directions() -> np.ndarray:
    """(512 * 8,) uint8: code of the neighbourhood * 8 + direction of the last step -> direction of the next; 8: nowhere.

    Bit 3 (dy + 1) + dx + 1 of the code is the neighbour at (dx, dy). The search runs clockwise from two steps anticlockwise of
    the last direction: what lies before that was found empty from the pixel before.
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


def _twiddles() -> tuple[np.ndarray, np.ndarray]:
    """exp(-2 pi j n / SAMPLES) for n < SAMPLES, real and imaginary."""
    angle = -2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    return np.cos(angle), np.sin(angle)


COSINES, SINES = _twiddles()
REVERSED = np.array([int(f"{i:0{LOG_SIDE}b}"[::-1], 2) for i in range(SIDE)], np.int64)


@kernel
def neighbourhood(canvas, x, row):
    """The 3 x 3 bits round (x, row) of a canvas (words, rows), row by row from the top left, as a number below 512."""
    w, b = x >> 6, x & 63
    if 0 < b < 63:
        shift = np.uint64(b - 1)
        above, here, below = canvas[w, row - 1] >> shift, canvas[w, row] >> shift, canvas[w, row + 1] >> shift
    elif b == 0:
        above, here, below = canvas[w, row - 1] << _1, canvas[w, row] << _1, canvas[w, row + 1] << _1
        if w > 0:
            above |= canvas[w - 1, row - 1] >> _63
            here |= canvas[w - 1, row] >> _63
            below |= canvas[w - 1, row + 1] >> _63
    else:
        above, here, below = canvas[w, row - 1] >> _62, canvas[w, row] >> _62, canvas[w, row + 1] >> _62
        if w + 1 < canvas.shape[0]:
            above |= (canvas[w + 1, row - 1] & _1) << np.uint64(2)
            here |= (canvas[w + 1, row] & _1) << np.uint64(2)
            below |= (canvas[w + 1, row + 1] & _1) << np.uint64(2)
    return np.int64((above & _7) | ((here & _7) << np.uint64(3)) | ((below & _7) << np.uint64(6)))


@kernel
def start_pixel(canvas, top, bottom):
    """The leftmost pixel of the topmost row, among rows [top, bottom) of the picture, that has one; (-1, -1) if none has."""
    for y in range(top, bottom):
        for w in range(canvas.shape[0]):
            word = canvas[w, y + 1]
            if word != _0:
                return (w << 6) + popcount(~word & (word - _1)), y
    return -1, -1


@kernel
def trace_border(canvas, x, y, xs, ys):
    """Follow the outer border from its start pixel, clockwise on the screen; returns its length and twice its signed area.

    canvas (words, H + 2) uint64 with empty spare rows; xs, ys int32 take the pixels. Stops when full.
    """
    limit = xs.shape[0]
    direction = np.int64(NEXT[neighbourhood(canvas, x, y + 1) * 8])
    xs[0], ys[0] = x, y
    if direction == 8:
        return 1, 0
    start_x, start_y, first = x, y, direction
    count, area = 1, 0
    while True:
        step_x, step_y = DX[direction], DY[direction]
        area += x * step_y - y * step_x
        x, y = x + step_x, y + step_y
        direction = np.int64(NEXT[neighbourhood(canvas, x, y + 1) * 8 + direction])
        if (x == start_x and y == start_y and direction == first) or count == limit:
            return count, area
        xs[count], ys[count] = x, y
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
    """Trace the component that encloses most, among rows [top, bottom); returns its border's length, 0 for an empty canvas.

    `pixels` is how many the canvas holds. Nearly always the topmost component has more than half of them and is the answer;
    otherwise it is erased from the copy `spare` and the next one is tried.
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
    """SAMPLES points at equal steps along a closed curve of `count` pixels, linear between them, from its start."""
    step = count / SAMPLES
    for i in range(SAMPLES):
        place = i * step
        j = int(place)
        part = place - j
        k = j + 1 if j + 1 < count else 0
        real[i] = xs[j] + part * (xs[k] - xs[j])
        imaginary[i] = ys[j] + part * (ys[k] - ys[j])


@kernel
def column_transforms(real, imaginary):
    """Radix-2 Fourier transforms down all columns of a (SIDE, SIDE) array at once, in place, output in reversed order."""
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

    n = SIDE a + b, f = c + SIDE d: transforms over a for every b, a turn by exp(-2 pi j b c / SAMPLES), transforms over b
    for every c. Both times the other index is the vector lane.
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
