"""What every test may use: where the real recordings are, and nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest
from threadpoolctl import threadpool_limits

# Small matrices: a second thread inside BLAS only waits, tens of times as long where other processes run as well.
threadpool_limits(limits=1, user_api="blas")

SHARED = Path(__file__).resolve().parents[2] / "shared"


def shared_data(name: str) -> Path:
    """The folder `name` of real recordings beside the checkout; skips the calling test where it is absent."""
    folder = SHARED / "data" / name
    if not folder.is_dir():
        pytest.skip(f"the recording {name!r} is not beside this checkout")
    return folder
