"""What is timed is the same work on both sides; how long it takes is not tested."""

from __future__ import annotations

import numpy as np

from muybridge.likelihood.benchmark import bench_scene, peer_log_prob, peer_silhouettes, time_likelihood
from reference.scene import SLOW


def test_the_peer_sees_what_the_kernels_see():
    """Corners rounded to pixels move each border by at most half a pixel: 550 pixels of border, half on average, of
    6300.
    """
    scene = bench_scene("bodytrack", 4)
    ours, peer = scene.cues["silhouette"].log_prob(scene.poses), peer_silhouettes(scene, scene.poses)
    np.testing.assert_allclose(ours, peer, atol=0.5 * 550 / 6300)
    assert np.all(np.isfinite(peer_log_prob(scene, scene.poses)))


def test_every_cue_and_the_peer_are_timed():
    times = {t.name: t.microseconds for t in time_likelihood("bodytrack", 16 if not SLOW else 1, 1)}
    assert {"silhouette", "colour", "boundary", "edges", "OpenCV + NumPy, silhouette"} < set(times)
    assert min(times.values()) > 0
