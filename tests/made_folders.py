"""Small folders in the known layouts, made of noise and plain shapes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

WIDTH, HEIGHT = 64, 48
CONFIG = (
    "[project]\nframe_rate = 'auto'\nparticipant_height = {height}\nparticipant_mass = 71.5\nframe_range = {frames}\n"
)


def look_from(angle: float) -> tuple[np.ndarray, np.ndarray]:
    """R and t (metres) of a camera 4 m from the origin and 1 m up, level, looking at the vertical axis."""
    forward = -np.array([np.cos(angle), np.sin(angle), 0.0])
    down = np.array([0.0, 0.0, -1.0])
    rotation = np.stack([np.cross(down, forward), down, forward])
    return rotation, -rotation @ (-4 * forward + [0, 0, 1.0])


def write_picture(path: Path, picture: np.ndarray) -> None:
    import cv2

    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(cv2.imencode(path.suffix, picture)[1].tobytes())


def write_video(path: Path, pictures: list[np.ndarray], frame_rate: float = 60) -> None:
    from muybridge.io.video_writer import VideoWriter

    path.parent.mkdir(parents=True, exist_ok=True)
    with VideoWriter(path, frame_rate, quality=10, preset="ultrafast") as writer:
        for picture in pictures:
            writer.write(picture)


def bodytrack_folder(
    folder: Path, cameras: int = 2, frames: int = 3, *, masks: bool = True, extras: bool = True
) -> Path:
    """58 measures of 1..58 mm, a pose of 0, 0.1, 0.2 ... with its root in mm."""
    import cv2

    rng = np.random.default_rng(0)
    for n in range(1, cameras + 1):
        for frame in range(frames):
            write_picture(folder / f"CAM{n}" / f"image{frame:04d}.bmp", rng.integers(0, 255, (HEIGHT, WIDTH), np.uint8))
            if masks:
                mask = np.zeros((HEIGHT, WIDTH), np.uint8)
                mask[10:30, 20:30] = 255
                write_picture(folder / f"FG{n}" / f"image{frame:04d}.bmp", mask)
        if extras:
            write_picture(folder / f"plate{n}.bmp", np.full((HEIGHT, WIDTH), 90, np.uint8))
        rotation, translation = look_from(n)
        numbers = [60, 60, 31.5, 23.5, 0, 0, 0, 0, 0, 0, *rotation.ravel(), *(1000 * translation)]
        numbers += [*cv2.Rodrigues(rotation)[0].ravel()]
        path = folder / "CALIB" / f"Camera{n}.cal"
        path.parent.mkdir(exist_ok=True)
        path.write_text("\n".join(f"{value:.12g}" for value in numbers))
    pose = np.arange(31) / 10
    pose[3:6] = 100, 200, 900
    (folder / "BodyShapeParameters.txt").write_text("\n".join(str(value) for value in range(1, 59)))
    (folder / "InitialPose.txt").write_text(" ".join(str(value) for value in pose))
    if extras:
        (folder / "PoseParameters.txt").write_text("\n".join(str(v) for v in [*pose / 10, *pose - 1, *pose + 1]))
        np.savetxt(folder / "truth_poses.txt", np.tile(pose, (frames, 1)))
        (folder / "truth_joints.csv").write_text("pelvis_x,pelvis_y,pelvis_z\n" + "100,200,900\n" * frames)
    return folder


def camera_toml(name: str, angle: float, size: tuple[int, int] = (WIDTH, HEIGHT)) -> str:
    """One camera of a Pose2Sim calibration, metres."""
    import cv2

    rotation, translation = look_from(angle)
    vector = cv2.Rodrigues(rotation)[0].ravel().tolist()
    matrix = [[60.0, 0.0, size[0] / 2 - 0.5], [0.0, 60.0, size[1] / 2 - 0.5], [0.0, 0.0, 1.0]]
    return (
        f'[{name}]\nname = "{name}"\nsize = [{size[0]}.0, {size[1]}.0]\nmatrix = {matrix}\n'
        f"distortions = [0.0, 0.0, 0.0, 0.0]\nrotation = {vector}\n"
        f"translation = {translation.tolist()}\nfisheye = false\n"
    )


def qualisys_text(names: list[str], size: tuple[int, int] = (WIDTH, HEIGHT)) -> str:
    """A .qca.txt: lengths in mm, intrinsics in 64ths of a pixel, the camera's axes turned half about x."""
    cameras = []
    for n, name in enumerate(names):
        rotation, translation = look_from(n + 1)
        position = -1000 * rotation.T @ translation
        rows = np.diag([1.0, -1, -1]) @ rotation
        turned = " ".join(f'r{i + 1}{j + 1}="{rows[i, j]:.12f}"' for i in range(3) for j in range(3))
        place = " ".join(f'{axis}="{value:.9f}"' for axis, value in zip("xyz", position, strict=True))
        cameras.append(
            f'<camera active="1" serial="{name}">'
            f'<fov_video bottom="{size[1] - 1}" left="0" right="{size[0] - 1}" top="0"/>'
            f"<transform {turned} {place}/>"
            f'<intrinsic centerPointU="{64 * (size[0] / 2 - 0.5)}" centerPointV="{64 * (size[1] / 2 - 0.5)}"'
            ' focalLengthU="3840" focalLengthV="3840" radialDistortion1="-0.05" radialDistortion2="0" skew="0"/>'
            "</camera>"
        )
    return f"<calibration><cameras>{''.join(cameras)}</cameras></calibration>"


def moving_square(frames: int, size: tuple[int, int] = (WIDTH, HEIGHT), seed: int = 0) -> list[np.ndarray]:
    """A bright square that crosses a plain textured scene, 4 pixels a frame, and leaves it."""
    rng = np.random.default_rng(seed)
    texture = np.repeat(np.repeat(rng.integers(60, 120, (size[1] // 8, size[0] // 8, 3), dtype=np.uint8), 8, 0), 8, 1)
    pictures = []
    for frame in range(frames):
        picture = texture.copy()
        picture[16:32, 4 * frame : 4 * frame + 12] = (60, 80, 230)
        pictures.append(picture)
    return pictures


def pose2sim_folder(
    folder: Path, names: tuple[str, ...] = ("cam_01", "cam_02"), *, height: str = "1.72", frames: str = "'auto'"
) -> Path:
    """A trial of one level with two short videos."""
    (folder / "calibration").mkdir(parents=True)
    (folder / "Config.toml").write_text(CONFIG.format(height=height, frames=frames))
    (folder / "calibration" / "Calib.toml").write_text(
        "".join(camera_toml(name, n + 1) for n, name in enumerate(names))
    )
    for n in range(len(names)):
        write_video(folder / "videos" / f"cam{n + 1:02d}.mp4", moving_square(4, seed=n))
    return folder
