"""Masks as rows of 64-bit words: bit b of word w is the pixel x = 64 w + b.

The counting idiom is the one that compilers know as `popcnt`.
"""

from __future__ import annotations

import numpy as np

from muybridge._kernels._jit import kernel

_ONES = np.uint64(0xFFFFFFFFFFFFFFFF)
_M1, _M2, _M4 = np.uint64(0x5555555555555555), np.uint64(0x3333333333333333), np.uint64(0x0F0F0F0F0F0F0F0F)
_SUM = np.uint64(0x0101010101010101)
_1, _2, _4, _56, _63 = np.uint64(1), np.uint64(2), np.uint64(4), np.uint64(56), np.uint64(63)


@kernel
def popcount(word):
    """Number of bits set in a 64-bit word."""
    word = word - ((word >> _1) & _M1)
    word = (word & _M2) + ((word >> _2) & _M2)
    word = (word + (word >> _4)) & _M4
    return np.int64((word * _SUM) >> _56)


@kernel
def fill_span(row, first, last):
    """Set the bits first..last (both inside the row) in a row of words."""
    w0, w1 = first >> 6, last >> 6
    head = _ONES << np.uint64(first & 63)
    tail = _ONES >> (_63 - np.uint64(last & 63))
    if w0 == w1:
        row[w0] |= head & tail
        return
    row[w0] |= head
    for w in range(w0 + 1, w1):
        row[w] = _ONES
    row[w1] |= tail


@kernel
def get_bit(row, x):
    """Whether the bit x of a row is set."""
    return (row[x >> 6] >> np.uint64(x & 63)) & _1 != np.uint64(0)


def pack_rows(mask: np.ndarray) -> np.ndarray:
    """(H, W) bool -> (H, ceil(W / 64)) uint64."""
    height, width = mask.shape
    padded = np.zeros((height, -(-width // 64) * 64), dtype=bool)
    padded[:, :width] = mask
    packed = np.packbits(padded, axis=1, bitorder="little")
    return np.ascontiguousarray(packed).view("<u8").astype(np.uint64)


def unpack_rows(words: np.ndarray, width: int) -> np.ndarray:
    """(H, words) uint64 -> (H, width) bool: the inverse of `pack_rows`."""
    packed = np.ascontiguousarray(words.astype("<u8")).view(np.uint8)
    return np.unpackbits(packed, axis=1, bitorder="little")[:, :width].astype(bool)
