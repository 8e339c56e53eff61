"""Regressors as files: the same predictions, and one line for whatever is no regressor."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from muybridge.archive import checksum
from muybridge.errors import InputError
from muybridge.regression import PRINTED, WORKING, ClusterConfig, GateConfig, RegressionConfig, fit_regressor
from muybridge.regression.components import PoseComponents
from muybridge.regression.model_file import load_regressor, save_regressor
from regression.made import COMPONENTS, examples

SMALL = replace(
    WORKING,
    clusters=ClusterConfig(splits=(1, 1, 1, 1)),
    regression=RegressionConfig(frames=30),
    logistic=GateConfig(landmarks=20, iterations=50),
    trusted_variance=0.02,
)


def learnt(config=SMALL):
    data = examples(np.random.default_rng(0), 120)
    return fit_regressor(np.random.default_rng(3), *data, COMPONENTS, config, body="made")


@pytest.fixture(scope="module")
def regressor():
    return learnt()


@pytest.fixture
def file(regressor, tmp_path):
    save_regressor(tmp_path / "model.npz", regressor)
    return tmp_path / "model.npz"


def rewritten(file, change):
    """The same file with header and arrays after `change(header, arrays)`."""
    with np.load(file) as stored:
        arrays = {name: stored[name] for name in stored.files}
    header = json.loads(str(arrays.pop("header")))
    change(header, arrays)
    np.savez(file, header=np.array(json.dumps(header)), **arrays)


def refused(file, *expected, **arguments):
    with pytest.raises(InputError) as raised:
        load_regressor(file, **arguments)
    message = str(raised.value)
    assert "\n" not in message and str(file) in message
    for part in expected:
        assert part in message


AS_PRINTED = replace(PRINTED, clusters=SMALL.clusters, regression=RegressionConfig(sharing="none", frames=20))


@pytest.mark.parametrize("config", [SMALL, replace(SMALL, gate="variance"), AS_PRINTED])
def test_a_loaded_model_predicts_what_the_saved_one_did(config, tmp_path):
    saved = learnt(config)
    save_regressor(tmp_path / "model.npz", saved)
    loaded = load_regressor(tmp_path / "model.npz", COMPONENTS)
    assert (loaded.components, loaded.body, loaded.config) == (saved.components, "made", config)
    for descriptor in examples(np.random.default_rng(1), 20)[0]:
        before, after = saved.predict(descriptor), loaded.predict(descriptor)
        for name in ("weights", "means", "variances"):
            np.testing.assert_array_equal(getattr(before, name), getattr(after, name))
    assert [path.name for path in tmp_path.iterdir()] == ["model.npz"]


def test_it_is_small(file):
    """30 frames a cluster of 9 numbers in 4 bytes, 20 landmarks, the gate's 27 x 4 and 8 rows of 4 hyper-parameters in
    8 bytes: 10 kB, and 300 bytes for each of 27 entries of the zip."""
    assert file.stat().st_size < 20_000


def test_a_damaged_file(file):
    whole = file.read_bytes()
    rng = np.random.default_rng(0)
    for position in rng.integers(len(whole), size=60):
        spoilt = bytearray(whole)
        spoilt[position] ^= 0xFF
        file.write_bytes(spoilt)
        try:
            loaded = load_regressor(file)  # some bytes of a zip mean nothing, such as the time of day
        except InputError as error:
            assert "\n" not in str(error)
            continue
        np.testing.assert_array_equal(
            loaded.predict(np.zeros(6)).means, learnt_once(whole, file).predict(np.zeros(6)).means
        )
    for length in (0, 10, len(whole) // 2, len(whole) - 1):
        file.write_bytes(whole[:length])
        refused(file)


def learnt_once(whole, file):
    beside = file.with_name("whole.npz")
    beside.write_bytes(whole)
    return load_regressor(beside)


def test_a_changed_number_is_noticed(file):
    def change(header, arrays):
        arrays["cluster0_inputs"][0, 0] += 1e-3

    rewritten(file, change)
    refused(file, "checksum")


def test_later_versions_and_other_kinds(file, tmp_path):
    rewritten(file, lambda header, arrays: header.update(version=2))
    refused(file, "version", "expected 1, got 2")
    rewritten(file, lambda header, arrays: header.update(format="something"))
    refused(file, "another kind")
    np.savez(file, a=np.zeros(3))
    refused(file, "another kind")
    file.write_text("not a zip at all")
    refused(file)
    refused(tmp_path / "nowhere.npz", "expected a file")


def test_nothing_is_unpickled(file):
    np.savez(file, header=np.array([{"format": "muybridge-regressor"}], dtype=object))
    refused(file, "allow_pickle=False")


def test_a_file_that_lacks_a_part(file):
    def change(header, arrays):
        del arrays["cluster2_hyper"]
        header["checksum"] = checksum(arrays)

    rewritten(file, change)
    refused(file, "all parts", "cluster2_hyper")


def test_a_model_for_another_body(file):
    other = PoseComponents(("yaw", "left_hip", "tail"), (0,), 0)
    refused(file, "for a body of these 3 turns", "'made'", "right_hip", components=other)
    refused(file, "which of them wrap", components=PoseComponents(COMPONENTS.names, (0, 1), 0))


def test_what_cannot_be_written_leaves_the_old_file(regressor, file, monkeypatch):
    before = file.read_bytes()

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", full)
    with pytest.raises(InputError, match="No space left"):
        save_regressor(file, regressor)
    assert file.read_bytes() == before
    assert [path.name for path in file.parent.iterdir()] == ["model.npz"]
    monkeypatch.undo()
    with pytest.raises(InputError, match="No such file"):
        save_regressor(file.parent / "nowhere" / "model.npz", regressor)
