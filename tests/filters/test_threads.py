"""The same seed gives the same bytes with one BLAS thread and with two."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

TESTS = Path(__file__).parents[1]

# 20001 particles: many enough for BLAS to share out a sum that a filter leaves to it. (They did, and this failed.)
PROGRAM = """
import hashlib
from dataclasses import replace
import numpy as np
from filters.conformance import Scripted, bytes_of, dynamics, start
from muybridge.filters import METHODS, Weights, covariance

for name, method in METHODS.items():
    config = replace(method.PRINTED, particles=20001, estimate="mean")
    rng, state = start(method, config)
    state, info = method.step(rng, state, Scripted(), dynamics(), config)
    spread = covariance(state.particles, Weights(state.log_weights))
    noted = np.array([info.ess, info.log_likelihood, *info.spread_after])
    print(name, hashlib.sha256(bytes_of(state) + spread.tobytes() + noted.tobytes()).hexdigest())
"""


def digests(threads: int) -> list[str]:
    path = os.pathsep.join((str(TESTS.parent / "src"), str(TESTS)))
    environment = os.environ | {"OPENBLAS_NUM_THREADS": str(threads), "PYTHONPATH": path}
    result = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True, timeout=120
    )
    return result.stdout.splitlines()


def test_bytes_do_not_depend_on_blas_threads() -> None:
    assert digests(1) == digests(2)
