"""A small folder in HumanEva's layout: two or three cameras, a video each, motion capture of a made person."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from made_folders import HEIGHT, WIDTH, look_from
from muybridge.datasets.humaneva_joints import SEGMENTS, SKIN_MARKERS
from muybridge.io.trc import MarkerTrack

SKIN = tuple(names if isinstance(names, str) else names[0] for names in SKIN_MARKERS)
OTHERS = ("TRXO", "LCLO", "RCLO")
"""Origins that are looked at without their axes."""
LABELS = (*SKIN, *(f"{segment}{letter}" for segment in SEGMENTS for letter in "OPAL"), *OTHERS)
OFFSETS = {"C1": (4, 7, 2.0), "C2": (3, 7, 2.0), "C3": (4, 9, 2.0), "BW1": (6, 11, 2.0)}
"""Picture, motion capture frame, motion capture frames a picture."""
MEASURES = "$BodyMass = 70\n$Height = 1790\n$LShoulderOffset = 44\n$RShoulderOffset = 46\n"


def made_track(rows: int = 60, seed: int = 3) -> MarkerTrack:
    """Points of a person whose segments turn and drift at random but smoothly; metres."""
    rng = np.random.default_rng(seed)
    time = np.linspace(0, 1, rows)[:, None]
    places: dict[str, np.ndarray] = {
        name: rng.normal(0, 0.4, 3) + [0, 0, 1] + time * rng.normal(0, 0.3, 3) for name in (*SKIN, *OTHERS)
    }
    for segment in SEGMENTS:
        origin = rng.normal(0, 0.4, 3) + [0, 0, 1] + time * rng.normal(0, 0.3, 3)
        turns = Rotation.from_rotvec(rng.normal(0, 1, 3)) * Rotation.from_rotvec(time * rng.normal(0, 0.5, 3))
        places[f"{segment}O"] = origin
        for letter, axis in zip("ALP", np.eye(3), strict=True):
            places[f"{segment}{letter}"] = origin + rng.uniform(0.1, 0.4) * turns.apply(axis)
    positions = np.stack([places[name] for name in LABELS], axis=1)
    return MarkerTrack(LABELS, np.arange(rows), np.arange(rows) / 120, positions, "xyz")


def write_mat(path: Path, track: MarkerTrack, *, prefix: str = "", units: str = "mm") -> None:
    """As MATLAB saves what the data set's own reader makes of a C3D: structs and cells in one another, millimetres."""
    from scipy.io import savemat

    def parameter(name: str, data: object) -> tuple:
        return (np.array([[name]], object), np.array([[4.0]]), data)

    kind = [("name", object), ("datatype", object), ("data", object)]
    labels = np.empty((1, len(track.names)), object)
    labels[0] = [prefix + name for name in track.names]
    point = np.array([[parameter("USED", np.array([[float(len(track.names))]])), parameter("LABELS", labels),
                       parameter("UNITS", np.array([[units]], object))]], kind)  # fmt: skip
    trial = np.array([[parameter("NAME", np.array([["Walking"]], object))]], kind)
    groups = np.array([[(np.array([["TRIAL"]], object), trial), (np.array([["POINT"]], object), point)]],
                      [("name", object), ("Parameter", object)])  # fmt: skip
    markers = np.nan_to_num(1000 * track.positions, nan=0.0)
    path.parent.mkdir(parents=True, exist_ok=True)
    savemat(path, {"Markers": markers, "ParameterGroup": groups, "VideoFrameRate": 120.0}, do_compression=True)


def write_c3d(path: Path, track: MarkerTrack) -> None:
    """By ezc3d, which the caller has looked for."""
    import ezc3d

    content = ezc3d.c3d()
    point = content["parameters"]["POINT"]
    point["LABELS"]["value"], point["UNITS"]["value"], point["RATE"]["value"] = list(track.names), ["mm"], [120.0]
    points = np.ones((4, len(track.names), len(track.positions)))
    points[:3] = 1000 * track.positions.transpose(2, 1, 0)
    content["data"]["points"] = points
    path.parent.mkdir(parents=True, exist_ok=True)
    content.write(str(path))


def cal_numbers(angle: float) -> list[float]:
    """The 22 numbers of a camera as `made_folders.look_from` places it, with skew and distortion; millimetres."""
    rotation, translation = look_from(angle)
    return [60, 61, 31.5, 23.5, 0.01, -0.05, 0.01, 0.001, 0.002, 0.003, *rotation.ravel(), *(1000 * translation)]


def numbered_pictures(count: int, level: int = 90, size: tuple[int, int] = (WIDTH, HEIGHT)) -> list[np.ndarray]:
    """Even pictures; picture n has a bright bar 4 n pixels from the left, read back by `number_of`."""
    pictures = []
    for number in range(count):
        picture = np.full((size[1], size[0], 3), level, np.uint8)
        picture[:, 4 * (number % (size[0] // 4)) :][:, :4] = 230
        pictures.append(picture)
    return pictures


def empty_picture(level: int) -> np.ndarray:
    """Nobody there."""
    return np.full((HEIGHT, WIDTH, 3), level, np.uint8)


def write_avi(path: Path, pictures: Sequence[np.ndarray], rate: int = 60) -> None:
    """MPEG-4 part 2 in an AVI, as the data set's videos are, though not by XviD."""
    import av

    path.parent.mkdir(parents=True, exist_ok=True)
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=rate, options={"qscale": "2"})
        stream.width, stream.height, stream.pix_fmt = pictures[0].shape[1], pictures[0].shape[0], "yuv420p"
        for picture in pictures:
            for packet in stream.encode(av.VideoFrame.from_ndarray(picture, format="bgr24")):
                container.mux(packet)
        for packet in stream.encode(None):
            container.mux(packet)


def number_of(picture: np.ndarray) -> int:
    """Which picture of `numbered_pictures` this is, counted from 0."""
    columns = picture.reshape(*picture.shape[:2], -1).mean(axis=(0, 2))
    return int(columns.reshape(-1, 4).mean(axis=1).argmax())


def humaneva_folder(
    folder: Path,
    *,
    cameras: Sequence[str] = ("C1", "C2", "BW1"),
    pictures: int = 14,
    rows: int = 60,
    motion: str = "Walking_1",
) -> Path:
    """DIR/S1 with one motion, and DIR/Background of two days, of which the second is the motion's."""
    person = folder / "S1"
    for number, name in enumerate(cameras):
        write_avi(person / "Image_Data" / f"{motion}_({name}).avi", numbered_pictures(pictures))
        write_avi(folder / "Background" / f"Background_1_({name}).avi", [empty_picture(40)] * 5)
        write_avi(folder / "Background" / f"Background_2_({name}).avi", [empty_picture(92)] * 5)
        write_lines(person / "Calibration_Data" / f"{name}.cal", cal_numbers(1 + number))
        write_lines(person / "Sync_Data" / f"{motion}_({name}).ofs", OFFSETS[name])
    write_mat(person / "Mocap_Data" / f"{motion}.mat", made_track(rows))
    write_mat(person / "Mocap_Data" / "Static.mat", made_track(4))
    (person / "Mocap_Data" / "S1.mp").write_text(MEASURES)
    return folder


def write_lines(path: Path, numbers: Sequence[float]) -> None:
    """One number a line, with as many decimals as the data set's own writers give them."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("".join(f"{number:f} \n" for number in numbers))
