"""What the regressor says by itself: Table III (gates), Figs. 8 and 9 (variance and alpha), Fig. 13 (two modes)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from muybridge.experiments.bodies import body_of_trial
from muybridge.experiments.clips import Evidence, evidence_of
from muybridge.experiments.experiment import Outcome, Part, Report, Scale
from muybridge.experiments.sedai_2013.conditions import model_of, one_camera
from muybridge.experiments.tables import Cell, Column, Table
from muybridge.experiments.trial import EVIDENCE, Clip, Trial
from muybridge.likelihood.observation import ImageLikelihood
from muybridge.plotting.style import new_figure
from muybridge.regression import PRINTED_TRUSTED_VARIANCE, PoseMixture, SilhouetteRegressor
from muybridge.tracking.silhouette_guesser import SilhouetteGuesser

GATE_SEEDS, EVERY = 3, 3
LAMBDAS = (0.001, 0.003, 0.01)  # square radians, of Fig. 9


def guesses(
    clip: Clip, evidence: Evidence, regressor: SilhouetteRegressor, **settings: float
) -> tuple[list[PoseMixture], np.ndarray, np.ndarray]:
    """Each looked-at frame's mixture; the root-aligned error, mm, of its most probable mode, and of its nearest."""
    body = body_of_trial(Trial(clip), evidence)
    guesser = SilhouetteGuesser.of(regressor, ImageLikelihood(body, evidence.rig, evidence.reductions), **settings)
    truth = evidence.truth
    own = [truth.names.index(name) for name in body.joint_names if name in truth.names]
    theirs = [body.joint_names.index(truth.names[column]) for column in own]
    root = body.joint_names.index("pelvis")
    mixtures, first, nearest = [], [], []
    for frame in range(0, len(evidence.joints), EVERY):
        masks = [view[frame] for view in evidence.own]
        mixture, guess = guesser.mixture(masks), guesser.guess(masks)
        if mixture is None or guess is None:
            continue
        joints = body.joints(guess.poses(np.zeros(len(body.dof_names))))
        true = evidence.joints[frame, own] - evidence.joints[frame, truth.names.index("pelvis")]
        away = np.linalg.norm(joints[:, theirs] - joints[:, [root]] - true, axis=-1).mean(axis=1) * 1e3
        mixtures.append(mixture)
        first.append(away[int(np.argmax(guess.weights))])
        nearest.append(away.min())
    return mixtures, np.array(first), np.array(nearest)


def clips_of(scale: Scale) -> tuple[Clip, ...]:
    """Those that are guessed in: the first seeds', before three cameras."""
    return scale.clips(seeds=scale.few(GATE_SEEDS))


def report_of_gates(outcome: Outcome) -> Report:
    """Errors of the guess alone, by gate and by how many cameras are asked."""
    regressor = model_of(outcome.scale, outcome.folder)
    columns = (Column("gate"), Column("cameras"), *(Column(f"{motion} mm") for motion in outcome.scale.motions),
               Column("nearest mode mm"), Column("frames", 0))  # fmt: skip
    rows: list[tuple[Cell, ...]] = []
    for gate, model in (("multinomial logistic", regressor), ("by variance", without_gate(regressor))):
        for label, settings in (("first alone", {"only": 0}), ("all, no votes", {"agreement": 0.0}), ("all", {})):
            by_motion: dict[str, list[np.ndarray]] = {motion: [] for motion in outcome.scale.motions}
            nearest = []
            for clip in clips_of(outcome.scale):
                evidence = evidence_of(clip, outcome.folder / EVIDENCE)
                _, first, best = guesses(clip, evidence, model, **settings)
                by_motion[clip.motion].append(first)
                nearest.append(best)
            means = [float(np.concatenate(found).mean()) for found in by_motion.values()]
            rows.append((gate, label, *means, float(np.concatenate(nearest).mean()), sum(map(len, nearest))))
    notes = ("Root-aligned error of the most probable mode, people and takes that were not learnt from.",)
    return Report((Table("table3", "The regressor by itself (Table III)", columns, tuple(rows), notes),))


def without_gate(regressor: SilhouetteRegressor) -> SilhouetteRegressor:
    """The same regressions weighed by their variances alone, III-B."""
    return replace(regressor, gate=None, config=replace(regressor.config, gate="variance"))


def report_of_alpha(outcome: Outcome) -> Report:
    """Variance and alpha along a clip, alpha against variance, and the error against both."""
    regressor = model_of(outcome.scale, outcome.folder)
    trusted = regressor.config.trusted_variance
    clip = one_camera(outcome.scale.walks(seeds=1))[0]
    mixtures, errors, _ = guesses(clip, evidence_of(clip, outcome.folder / EVIDENCE), regressor)
    variance = np.array([mixture.uncertainty for mixture in mixtures])
    times = np.arange(len(variance)) * EVERY / clip.rate
    figure, axes = new_figure(1, 3, width=12.0, height=3.4)
    along, against, true = axes[0]
    along.plot(times, variance / variance.max(), label=f"variance / {variance.max():.2g} rad²")
    along.plot(times, np.exp(-variance / trusted), label="alpha")
    along.set_title("Fig. 8: along a walk, one camera")
    along.set_xlabel("s")
    grid = np.linspace(0, max(0.03, float(variance.max())), 100)
    for value in (*LAMBDAS, trusted):
        against.plot(grid, np.exp(-grid / value), label=f"lambda {value:.3g}")
    against.set_title("Fig. 9: alpha against variance")
    against.set_xlabel("variance, rad²")
    true.plot(variance, errors, ".", label="frames")
    true.set_title("Does the variance tell the error?")
    true.set_xlabel("variance, rad²")
    true.set_ylabel("error, root-aligned, mm")
    for ax in axes[0]:
        ax.legend(frameon=False, fontsize=8)
    rank = float(np.corrcoef(np.argsort(np.argsort(variance)), np.argsort(np.argsort(errors)))[0, 1])
    rows = tuple((f"{value:.4g}", float(np.exp(-variance / value).mean()))
                 for value in (PRINTED_TRUSTED_VARIANCE, trusted))  # fmt: skip
    note = f"Rank correlation of variance and error: {rank:.2f}. The second lambda is the one held-out people gave."
    table = Table("alpha", "alpha (Figs. 8, 9)", (Column("lambda"), Column("mean alpha", 3)), rows, (note,))
    return Report((table,), {"alpha": figure})


def report_of_modes(outcome: Outcome) -> Report:
    """The frame whose second mode weighs most: its silhouette, and both poses as the camera sees them."""
    regressor = model_of(outcome.scale, outcome.folder)
    clip = one_camera(outcome.scale.walks(seeds=1))[0]
    evidence = evidence_of(clip, outcome.folder / EVIDENCE)
    mixtures, _, _ = guesses(clip, evidence, regressor)
    order = [np.sort(mixture.weights)[::-1] for mixture in mixtures]
    chosen = int(np.argmax([row[1] if len(row) > 1 else 0.0 for row in order]))
    frame = chosen * EVERY
    body = body_of_trial(Trial(clip), evidence)
    guesser = SilhouetteGuesser.of(regressor, ImageLikelihood(body, evidence.rig, evidence.reductions))
    guess = guesser.guess([view[frame] for view in evidence.own])
    assert guess is not None, "a frame that was guessed in before"
    best = np.argsort(-guess.weights)[:2]
    figure, axes = new_figure(1, 4, width=11.0, height=3.2)
    axes[0, 0].imshow(evidence.own[0][frame], cmap="gray_r")
    axes[0, 0].set_title(f"frame {frame}", fontsize=9)
    right = evidence.rig[0].rotation[0]
    root = body.joint_names.index("pelvis")
    shown = {f"mode of {guess.weights[mode]:.2f}": body.joints(guess.poses(np.zeros(len(body.dof_names)))[mode])
             for mode in best}  # fmt: skip
    names = evidence.truth.names
    shown["truth"] = np.array([evidence.joints[frame, names.index(name)] if name in names else np.full(3, np.nan)
                               for name in body.joint_names])  # fmt: skip
    for ax, (label, joints) in zip(axes[0, 1:], shown.items(), strict=False):
        away = joints - joints[root]
        for side, colour in (("left", "tab:blue"), ("right", "tab:red")):
            for limb in (("shoulder", "elbow", "wrist"), ("hip", "knee", "ankle")):
                rows = [body.joint_names.index(f"{side}_{joint}") for joint in limb]
                ax.plot(away[rows] @ right, away[rows, 2], "o-", color=colour, markersize=3)
        trunk = [body.joint_names.index(name) for name in ("pelvis", "thorax", "head_top")]
        ax.plot(away[trunk] @ right, away[trunk, 2], "o-", color="0.3", markersize=3)
        ax.set_aspect("equal")
        ax.set_title(label, fontsize=9)
    for ax in axes[0]:
        ax.set_xticks([])
        ax.set_yticks([])
    table_rows = tuple((f"mode {number + 1}", float(guess.weights[mode])) for number, mode in enumerate(best))
    table = Table("modes", "Two modes of one silhouette (Fig. 13)", (Column("mode"), Column("gate", 2)), table_rows)
    return Report((table,), {"modes": figure})


GATES = Part("table3", "The regressor by itself, by gate (Table III)", report_of_gates)
ALPHA = Part("alpha", "Variance and alpha (Figs. 8, 9)", report_of_alpha)
MODES = Part("modes", "Two modes of one silhouette (Fig. 13)", report_of_modes)
