"""Every mixture of cues through every filter and through a whole job, on a rendered person of three frames.

What is bounded is only that the person stays in hand (the scene moves little, and few particles are drawn); how exact
each mixture is on whole scenes is in docs/benchmarks.md.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import cv2
import msgspec
import numpy as np
import pytest

from muybridge.body import named_body
from muybridge.errors import InputError
from muybridge.filters import METHODS
from muybridge.io import job as jobs
from muybridge.likelihood.colour import measure_reference
from muybridge.likelihood.cues import CueWeights
from muybridge.likelihood.observation import ImageLikelihood
from muybridge.synthetic.scene import Scene, demo_scene, render, truth
from muybridge.synthetic.write import write_scene
from muybridge.tracking.run import run
from muybridge.tracking.start import automatic_start
from muybridge.tracking.tracker import Tracker, TrackerConfig, TrackState

CUES = ("silhouette", "colour", "boundary", "edges")
MIXTURES = [names for size in (1, 2, 4) for names in combinations(CUES, size)]
REDUCTION, FRAMES = 4, 3


def weights_of(names: tuple[str, ...], kind: str = "two-sided") -> CueWeights:
    return CueWeights(**{name: float(name in names) for name in CUES}, silhouette_kind=kind)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return demo_scene(seed=1, duration=FRAMES / 25)


@pytest.fixture(scope="module")
def frames(scene: Scene) -> list:
    """(pictures, masks) of every frame."""
    return [render(scene, frame) for frame in range(FRAMES)]


@pytest.fixture(scope="module")
def plain(scene: Scene) -> ImageLikelihood:
    body = named_body("person")
    return ImageLikelihood(body, scene.rig, (REDUCTION,) * len(scene.rig))


@pytest.fixture(scope="module")
def start(plain: ImageLikelihood, frames: list) -> np.ndarray:
    return automatic_start(plain.observe(frames[0][1])).pose


def tracker_of(plain: ImageLikelihood, method: str, cues: CueWeights) -> Tracker:
    config = replace(METHODS[method].WORKING, particles=40)
    return Tracker(replace(plain, cues=cues), 1 / 25, TrackerConfig(method, config))


def follow(tracker: Tracker, state: TrackState, frames: list, first: int = 0):
    for index, (pictures, masks) in enumerate(frames, first):
        state, estimate = tracker.step(np.random.default_rng(index), state, masks, pictures)
    return state, estimate


class TestEveryMixture:
    @pytest.mark.parametrize("names", MIXTURES, ids="+".join)
    @pytest.mark.parametrize("method", METHODS)
    def test_keeps_the_person_in_hand(self, plain, start, frames, scene, method: str, names: tuple[str, ...]) -> None:
        tracker = tracker_of(plain, method, weights_of(names))
        state, estimate = follow(tracker, tracker.init(np.random.default_rng(0), start), frames)
        pelvis = plain.body.joint_names.index("pelvis")
        assert estimate.status in ("tracked", "doubtful")
        assert np.linalg.norm(estimate.joints[pelvis] - truth(scene).joints[FRAMES - 1, 0]) < 0.3
        assert (state.reference is not None) == ("colour" in names)

    @pytest.mark.parametrize("kind", ["two-sided", "one-sided", "iou"])
    def test_kinds_of_silhouette_prefer_the_person_to_a_shifted_one(self, plain, start, frames, kind: str) -> None:
        observed = replace(plain, cues=weights_of(("silhouette",), kind)).observe(frames[0][1])
        here, away = observed.log_prob(np.stack([start, start + np.eye(len(start))[0] * 0.3]))
        assert here > away


def test_colour_counts_segments_by_area_or_all_alike(plain, start, frames) -> None:
    """The switch reaches the cue: both prefer the person, and they differ."""
    pictures, masks = frames[0]
    poses = np.stack([start, start + np.eye(len(start))[0] * 0.3])
    values = []
    for by_area in (True, False):
        cues = CueWeights(silhouette=0.0, colour=1.0, colour_by_area=by_area)
        observed = replace(plain, cues=cues).observe(masks, pictures)
        observed = replace(observed, reference=observed.first_reference(start))
        values.append(observed.log_prob(poses))
        assert values[-1][0] > values[-1][1]
    assert not np.allclose(*values)


class TestTheDefault:
    def test_is_the_two_sided_silhouette_to_the_bit(self, plain, start, frames) -> None:
        observed = plain.observe(frames[0][1])
        poses = start + np.random.default_rng(0).normal(0, 0.05, (20, len(start)))
        expected = -np.einsum("nc,c->n", observed.costs(poses), np.ones(len(plain.rig))) / len(plain.rig)
        assert observed.pictures == () and np.array_equal(observed.log_prob(poses), expected)

    def test_is_what_the_fused_cue_says(self, plain, start, frames) -> None:
        """Bound: rounding of sums of numbers of order 1."""
        model = replace(plain, weights=(1.0, 3.0, 0.0))
        observed = model.observe(frames[0][1])
        poses = start + np.random.default_rng(0).normal(0, 0.05, (20, len(start)))
        assert np.allclose(observed.fusion.log_prob(poses), observed.log_prob(poses), rtol=0, atol=1e-12)

    def test_only_ratios_of_weights_count(self, plain, start, frames) -> None:
        mixtures = [CueWeights(silhouette=scale, boundary=2 * scale) for scale in (1.0, 5.0)]
        values = [replace(plain, cues=mixture).observe(frames[0][1]).log_prob(start) for mixture in mixtures]
        assert np.allclose(*values, rtol=1e-14)

    def test_a_camera_of_no_weight_says_nothing(self, plain, start, frames) -> None:
        pictures, masks = frames[0]
        model = replace(plain, cues=weights_of(CUES), weights=(1.0, 1.0, 0.0))
        reference = model.observe(masks, pictures).first_reference(start)
        black = [*pictures[:2], np.zeros_like(pictures[2])], [*masks[:2], np.zeros_like(masks[2])]
        values = [model.observe(m, p, reference).log_prob(start) for p, m in ((pictures, masks), black)]
        assert np.array_equal(*values)


class TestColourReference:
    def test_survives_a_checkpoint_to_the_bit(self, plain, start, frames) -> None:
        tracker = tracker_of(plain, "annealed", weights_of(("silhouette", "colour")))
        state, _ = follow(tracker, tracker.init(np.random.default_rng(0), start), frames[:2])
        again = tracker.restore(state.to_arrays())
        ends = [follow(tracker, s, frames[2:], 2)[1].pose for s in (state, again)]
        assert np.array_equal(*ends)
        forgotten, _ = follow(tracker, replace(again, reference=None), frames[2:], 2)
        assert not np.array_equal(forgotten.reference.histograms, state.reference.histograms), "control: it matters"

    def test_follows_the_light(self, plain, start, frames) -> None:
        """(5.7) with its rate of 0.1: nine tenths of what was, one tenth of what is."""
        pictures, masks = frames[0]
        model = replace(plain, cues=weights_of(("colour",)))
        reference = model.observe(masks, pictures).first_reference(start)
        darker = [picture // 2 for picture in pictures]
        followed = model.observe(masks, darker, reference).updated_reference(start)
        observed = model.observe(masks, darker)
        dark = measure_reference(model.body.arrays, model.cameras, observed.tables, start)
        expected = 0.1 * dark.histograms + 0.9 * reference.histograms
        assert dark.known.any() and np.allclose(followed.histograms[dark.known], expected[dark.known], atol=1e-12)
        assert np.abs(dark.histograms - reference.histograms)[dark.known].max() > 0.1, "control: the light changed"


class TestBadInput:
    @pytest.mark.parametrize("name", ["colour", "edges"])
    def test_pictures_are_asked_for(self, plain, frames, name: str) -> None:
        with pytest.raises(InputError, match="pictures: expected one for each camera.*got none; give pictures"):
            replace(plain, cues=weights_of((name,))).observe(frames[0][1])

    def test_too_few_pictures(self, plain, frames) -> None:
        with pytest.raises(InputError, match="pictures: expected one for each of the 3 cameras, got 1"):
            replace(plain, cues=weights_of(("edges",))).observe(frames[0][1], frames[0][0][:1])

    def test_pictures_of_another_size(self, plain, frames) -> None:
        with pytest.raises(InputError, match="picture of camera .*640x480"):
            replace(plain, cues=weights_of(("edges",))).observe(frames[0][1], [p[:100] for p in frames[0][0]])

    @pytest.mark.parametrize("channels", [1, 3])
    def test_colour_in_grey_pictures(self, plain, start, frames, channels: int) -> None:
        pictures, masks = frames[0]
        grey = [cv2.cvtColor(p, cv2.COLOR_BGR2GRAY) for p in pictures]
        grey = grey if channels == 1 else [np.dstack([g] * 3) for g in grey]
        tracker = tracker_of(plain, "annealed", weights_of(("colour",)))
        with pytest.raises(InputError, match="expected colour pictures.*got grey ones; set the weight of colour to 0"):
            follow(tracker, tracker.init(np.random.default_rng(0), start), [(grey, masks)])

    def test_weights(self) -> None:
        for weights in ({"silhouette": 0.0}, {"edges": -1.0}, {"colour": np.nan}):
            with pytest.raises(InputError, match="cue weights"):
                CueWeights(**weights)
        with pytest.raises(InputError, match="silhouette kind: expected one of iou, two-sided, one-sided"):
            CueWeights(silhouette_kind="three-sided")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, start: np.ndarray) -> Path:
    folder = tmp_path_factory.mktemp("scene")
    write_scene(demo_scene(seed=1, duration=4 / 25), folder)
    names = named_body("person").dof_names
    pose = "\n".join(f"{name} = {value}" for name, value in zip(names, start, strict=True))
    (folder / "start.toml").write_text(pose)
    return folder


class TestWholeJob:
    @pytest.mark.parametrize("masks", [False, True], ids=["plate", "ready-made"])
    def test_all_cues_and_resumed(self, folder: Path, tmp_path: Path, monkeypatch, masks: bool) -> None:
        """Pictures are read beside ready-made masks; an interrupted run ends in the same bytes."""
        settings = ["likelihood={silhouette=1, colour=1, boundary=1, edges=1, reduction=4}", "filter.name=annealed",
                    "filter.particles=30", "filter.layers=3", "body.fit=false", "start.pose=start.toml"]  # fmt: skip
        job = jobs.read(folder / "job.toml", settings)
        if masks:
            paths = [folder / f"{camera.name}_mask.mp4" for camera in job.cameras]
            pairs = zip(job.cameras, paths, strict=True)
            ready = tuple(msgspec.structs.replace(camera, background=None, masks=path) for camera, path in pairs)
            job = msgspec.structs.replace(job, cameras=ready)
        run(job, tmp_path / "whole")
        monkeypatch.setattr(sys.modules["muybridge.tracking.run"], "CHECKPOINT_EVERY", 2)

        def stop(done: int, total: int) -> None:
            if done == 3:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            run(job, tmp_path / "parts", stop)
        run(job, tmp_path / "parts", resume=True)
        assert (tmp_path / "parts" / "joints.csv").read_bytes() == (tmp_path / "whole" / "joints.csv").read_bytes()
