"""The log that `--resume` continues from: fixed-size binary records, each with a checksum.

Layout (little-endian): magic `MUYBLOG1`, uint32 length and uint32 crc32 of the header, the header as JSON, then
records: uint32 crc32 over (uint64 record number, payload), payload. A process may be killed at any moment: whole
records stay, a damaged tail is dropped. Nothing is ever pickled.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import struct
import zlib
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from muybridge.errors import InputError
from muybridge.io.disk import disk_errors, make_folder, sync_folder

MAGIC = b"MUYBLOG1"
FORMAT_VERSION = 1
DEFAULT_CHECKPOINT_EVERY = 10
"""Records between two fsyncs: a power cut costs these, a killed process none."""
# A header from elsewhere must not make us ask for absurd amounts of memory.
_MAX_HEADER_BYTES = 1 << 20
_MAX_RECORD_BYTES = 1 << 30
_PREFIX = struct.Struct("<8sII")
_CHECKSUM = struct.Struct("<I")
_NUMBER = struct.Struct("<Q")

Fields = Mapping[str, tuple[str, tuple[int, ...]]]
"""Field name -> (dtype such as "f8", shape such as (1000, 31))."""


@dataclass(frozen=True)
class LogHeader:
    """What the log holds: the record's fields, and the digest of the job it belongs to."""

    dtype: np.dtype
    job_digest: str
    size: int  # bytes before the first record

    @property
    def record_size(self) -> int:
        """Bytes of a record with its checksum."""
        return _CHECKSUM.size + self.dtype.itemsize


class RunLog:
    """Appends records; made by `create_log` or `resume_log`.

    Every record has reached the operating system when `append` returns, and the disk at each checkpoint.
    """

    def __init__(self, path: Path, file: BinaryIO, header: LogHeader, count: int, checkpoint_every: int) -> None:
        self.path, self.header, self.count = path, header, count
        self._file, self._checkpoint_every = file, checkpoint_every

    def append(self, **values: Any) -> None:
        """Append one record; every field must be given, in its shape."""
        record = np.zeros((), self.header.dtype)
        if set(values) != set(self.header.dtype.names or ()):
            expected = ", ".join(self.header.dtype.names or ())
            raise InputError(f"{self.path}: record", expected=expected, got=", ".join(values))
        for name, value in values.items():
            if np.shape(value) != record[name].shape:
                expected = f"shape {record[name].shape}"
                raise InputError(f"{self.path}: {name}", expected=expected, got=str(np.shape(value)))
            record[name] = value
        payload = record.tobytes()
        with disk_errors(self.path):
            self._file.write(_checksum(self.count, payload) + payload)
            self._file.flush()
        self.count += 1
        if self.count % self._checkpoint_every == 0:
            self.checkpoint()

    def checkpoint(self) -> None:
        """Wait until everything is on the disk."""
        with disk_errors(self.path):
            self._file.flush()
            os.fsync(self._file.fileno())

    def close(self) -> None:
        """Wait until everything is on the disk, then close the file; doing so twice is fine."""
        if not self._file.closed:
            try:
                self.checkpoint()
            finally:
                with disk_errors(self.path):
                    self._file.close()

    def __enter__(self) -> RunLog:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def create_log(
    path: str | Path, fields: Fields, job_digest: str, *, checkpoint_every: int = DEFAULT_CHECKPOINT_EVERY
) -> RunLog:
    """Begin a log; one that is there already is replaced."""
    target = Path(path)
    described = [[name, np.dtype(kind).newbyteorder("<").str, list(shape)] for name, (kind, shape) in fields.items()]
    header = {"format_version": FORMAT_VERSION, "fields": described, "job_digest": job_digest}
    text = json.dumps(header).encode()
    dtype = _record_dtype(target, described)
    make_folder(target.parent)
    with disk_errors(target):
        file = open(target, "wb")
        file.write(_PREFIX.pack(MAGIC, len(text), zlib.crc32(text)) + text)
    log = RunLog(target, file, LogHeader(dtype, job_digest, _PREFIX.size + len(text)), 0, checkpoint_every)
    log.checkpoint()
    sync_folder(target.parent)
    return log


def resume_log(path: str | Path, job_digest: str, *, checkpoint_every: int = DEFAULT_CHECKPOINT_EVERY) -> RunLog:
    """Go on with a log after its last whole record; a damaged tail is cut off.

    Raises
    ------
    InputError
        Where the log belongs to another job.
    """
    target = Path(path)
    with _opened(target) as file:
        header = _read_header(target, file)
        count = sum(1 for _ in _payloads(file, header))
    if header.job_digest != job_digest:
        remedy = "choose another --out, or leave out --resume to begin anew"
        got = "changed settings or inputs"
        raise InputError(str(path), expected="the job this run was begun with", got=got, remedy=remedy)
    with disk_errors(target):
        writable = open(target, "r+b")
        writable.truncate(header.size + count * header.record_size)
        writable.seek(0, os.SEEK_END)
    return RunLog(target, writable, header, count, checkpoint_every)


def read_header(path: str | Path) -> LogHeader:
    """What a log holds, without its records."""
    with _opened(Path(path)) as file:
        return _read_header(Path(path), file)


def read_records(path: str | Path) -> Iterator[np.void]:
    """Yield the whole records in order, as numpy structured scalars: `record["pose"]`; a damaged tail is left out."""
    with _opened(Path(path)) as file:
        header = _read_header(Path(path), file)
        for payload in _payloads(file, header):
            yield np.frombuffer(payload, header.dtype)[0]


def read_last(path: str | Path) -> np.void | None:
    """The last whole record, from which a run continues; None where there is none yet."""
    last = deque(read_records(path), maxlen=1)
    return last[0] if last else None


def job_digest(settings: Mapping[str, Any]) -> str:
    """A digest of everything that decides a run's results (JSON values only), whatever the order of its keys."""
    text = json.dumps(settings, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def generator_words(rng: np.random.Generator) -> np.ndarray:
    """The state of a PCG64 generator as (6,) uint64, to be kept in a record (`"u8", (6,)`)."""
    state = rng.bit_generator.state
    if state["bit_generator"] != "PCG64":
        raise InputError("random generator", expected="PCG64", got=state["bit_generator"])
    mask = (1 << 64) - 1
    numbers = [state["state"]["state"], state["state"]["inc"]]
    words = [part for number in numbers for part in (number & mask, number >> 64)]
    return np.array([*words, state["has_uint32"], state["uinteger"]], np.uint64)


def generator_from_words(words: np.ndarray) -> np.random.Generator:
    """The generator whose `generator_words` these are."""
    low, high, low_increment, high_increment, has_half, half = (int(word) for word in words)
    rng = np.random.Generator(np.random.PCG64())
    rng.bit_generator.state = {
        "bit_generator": "PCG64",
        "state": {"state": low | high << 64, "inc": low_increment | high_increment << 64},
        "has_uint32": has_half,
        "uinteger": half,
    }
    return rng


def _checksum(number: int, payload: bytes) -> bytes:
    return _CHECKSUM.pack(zlib.crc32(payload, zlib.crc32(_NUMBER.pack(number))))


def _payloads(file: BinaryIO, header: LogHeader) -> Iterator[bytes]:
    number = 0
    while len(record := file.read(header.record_size)) == header.record_size:
        payload = record[_CHECKSUM.size :]
        if record[: _CHECKSUM.size] != _checksum(number, payload):
            return
        yield payload
        number += 1


def _opened(path: Path) -> BinaryIO:
    try:
        return open(path, "rb")
    except OSError as error:
        raise InputError(str(path), expected="a run log", got=error.strerror or str(error)) from error


def _read_header(path: Path, file: BinaryIO) -> LogHeader:
    prefix = file.read(_PREFIX.size)
    if prefix[: len(MAGIC)] != MAGIC:
        got = "an empty file" if not prefix else "a file of another kind"
        raise InputError(str(path), expected="a run log of muybridge", got=got, remedy="leave out --resume")
    broken = InputError(str(path), expected="a whole header", got="a damaged one", remedy="leave out --resume")
    if len(prefix) < _PREFIX.size:
        raise broken
    _, length, checksum = _PREFIX.unpack(prefix)
    text = file.read(length) if length <= _MAX_HEADER_BYTES else b""
    if len(text) != length or zlib.crc32(text) != checksum:
        raise broken
    header = json.loads(text)
    if header.get("format_version") != FORMAT_VERSION:
        got = str(header.get("format_version"))
        raise InputError(f"{path}: format version", expected=str(FORMAT_VERSION), got=got, remedy="leave out --resume")
    return LogHeader(_record_dtype(path, header["fields"]), header["job_digest"], _PREFIX.size + length)


def _record_dtype(path: Path, described: list) -> np.dtype:
    """Packed little-endian record; numbers and bools only, so that nothing in a file can be code."""
    for name, kind, shape in described:
        if np.dtype(kind).kind not in "biuf":
            raise InputError(f"{path}: field {name}", expected="numbers or bools", got=str(kind))
        if any(side < 0 for side in shape):
            raise InputError(f"{path}: field {name}", expected="a shape", got=str(shape))
    size = sum(np.dtype(kind).itemsize * math.prod(shape) for _, kind, shape in described)
    if not 0 < size <= _MAX_RECORD_BYTES:
        raise InputError(f"{path}: record", expected=f"1 to {_MAX_RECORD_BYTES} bytes", got=str(size))
    return np.dtype([(name, kind, tuple(shape)) for name, kind, shape in described])
