"""The one place that owns the compiler's flags.

Kernels take arrays and scalars only: a function argument would miss numba's disk cache in every new process. They never
draw random numbers and never print; they return status codes or fill `out`. With NUMBA_DISABLE_JIT=1 they run as plain
Python, and the suite passes that way too.
"""

from __future__ import annotations

from numba import njit

#: `fastmath` without "nnan" and "ninf": kernels use infinities as sentinels and must honour them.
FASTMATH = {"nsz", "arcp", "contract", "afn", "reassoc"}

kernel = njit(cache=True, nogil=True, fastmath=FASTMATH, error_model="numpy")
parallel_kernel = njit(cache=True, nogil=True, fastmath=FASTMATH, error_model="numpy", parallel=True)
inline_kernel = njit(cache=True, nogil=True, fastmath=FASTMATH, error_model="numpy", inline="always")
#: Inlined by the compiler itself, which lets loops around it become vector code.
vector_kernel = njit(cache=True, nogil=True, fastmath=FASTMATH, error_model="numpy", forceinline=True)
#: Without reordering, for code whose accuracy hangs on the order of its additions.
exact_kernel = njit(cache=True, nogil=True, error_model="numpy")
