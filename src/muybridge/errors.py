"""What goes wrong, said in one line: what, expected, got, remedy.

Expected trouble while tracking (weights collapsed, person lost) is a status in the step's Info, not an exception;
exceptions are for input that cannot be used.
"""

from __future__ import annotations


class MuybridgeError(Exception):
    """Base of every error this package raises on purpose. The command line prints it and exits with 2."""


class InputError(MuybridgeError):
    """Input that cannot be used.

    Parameters
    ----------
    what : str
        The thing that is wrong, named as the user knows it (a file, a key, a camera).
    expected, got, remedy : str
        What would have been right, what was found, and what to do. Each may be empty.
    """

    def __init__(self, what: str, *, expected: str = "", got: str = "", remedy: str = "") -> None:
        self.what, self.expected, self.got, self.remedy = what, expected, got, remedy
        middle = ", ".join(part for part in (f"expected {expected}" * bool(expected), f"got {got}" * bool(got)) if part)
        line = f"{what}: {middle}" if middle else what
        super().__init__(f"{line}; {remedy}" if remedy else line)

    def __reduce__(self) -> tuple:
        return (_rebuild, (self.what, self.expected, self.got, self.remedy))


def _rebuild(what: str, expected: str, got: str, remedy: str) -> InputError:
    return InputError(what, expected=expected, got=got, remedy=remedy)
