"""Features by hand, what the four machines say together, and the file they are kept in."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from muybridge.archive import checksum
from muybridge.errors import InputError
from muybridge.people.failure import (
    FailureDetector,
    History,
    detector_named,
    load_detector,
    relative_states,
    save_detector,
)
from muybridge.people.support_vectors import SupportVectors

STATES = np.array([[10.0, 20, 8, 10, 1, 0], [12, 40, 20, 30, 2, 1], [11, 66, 18, 20, 3, -1]])


def machine(feature: int, limit: float, size: int = 36) -> SupportVectors:
    """Above 0 while one feature is near 0: exp(-f^2) against exp(-limit^2)."""
    scale = np.full(size, 1e6)
    scale[feature] = 1.0
    return SupportVectors(np.zeros((1, size)), np.ones(1), np.zeros(size), scale, -float(np.exp(-(limit**2))), 1.0)


DETECTOR = FailureDetector((machine(0, 0.2), machine(6, 0.2), machine(12, 0.2)), machine(1, 0.5))


def test_relative_states_by_hand() -> None:
    found = relative_states(STATES, 50.0, 10.0).reshape(3, 6)
    np.testing.assert_allclose(found[0], [-1 / 50, -22 / 50, (8 - 46 / 3) / 50, -10 / 50, -10 / 50, 0], atol=1e-12)
    np.testing.assert_allclose(found.sum(axis=0), 0, atol=1e-12)  # (5.7): against their mean


def test_neither_place_nor_distance_nor_frame_rate_matter() -> None:
    moved = STATES + np.array([100.0, -7, 0, 0, 0, 0])
    np.testing.assert_allclose(relative_states(moved, 50, 10), relative_states(STATES, 50, 10))
    np.testing.assert_allclose(relative_states(2 * STATES, 100, 10), relative_states(STATES, 50, 10))
    twice_as_often = STATES / np.array([1, 1, 1, 1, 2, 2])
    np.testing.assert_allclose(relative_states(twice_as_often, 50, 20), relative_states(STATES, 50, 10))


def test_changes_are_over_half_a_second() -> None:
    history = History(10.0)
    for frame in range(8):
        states = STATES.copy()
        states[0, 0] += frame
        found = history.features(states, 50.0)
        assert (found is None) == (frame < 5)
    assert found is not None
    np.testing.assert_allclose(found[18], 5 / 50 * 2 / 3)  # the head moved 5 pixels, a third of it is the mean's
    history.forget()
    assert history.features(STATES, 50.0) is None


def test_none_one_or_all() -> None:
    features = np.zeros(36)
    assert not DETECTOR.failed(features).any()
    features[6] = 0.5
    assert DETECTOR.failed(features).tolist() == [False, True, False]
    features[0] = 0.3
    assert DETECTOR.failed(features).tolist() == [False, True, False]  # the worse one
    features[1] = 0.7
    assert DETECTOR.failed(features).all()
    features[[0, 6]] = 0.0
    assert not DETECTOR.failed(features).any()  # the fourth is only asked when one has failed


def test_a_file_keeps_what_it_says(tmp_path: Path) -> None:
    save_detector(tmp_path / "repair.npz", DETECTOR, {"seed": 3})
    loaded = load_detector(tmp_path / "repair.npz")
    features = np.random.default_rng(0).normal(0, 0.3, (50, 36))
    for one, other in zip((*loaded.parts, loaded.several), (*DETECTOR.parts, DETECTOR.several)):
        np.testing.assert_array_equal(one.margins(features), other.margins(features))
    assert detector_named("none") is None
    assert isinstance(detector_named(str(tmp_path / "repair.npz")), FailureDetector)


def test_the_shipped_one_is_whole() -> None:
    detector = detector_named("shipped")
    assert detector is not None and len(detector.parts) == 3
    assert all(machine.vectors.shape[1] == 36 for machine in (*detector.parts, detector.several))


def test_bad_files_are_one_line(tmp_path: Path) -> None:
    path = tmp_path / "repair.npz"

    def refused(*words: str) -> None:
        with pytest.raises(InputError) as raised:
            load_detector(path)
        message = str(raised.value)
        assert "\n" not in message and str(path) in message and all(word in message for word in words), message

    refused("expected a file")
    path.write_text("no zip")
    refused("train-repair")
    save_detector(path, DETECTOR)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    refused()
    path.write_bytes(whole)
    with np.load(path) as stored:
        arrays = {name: stored[name] for name in stored.files}
    header = json.loads(str(arrays.pop("header")))

    def rewrite(header: dict) -> None:
        np.savez(path, header=np.array(json.dumps(header)), **arrays)

    rewrite({**header, "format": "muybridge-regressor"})
    refused("another kind")
    rewrite({**header, "version": 7})
    refused("version")
    arrays["head_vectors"] = arrays["head_vectors"] + 1
    rewrite(header)
    refused("checksum")
    arrays["head_vectors"] = np.full((1, 36), np.nan)
    rewrite({**header, "checksum": checksum(arrays)})
    refused("support vectors")
    del arrays["torso_scale"]
    rewrite({**header, "checksum": checksum(arrays)})
    refused("four machines")
