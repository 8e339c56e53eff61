"""What was learnt, as a file: arrays and a JSON header in one compressed npz; nothing in it is executed or unpickled.

The header holds the format's name and version, a SHA-256 checksum of the arrays, and whatever its owner puts there.
"""

from __future__ import annotations

import hashlib
import json
import os
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.errors import InputError

HEADER = "header"
#: What reading a damaged zip or array may raise.
_DAMAGE = (OSError, EOFError, ValueError, KeyError, TypeError, NotImplementedError, zipfile.BadZipFile, zlib.error)
#: What rebuilding from an archive that lacks something may raise.
INCOMPLETE = (KeyError, TypeError, ValueError, IndexError, np.linalg.LinAlgError)

Arrays = dict[str, np.ndarray]


@dataclass(frozen=True)
class Kind:
    """A kind of file: its format's name, the version that is read and written, and the command that writes it."""

    format: str
    version: int
    command: str

    def save(self, path: str | Path, header: dict[str, Any], arrays: Arrays) -> None:
        """Write the whole file, or leave the one that was there untouched."""
        target = Path(path)
        header = {"format": self.format, "version": self.version, **header, "checksum": checksum(arrays)}
        unfinished = target.with_name(f"{target.stem}.unfinished.npz")
        try:
            with open(unfinished, "wb") as file:
                np.savez_compressed(file, **{HEADER: np.array(json.dumps(header))}, **arrays)  # type: ignore[arg-type]
            os.replace(unfinished, target)
        except OSError as error:
            reason = os.strerror(error.errno) if error.errno else str(error)
            raise InputError(str(target), expected="room to write", got=reason) from error
        finally:
            unfinished.unlink(missing_ok=True)

    def load(self, what: str, path: str | Path) -> tuple[dict[str, Any], Arrays]:
        """Header and arrays; InputError about `what` where it is damaged, something else, or of another version."""
        arrays = self._read(what, Path(path))
        header = self._header(what, arrays)
        if header["checksum"] != checksum(arrays):
            raise InputError(what, expected="the checksum that was written", got="another", remedy="it is damaged")
        return header, arrays

    def _read(self, what: str, path: Path) -> Arrays:
        if not path.is_file():
            raise InputError(what, expected="a file", got="none")
        try:
            with np.load(path, allow_pickle=False) as stored:
                return {name: stored[name] for name in stored.files}
        except _DAMAGE as error:
            got = str(error).splitlines()[0][:80] if str(error) else type(error).__name__
            raise InputError(what, expected=f"a file that `{self.command}` wrote, whole", got=got) from error

    def _header(self, what: str, arrays: Arrays) -> dict[str, Any]:
        """The header, taken out of the arrays."""
        try:
            header = json.loads(str(arrays.pop(HEADER)))
        except (KeyError, ValueError, RecursionError):
            header = None
        if not isinstance(header, dict) or header.get("format") != self.format:
            raise InputError(what, expected=f"the format {self.format!r}", got="another kind of npz")
        if header.get("version") != self.version:
            remedy = "it was written by another version of this program: train it anew"
            raise InputError(
                f"{what}: version", expected=str(self.version), got=repr(header.get("version")), remedy=remedy
            )
        if "checksum" not in header:
            raise InputError(what, expected="a checksum", got="none")
        return header


def checksum(arrays: Arrays) -> str:
    """SHA-256 over names, types, shapes and values, in the order of the names."""
    digest = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        digest.update(f"{name} {array.dtype.str} {array.shape}\n".encode())
        digest.update(array.tobytes())
    return digest.hexdigest()


def incomplete(what: str, expected: str, error: Exception) -> InputError:
    """One line for a file that is whole and yet lacks something."""
    return InputError(what, expected=expected, got=f"{type(error).__name__}: {error}".splitlines()[0])
