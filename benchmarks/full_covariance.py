"""What the block-diagonal joint covariance of the spatial background model costs, against the full 6 x 6 of the text.

    python benchmarks/full_covariance.py [--seeds 901 902 903] [--scenes calm lamp door linger]

Zhao (2009, 3.2 to 3.6) keeps a covariance for each of K x K combinations of two pixels' components, 0.5 GB at
320 x 240; the product takes the two components' own variances. Here all judge the same rendered clips of 160 x 120:

product     as the product is
diagonal    six variances for each combination
blocks      also covariances between a pixel's channels
full        also covariances between the two pixels

Combinations and means are always those of the product. The last three differ in nothing but what of a covariance is
learnt: it begins as the product's, and is learnt about these means, 1 / n at first and then at `pair_rate`. Prints
false positives where 80 % of the foreground is found, per cent, and how long a judged picture takes.
"""

from __future__ import annotations

import argparse
import math
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from muybridge._kernels.mixture import TAIL
from muybridge.experiments.zhao_2009.hall import HAPPENS, HallClip
from muybridge.experiments.zhao_2009.subtraction import FOUND, BackgroundTrial
from muybridge.segmentation import registry, settings_at
from muybridge.segmentation.pictures import learn_each
from muybridge.segmentation.spatial import OFFSETS, SpatialBackground, SpatialConfig

PRIOR = 5.0  # pictures that the product's covariance counts for
KINDS = {"diagonal": np.eye(6), "blocks": np.kron(np.eye(2), np.ones((3, 3))), "full": np.ones((6, 6))}


@numba.njit(cache=True)
def _squared_and_root(covariance, off):
    """Mahalanobis distance squared of `off` (6,), written over, and the root of the determinant of (6, 6)."""
    root = np.zeros((6, 6))
    squared, determinant = 0.0, 1.0
    for i in range(6):
        for j in range(i + 1):
            value = float(covariance[i, j])
            for k in range(j):
                value -= root[i, k] * root[j, k]
            root[i, j] = math.sqrt(max(value, 1e-3)) if i == j else value / root[j, j]
        for k in range(i):
            off[i] -= root[i, k] * off[k]
        off[i] /= root[i, i]
        squared += off[i] * off[i]
        determinant *= root[i, i]
    return squared, determinant


@numba.njit(cache=True)
def _offsets(image, means, a, i, b, j, off):
    for c in range(3):
        off[c] = image[a[0], a[1], c] - means[a[0], i, c, a[1]]
        off[3 + c] = image[b[0], b[1], c] - means[b[0], j, c, b[1]]


@numba.njit(cache=True)
def _joint(image, means, kept, counts, totals, covariances, d, a, b):
    """P(c0, ci) over evenly spread colours, of the pair d of pixels a and b; falls as the product's does."""
    both, off = 0.0, np.empty(6)
    for i in range(counts.shape[2]):
        for j in range(counts.shape[2]):
            count = counts[a[0], d, i, j, a[1]]
            if count > 0 and kept[a] >> i & 1 and kept[b] >> j & 1:
                _offsets(image, means, a, i, b, j, off)
                squared, root = _squared_and_root(covariances[a[0], a[1], d, i, j], off)
                near = min(squared, 2 * TAIL)
                fall = math.exp(-near / 2) * (2 * TAIL / max(squared, 2 * TAIL)) ** TAIL
                both += count / totals[d, a[0], a[1]] * fall / root * (256.0 / math.sqrt(2 * math.pi)) ** 6
    return both


@numba.njit(cache=True)
def _scores(image, means, kept, alone, densities, counts, totals, covariances, partners, least, out):
    for y in range(out.shape[0]):
        for x in range(out.shape[1]):
            out[y, x] = -math.log(max(float(alone[y, x]), 1e-37))
            for n in range(partners.shape[2]):
                partner = partners[y, x, n]
                if partner < 0:
                    continue
                d, sign = partner >> 1, -1 if partner & 1 else 1
                q = (y + sign * OFFSETS[d, 0], x + sign * OFFSETS[d, 1])
                a, b = ((y, x), q) if sign > 0 else (q, (y, x))
                if totals[d, a[0], a[1]] == 0:
                    continue
                rare = 0.0
                for i in range(counts.shape[2]):
                    for j in range(counts.shape[2]):
                        own = densities[q[0], j if sign > 0 else i, q[1]]
                        rare += counts[a[0], d, i, j, a[1]] * own / totals[d, a[0], a[1]]
                rare = max(rare, 1e-37)
                both = max(_joint(image, means, kept, counts, totals, covariances, d, a, b), 1e-60)
                out[y, x] -= math.log(both * (least / rare if rare < least else 1.0))


@numba.njit(cache=True)
def _update(image, means, variances, matched, fresh, counts, covariances, kind, rate, floor):
    """(3.5) of the combinations that matched; `counts` already have this picture."""
    off = np.empty(6)
    for y in range(matched.shape[0]):
        for x in range(matched.shape[1]):
            for d in range(OFFSETS.shape[0]):
                v, u = y + OFFSETS[d, 0], x + OFFSETS[d, 1]
                if v >= matched.shape[0] or not 0 <= u < matched.shape[1]:
                    continue
                for i in range(counts.shape[2]):
                    for j in range(counts.shape[2]):
                        new = fresh[y, x] == i or fresh[v, u] == j
                        hit = matched[y, x] == i and matched[v, u] == j
                        if not new and not hit:
                            continue
                        joint = covariances[y, x, d, i, j]
                        if new or counts[y, d, i, j, x] <= 1.0:
                            joint[:] = 0.0
                            for c in range(3):
                                joint[c, c] = variances[y, i, c, x]
                                joint[3 + c, 3 + c] = variances[v, j, c, u]
                        if hit:
                            _offsets(image, means, (y, x), i, (v, u), j, off)
                            share = max(rate, 1.0 / (counts[y, d, i, j, x] + PRIOR))
                            for r in range(6):
                                for c in range(6):
                                    joint[r, c] += share * (off[r] * off[c] * kind[r, c] - joint[r, c])
                                joint[r, r] = max(joint[r, r], floor)


class FullBackground(SpatialBackground):
    """The spatial model with a covariance for each combination of each pair, of which `kind` (6, 6) is learnt."""

    def __init__(self, shape: tuple[int, ...], config: SpatialConfig | None, kind: NDArray) -> None:
        super().__init__(shape, config)
        self.kind = kind
        slots = self.config.components
        self.covariances = np.zeros((*shape[:2], len(OFFSETS), slots, slots, 6, 6), np.float32)

    @classmethod
    def of_kind(cls, kind: NDArray, pictures: Any, config: SpatialConfig | None = None) -> FullBackground:
        return learn_each(pictures, lambda shape: cls(shape, config, kind))

    def _judged(self, picture: NDArray) -> tuple[NDArray, NDArray]:
        out, look, of = np.empty(picture.shape[:2], np.float32), self.mixtures.look(picture), self.mixtures
        _scores(picture, of.means, of.kept, look.alone, look.densities, self.counts, self.totals, self.covariances,
                self.partners, math.exp(-self.config.partner_limit * picture.shape[2]), out)  # fmt: skip
        return out, look.nearest

    def _learn(self, picture: NDArray, nearest: NDArray, learnt: NDArray) -> None:
        super()._learn(picture, nearest, learnt)
        of, config = self.mixtures, self.config
        _update(picture, of.means, of.variances, of.matched, of.fresh, self.counts, self.covariances,
                self.kind, config.pair_rate, config.sd_floor**2)  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=[901, 902, 903])
    parser.add_argument("--scenes", nargs="+", default=list(HAPPENS))
    arguments = parser.parse_args()
    for name, kind in KINDS.items():
        build = partial(FullBackground.of_kind, kind)
        registry.BACKGROUND_MODELS[name] = registry.ModelEntry(SpatialConfig, build)
    with tempfile.TemporaryDirectory() as folder:
        for seed in arguments.seeds:
            for scene in arguments.scenes:
                clip = HallClip(scene, seed, 16.0, 10.0, (160, 120))
                clip.prepare(Path(folder), ())
                told = [f"seed {seed} {scene}:"]
                for label, model in {"product": "spatial", **{name: name for name in KINDS}}.items():
                    trial = BackgroundTrial(clip, model, tuple(settings_at("spatial", clip.rate).items()))
                    begin = time.process_time()
                    result = trial.run(Path(folder))
                    took = 1000 * (time.process_time() - begin) / len(result.false_where_found)
                    told.append(f"{label} {100 * result.false_rate_at(FOUND):.3f} % ({took:.0f} ms)")
                print(*told, flush=True)


if __name__ == "__main__":
    main()
