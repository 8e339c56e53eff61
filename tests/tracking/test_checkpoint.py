"""Checkpoints: what is read is what was written, and anything else is one clear error."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.tracking.checkpoint import CHECKPOINT_FILE, Checkpoint, read_checkpoint, write_checkpoint

DIGEST = "5e884898da28047151d0e56f8dc6292773603d0d6aabbdd6"


@pytest.fixture
def written(tmp_path: Path) -> Checkpoint:
    rng = np.random.default_rng(0)
    arrays = {"filter_particles": rng.normal(size=(20, 5)), "troubled": np.array(3), "costs": np.array([np.nan, 0.2])}
    checkpoint = Checkpoint(25, arrays)
    write_checkpoint(tmp_path, checkpoint, DIGEST)
    return checkpoint


def test_comes_back(tmp_path: Path, written: Checkpoint) -> None:
    read = read_checkpoint(tmp_path, DIGEST)
    assert read is not None and read.frames == 25 and read.arrays.keys() == written.arrays.keys()
    for name, array in written.arrays.items():
        assert read.arrays[name].dtype == array.dtype and read.arrays[name].tobytes() == array.tobytes()


def test_none_yet(tmp_path: Path) -> None:
    assert read_checkpoint(tmp_path, DIGEST) is None


def test_the_last_one_counts(tmp_path: Path, written: Checkpoint) -> None:
    write_checkpoint(tmp_path, Checkpoint(50, written.arrays), DIGEST)
    read = read_checkpoint(tmp_path, DIGEST)
    assert read is not None and read.frames == 50
    assert [path.name for path in tmp_path.iterdir()] == [CHECKPOINT_FILE]


def test_of_another_job(tmp_path: Path, written: Checkpoint) -> None:
    with pytest.raises(InputError, match="another job"):
        read_checkpoint(tmp_path, DIGEST[::-1])


def test_cut_off_anywhere(tmp_path: Path, written: Checkpoint) -> None:
    path = tmp_path / CHECKPOINT_FILE
    whole = path.read_bytes()
    for length in (0, 1, 3, *range(4, len(whole), len(whole) // 40), len(whole) - 1):
        path.write_bytes(whole[:length])
        with pytest.raises(InputError) as error:
            read_checkpoint(tmp_path, DIGEST)
        assert "\n" not in str(error.value)


def test_flipped_bytes(tmp_path: Path, written: Checkpoint) -> None:
    """A flipped byte is an error or, in what a zip says twice, harmless; it never makes other numbers."""
    path = tmp_path / CHECKPOINT_FILE
    whole = path.read_bytes()
    refused = 0
    places = range(0, len(whole), 7)
    for place in places:
        damaged = bytearray(whole)
        damaged[place] ^= 0x55
        path.write_bytes(damaged)
        try:
            read = read_checkpoint(tmp_path, DIGEST)
        except InputError as error:
            assert "\n" not in str(error)
            refused += 1
            continue
        assert read is not None and read.frames == 25
        assert {name: array.tobytes() for name, array in read.arrays.items()} == {
            name: array.tobytes() for name, array in written.arrays.items()
        }
    assert refused > len(places) / 2


def test_something_else(tmp_path: Path) -> None:
    path = tmp_path / CHECKPOINT_FILE
    for content in (b"not a zip", b"PK\x05\x06" + bytes(18)):
        path.write_bytes(content)
        with pytest.raises(InputError):
            read_checkpoint(tmp_path, DIGEST)
    np.savez(path, frames=np.array(1))
    with pytest.raises(InputError):
        read_checkpoint(tmp_path, DIGEST)
    np.savez(path, digest=np.frombuffer(DIGEST.encode(), np.uint8))
    with pytest.raises(InputError):
        read_checkpoint(tmp_path, DIGEST)
