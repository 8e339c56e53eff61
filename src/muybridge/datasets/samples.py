"""Recordings to try the program on, obtained as packages: `beam`, a man balancing before four calibrated cameras.

`beam` is inside a package of the Python package index (BSD-3-Clause, see PACKAGE): 100 frames at 60 Hz, 4 videos of
1080 or 1088 x 1920 pixels, a Qualisys calibration, checkerboards. It carries no result to compare with.

What has to be put right, and is: two videos are stored scaled to 1080 columns between black bars (`fitting`); the
distortion is taken from the Qualisys file, whose converted forms have it 64 times too small (`pose2sim`); there is no
picture of the empty scene, so one is made of the video and the picture in which the extrinsics were measured
(`segmentation.make_plate`). What is not: the extrinsics do not fit together by up to 13 pixels; tracking reports that.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from muybridge.datasets.fitting import fit_picture
from muybridge.datasets.pose2sim import pose2sim_recording
from muybridge.datasets.recording import Recording, write_recording_job
from muybridge.errors import InputError, MuybridgeError

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Package:
    """A package, exactly: what is fetched is refused unless it is the very file."""

    name: str
    version: str
    sha256: str
    inside: str
    """The folder that is unpacked."""


PACKAGE = Package(
    name="pose2sim",
    version="0.10.49",
    sha256="403e0dc4065898ba6a595e72a8970950310979253d60e24c2e00b16b36bf21e1",
    inside="Pose2Sim/Demo_SinglePerson/",
)
TRIAL, PLATES, EXTRINSICS = "trial", "plates", "calibration/extrinsics"
PLATE_FRAMES = 25
"""Frames spread over each video of which its plate is made."""


def cache_folder() -> Path:
    """Where samples are kept: $MUYBRIDGE_CACHE, else the user's cache folder."""
    own = os.environ.get("MUYBRIDGE_CACHE")
    if own:
        return Path(own)
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "muybridge"


def beam(
    folder: Path | str | None = None, *, wheel: Path | str | None = None, progress: Progress | None = None
) -> Recording:
    """The beam recording, fetched, checked and completed with plates on first use.

    Parameters
    ----------
    folder : Path, optional
        Where it is kept; `cache_folder() / "beam"` where absent. Once complete, nothing is fetched again.
    wheel : Path, optional
        The package's file, where it has been fetched by other means.
    progress : callable, optional
        Told in a few words what is being done.
    """
    folder = Path(folder) if folder is not None else cache_folder() / "beam"
    tell = progress or (lambda _: None)
    trial = folder / TRIAL
    if not (trial / "Config.toml").is_file():
        tell(f"fetching {PACKAGE.name} {PACKAGE.version} (51 MB)")
        source = Path(wheel) if wheel is not None else fetch(PACKAGE, folder)
        check(source, PACKAGE)
        unpack(source, PACKAGE.inside, trial)
        if wheel is None:
            source.unlink()
    recording = replace(pose2sim_recording(trial), name="beam", frame_rate=None)
    for camera in recording.cameras:
        if camera.plate is None:
            tell(f"making the background of {camera.name}")
            write_plate(trial, camera.name, camera.pictures)
    return replace(pose2sim_recording(trial), name="beam", frame_rate=None)


def beam_from_folder(folder: Path | str) -> Recording:
    """The beam recording from a folder with videos/, calibration/, plates/ and, if there, reference/*.trc.

    Plates must have the calibrated size or the video's; use `fitted_plates` for those of the calibrated size.
    """
    folder = Path(folder).absolute()
    from muybridge.datasets.pose2sim import recording_of_parts

    reference = sorted((folder / "reference").glob("*BalancingTrial*filt_butterworth.trc"))
    recording = recording_of_parts(folder, {})
    return replace(recording, name="beam", frame_rate=None, reference=reference[0] if reference else None)


def fitted_plates(recording: Recording, folder: Path | str) -> Recording:
    """The recording with its plates scaled and padded as its videos are, written into `folder` where they were not."""
    from muybridge.io.disk import make_folder
    from muybridge.io.image_sequence import read_image

    cameras = []
    for camera, calibrated in zip(recording.cameras, recording.rig, strict=True):
        if camera.plate is not None:
            picture = read_image(camera.plate)
            fitted = fit_picture(picture, calibrated.size)
            if fitted is not picture:
                path = make_folder(Path(folder)) / f"{camera.name}.png"
                _write_png(path, fitted)
                camera = replace(camera, plate=path)
        cameras.append(camera)
    return replace(recording, cameras=tuple(cameras))


def write_beam_job(folder: Path | str, source: Path | str | None = None, *, progress: Progress | None = None) -> str:
    """Lay out a job folder for the beam recording; returns the job's text.

    `source`: a folder for `beam_from_folder`; where absent the sample is obtained by `beam`.
    """
    recording = beam(progress=progress) if source is None else beam_from_folder(source)
    return write_recording_job(fitted_plates(recording, Path(folder) / PLATES), folder)


SAMPLES: dict[str, Callable[..., str]] = {"beam": write_beam_job}
"""What `muybridge sample NAME --out DIR` may name."""


def fetch(package: Package, folder: Path) -> Path:
    """The package's file, by this Python's own pip and from wherever that is set up to fetch."""
    from muybridge.io.disk import make_folder

    make_folder(folder)
    requirement = f"{package.name}=={package.version}"
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps",
               "--only-binary=:all:", "--ignore-requires-python", "--dest", str(folder), requirement]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    found = sorted(folder.glob(f"{package.name}-{package.version}-*.whl"))
    if done.returncode or not found:
        last = (done.stderr.strip().splitlines() or ["no file came"])[-1]
        raise MuybridgeError(f"could not fetch {requirement}: {last}; fetch its wheel elsewhere and give that file")
    return found[0]


def check(path: Path, package: Package) -> None:
    """Refuse anything but the very file."""
    try:
        with path.open("rb") as file:
            found = hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise InputError(str(path), expected=f"the wheel of {package.name} {package.version}",
                         got=error.strerror or str(error)) from error  # fmt: skip
    if found != package.sha256:
        raise InputError(f"{path}: sha256", expected=f"{package.sha256[:16]}...", got=f"{found[:16]}...",
                         remedy=f"delete it and fetch {package.name} {package.version} again")  # fmt: skip


def unpack(archive: Path, inside: str, folder: Path) -> None:
    """Unpack one folder of a zip archive; nothing may land outside `folder`."""
    from muybridge.io.disk import make_folder, replace_file

    with zipfile.ZipFile(archive) as file:
        members = [member for member in file.infolist() if member.filename.startswith(inside) and not member.is_dir()]
        if not members:
            raise InputError(str(archive), expected=f"a folder {inside}", got="none")
        # Config.toml goes last: where it is, the rest is whole.
        for member in sorted(members, key=lambda member: member.filename.endswith("Config.toml")):
            target = (folder / member.filename[len(inside) :]).resolve()
            if not target.is_relative_to(folder.resolve()):
                raise InputError(str(archive), expected="names inside its own folder", got=member.filename)
            make_folder(target.parent)
            replace_file(target, file.read(member))


def write_plate(trial: Path, name: str, pictures: Path) -> Path:
    """Make a camera's plate of its video and its extrinsics picture, and write `plates/NAME.png`."""
    from muybridge.io.disk import make_folder
    from muybridge.io.image_sequence import read_image
    from muybridge.io.video import open_pictures
    from muybridge.segmentation import make_plate

    with open_pictures(pictures) as video:
        indices = np.unique(np.linspace(0, video.frame_count - 1, PLATE_FRAMES).round().astype(int))
        frames = [video.read(int(index)) for index in indices]
        elsewhere = fit_picture(read_image(trial / EXTRINSICS / f"{name}_ext.png"), video.size)
    path = make_folder(trial / PLATES) / f"{name}.png"
    _write_png(path, make_plate(frames, elsewhere))
    return path


def _write_png(path: Path, picture: np.ndarray) -> None:
    import cv2

    from muybridge.io.disk import replace_file

    replace_file(path, cv2.imencode(".png", picture)[1].tobytes())
