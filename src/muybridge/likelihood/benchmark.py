"""How long an evaluation of the likelihood takes, and how long it takes as most would write it: OpenCV and NumPy,
pose by pose.

Times are CPU time of this process on one thread, the best of several, per evaluation and camera, kinematic chain
included: a 320 x 240 picture in which the person fills 200 rows. The peer does the same work: it fills convex
polygons, takes histograms under masks, finds contours and transforms them.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numba
import numpy as np

from muybridge._kernels.bits import pack_rows
from muybridge.body.load import named_body
from muybridge.body.model import Body
from muybridge.cameras.model import Camera
from muybridge.likelihood.boundary import BoundaryCue, descriptors_of
from muybridge.likelihood.colour import ColourCue, colour_tables, measure_reference
from muybridge.likelihood.edges import EdgeCue, edge_map
from muybridge.likelihood.fusion import Cue, Fusion, fuse
from muybridge.likelihood.pictures import camera_rows
from muybridge.likelihood.silhouette import SilhouetteCue

WIDTH, HEIGHT, PERSON_ROWS, DISTANCE = 320, 240, 200, 3.5  # pixels, pixels, pixels, metres
ROUND = 16  # points that the peer takes round each end


@dataclass(frozen=True)
class Timing:
    """Microseconds of CPU time per evaluation and camera."""

    name: str
    microseconds: float


@dataclass(frozen=True, eq=False)
class BenchScene:
    """A standing body, poses round it (N, D), one camera, and the cues of a picture of it."""

    body: Body
    camera: Camera
    poses: np.ndarray
    image: np.ndarray
    mask: np.ndarray
    cues: dict[str, Cue]


def bench_scene(body_name: str, particles: int = 512, seed: int = 0) -> BenchScene:
    """The scene that is timed: every pixel of the picture is random, blurred, so that no bin is empty."""
    rng = np.random.default_rng(seed)
    body = named_body(body_name)
    pose = _upright(body)
    camera = _camera(body.joints(pose))
    steps = np.r_[np.full(3, 0.03), np.full(3, 0.05), np.full(len(pose) - 6, 0.15)]  # metres, radians
    noise = cv2.blur(rng.integers(0, 256, (HEIGHT, WIDTH, 3), dtype=np.uint8), (9, 9))
    image = cv2.normalize(noise, np.empty_like(noise), 0, 255, cv2.NORM_MINMAX)
    mask = peer_silhouette(body, camera, pose)[0]
    arrays, rows, tables = body.arrays, camera_rows([camera]), colour_tables([image])
    cues: dict[str, Cue] = {
        "silhouette": SilhouetteCue(arrays, rows, pack_rows(mask)[None], np.array([mask.sum()])),
        "colour": ColourCue(arrays, rows, tables, measure_reference(arrays, rows, tables, pose)),
        "boundary": BoundaryCue(arrays, rows, (WIDTH, HEIGHT), *descriptors_of([mask])),
        "edges": EdgeCue(arrays, rows, edge_map(image, mask)[None]),
    }
    return BenchScene(body, camera, pose + rng.normal(size=(particles, len(pose))) * steps, image, mask, cues)


def _upright(body: Body) -> np.ndarray:
    pose = np.zeros(len(body.dof_names))
    if np.ptp(body.joints(pose)[:, 2]) < 0.5 * body.height:
        pose[3] = np.pi / 2
    return pose


def _camera(joints: np.ndarray) -> Camera:
    """Level, DISTANCE away, the joints (J, 3) and what sticks out beyond them PERSON_ROWS tall."""
    rotation = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    middle = (joints.min(axis=0) + joints.max(axis=0)) / 2
    focal = PERSON_ROWS * DISTANCE / (np.ptp(joints[:, 2]) + 0.15)
    matrix = np.array([[focal, 0.0, WIDTH / 2], [0.0, focal, HEIGHT / 2], [0.0, 0.0, 1.0]])
    return Camera(
        "bench", (WIDTH, HEIGHT), matrix, np.zeros(5), rotation, np.array([0.0, 0.0, DISTANCE]) - rotation @ middle
    )


def time_likelihood(body_name: str = "bodytrack", particles: int = 512, repeats: int = 7) -> list[Timing]:
    """Times of the cues alone and together, and of the peer with the same three cues."""
    scene = bench_scene(body_name, particles)
    three = fuse(scene.cues["silhouette"], scene.cues["colour"], scene.cues["boundary"])
    everything = Fusion(tuple(scene.cues.values()), (1.0,) * len(scene.cues))
    subjects = {**scene.cues, "silhouette + colour + boundary": three, "all four": everything}
    threads, opencv_threads = numba.get_num_threads(), cv2.getNumThreads()
    numba.set_num_threads(1)
    cv2.setNumThreads(1)
    try:
        times = [
            Timing(name, 1e6 * fastest(lambda cue=cue: cue.log_prob(scene.poses), repeats) / particles)  # type: ignore[misc]
            for name, cue in subjects.items()
        ]
        few = scene.poses[: max(1, particles // 16)]
        times.append(
            Timing(
                "OpenCV + NumPy, silhouette", 1e6 * fastest(lambda: peer_silhouettes(scene, few), repeats) / len(few)
            )
        )
        times.append(
            Timing("OpenCV + NumPy, three cues", 1e6 * fastest(lambda: peer_log_prob(scene, few), repeats) / len(few))
        )
    finally:
        numba.set_num_threads(threads)
        cv2.setNumThreads(opencv_threads)
    return times


def fastest(call: Callable[[], object], repeats: int) -> float:
    """Seconds of CPU time of the fastest of several calls, after one that compiles."""
    call()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return min(times)


def peer_silhouette(body: Body, camera: Camera, pose: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """The model's silhouette (H, W) bool, and every segment's visible pixels, nearest segment first."""
    arrays = body.arrays
    frames = body.frames(pose[None])[0]
    angle = np.linspace(0, 2 * np.pi, ROUND, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    shapes = []
    for s in arrays.shaped:
        rims = arrays.ends[s][:, None] + np.concatenate(
            [circle @ arrays.half_axes[s][:, pair] for pair in ([0, 1], [0, 2], [1, 2])], 1
        )
        world = rims.reshape(-1, 3) @ frames[s, :, :3].T + frames[s, :, 3]
        depth = camera.world_to_camera(world)[:, 2].mean()
        shapes.append((depth, s, cv2.convexHull(camera.world_to_pixel(world).astype(np.float32))))
    occupied, visible = np.zeros((HEIGHT, WIDTH), np.uint8), []
    for _, _, corners in sorted(shapes, key=lambda shape: shape[0]):
        one = np.zeros((HEIGHT, WIDTH), np.uint8)
        cv2.fillConvexPoly(one, np.round(corners).astype(np.int32), 1)
        visible.append(one & ~occupied & 1)
        occupied |= one
    return occupied.astype(bool), visible


def peer_silhouettes(scene: BenchScene, poses: np.ndarray) -> np.ndarray:
    """log p1 of poses (N, D), one by one."""
    out = np.empty(len(poses))
    for n, pose in enumerate(poses):
        model, _ = peer_silhouette(scene.body, scene.camera, pose)
        out[n] = np.log(np.count_nonzero(model & scene.mask) / np.count_nonzero(model | scene.mask))
    return out


def peer_log_prob(scene: BenchScene, poses: np.ndarray) -> np.ndarray:
    """log p1 + log p2 + log p3 of poses (N, D), one by one, against a reference of equal bins and a zero descriptor."""
    out = np.empty(len(poses))
    reference = np.full(10, np.sqrt(0.1))
    for n, pose in enumerate(poses):
        model, visible = peer_silhouette(scene.body, scene.camera, pose)
        total, area = 0.0, sum(int(v.sum()) for v in visible)
        for pixels in visible:
            own = int(pixels.sum())
            for channel in range(3) if own else ():
                counts = cv2.calcHist([scene.image], [channel], pixels, [10], [0, 256]).ravel() / own
                total += own / area * np.sqrt(max(0.0, 1.0 - float(np.sqrt(counts) @ reference)))
        contours, _ = cv2.findContours(model.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        border = max(contours, key=cv2.contourArea).reshape(-1, 2)
        places = np.arange(256) * len(border) / 256
        curve = [np.interp(places, np.arange(len(border)), border[:, axis], period=len(border)) for axis in range(2)]
        descriptor = np.fft.fft(curve[0] + 1j * curve[1]) / 256
        iou = np.count_nonzero(model & scene.mask) / np.count_nonzero(model | scene.mask)
        out[n] = np.log(iou) - total**2 - 0.1 * np.linalg.norm(descriptor[np.arange(-50, 50)])
    return out
