"""The commands by name, and what ends them: a code, a line about bad input, or Ctrl-C."""

from __future__ import annotations

import os
import sys
import warnings

from cyclopts import App, CycloptsError

from muybridge import __version__
from muybridge.cli.reporting import BAD_INPUT, DONE, INTERRUPTED, LOST
from muybridge.errors import MuybridgeError

#: name -> module and function, and the line that --help shows without importing it.
COMMANDS = {
    "demo": ("demo:demo", "Render a scene with known truth, track it, and say how far off the track is."),
    "track": ("track:track", "Track the person that a job file describes."),
    "job": ("job:job", "Write a job for a folder in a known layout."),
    "sample": ("sample:sample", "Get a real recording to try things on."),
    "people": ("people:people", "Follow several people before one fixed colour camera."),
    "mark": ("mark:mark", "Mark what hides people before a camera, for people."),
    "background": ("background:background", "Tell people from what stands still: a mask for every picture."),
    "synth": ("synth:synth", "Render a scene with known truth, for track."),
    "train": ("train:train", "Learn to guess poses from silhouettes, for filters that need no first pose."),
    "train-repair": ("train_repair:train_repair", "Learn to tell when a part of a person was lost, for people."),
    "evaluate": ("evaluate:evaluate", "Compare a run with the truth: error per joint in mm."),
    "report": ("report:report", "Write a run's report and plots into its folder."),
    "experiment": ("experiment:experiment", "Run a paper's experiments on scenes with known truth."),
    "bench": ("bench:bench", "Measure how fast the parts are on this machine."),
    "doctor": ("doctor:doctor", "Say what is installed and whether it works."),
}


def build() -> App:
    """The application; commands are imported when called."""
    app = App(
        name="muybridge",
        help="Bayesian, model-based tracking of people in video: 3D poses with error bars.",
        version=__version__,
        suppress_keyboard_interrupt=False,
    )
    for name, (target, line) in COMMANDS.items():
        app.command(f"muybridge.cli.{target}", name=name, help=line)
    return app


def run(arguments: list[str]) -> int:
    """The exit code of the command; expected trouble becomes one line on stderr."""
    # Threads inside BLAS fight with those over particles; this must be set before numpy is imported.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        code = _run(arguments)
    if code in (DONE, LOST):  # else one line says what is wrong, and no other may drown it
        for message in dict.fromkeys(str(warning.message) for warning in caught):
            _complain(f"note: {message}", code)
    return code


def _run(arguments: list[str]) -> int:
    try:
        code = build()(arguments, exit_on_error=False, print_error=False, result_action="return_value")
    except (MuybridgeError, CycloptsError) as error:
        return _complain(str(error), BAD_INPUT)
    except KeyboardInterrupt as interrupt:
        return _complain(str(interrupt) or "interrupted; what was finished is kept", INTERRUPTED)
    except BrokenPipeError:
        # The reader of our output has gone (`| head`): nothing is wrong, and nothing more can be said.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except OSError as error:
        return _complain(f"{error.filename or 'file'}: {error.strerror or error}", BAD_INPUT)
    return code if isinstance(code, int) else DONE


def _complain(message: str, code: int) -> int:
    print("muybridge: " + " ".join(message.split()), file=sys.stderr)
    return code
