"""A regressor as a file: see `archive`.

Examples and outputs are kept as float32, which is what the regressor predicts from; the matrices that predictions need
are made again when it is loaded, so that 3000 frames take about a megabyte, and a loaded model predicts what the saved
one did.

=============================  ======================================================================
array                          content
=============================  ======================================================================
header                         body, components, settings
centre                         (F,) of the descriptors
gate_*                         of `LogisticGate`; absent where the variances decide
cluster<k>_*                   of `ClusterExamples`; hyper (Q, 4): theta_1, theta_2, theta_3, 1 / beta
=============================  ======================================================================
"""

from __future__ import annotations

from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from muybridge.archive import INCOMPLETE, Arrays, Kind, incomplete
from muybridge.errors import InputError
from muybridge.regression.cluster_regression import ClusterExamples, RegressionConfig
from muybridge.regression.clusters import ClusterConfig
from muybridge.regression.components import PoseComponents
from muybridge.regression.descriptor import DescriptorConfig
from muybridge.regression.gate import GateConfig, LogisticGate
from muybridge.regression.gaussian_process import HyperParameters
from muybridge.regression.regressor import Config, SilhouetteRegressor, rebuilt

KIND = Kind("muybridge-regressor", 1, "train")
_HYPER = tuple(column.name for column in fields(HyperParameters))
_GATE = ("landmarks", "centre", "scale", "weights")
_CLUSTER = {"inputs": np.float32, "outputs": np.float32, "middle": np.float64, "sd": np.float64}


def save_regressor(path: str | Path, regressor: SilhouetteRegressor) -> None:
    """Write the whole file, or leave the one that was there untouched."""
    header = {
        "body": regressor.body,
        "components": asdict(regressor.components),
        "config": asdict(regressor.config),
        "scale": regressor.scale,
        "clusters": len(regressor.clusters),
        "gate_inverse_scale": regressor.gate.inverse_scale if regressor.gate else None,
    }
    KIND.save(path, header, _arrays_of(regressor))


def load_regressor(path: str | Path, components: PoseComponents | None = None) -> SilhouetteRegressor:
    """A regressor from a file that `save_regressor` wrote.

    Parameters
    ----------
    components : PoseComponents, optional
        Those of the body that it is wanted for (`outputs.PoseOutputs.components`).

    Raises
    ------
    InputError
        The file is damaged, something else, of a later version, or for a body of other components.
    """
    what = f"regressor {path}"
    header, arrays = KIND.load(what, path)
    try:
        regressor = _regressor_of(header, arrays)
    except INCOMPLETE as error:
        raise incomplete(what, "all parts of a regressor", error) from error
    if components is not None:
        require_components(what, regressor, components)
    return regressor


def require_components(what: str, regressor: SilhouetteRegressor, components: PoseComponents) -> None:
    """Raise InputError where a regressor does not predict these components."""
    if regressor.components == components:
        return
    missing = sorted(set(components.names) ^ set(regressor.components.names))
    differing = missing[0] if missing else "their order, or which of them wrap"
    raise InputError(
        what,
        expected=f"a model for a body of these {len(components)} turns",
        got=f"one for {regressor.body or 'another body'!r} with {len(regressor.components)} (differs: {differing})",
        remedy="train one for this body",
    )


def _arrays_of(regressor: SilhouetteRegressor) -> Arrays:
    arrays: Arrays = {"centre": regressor.centre}
    if regressor.gate is not None:
        arrays |= {f"gate_{name}": getattr(regressor.gate, name) for name in _GATE}
        arrays["gate_landmarks"] = arrays["gate_landmarks"].astype(np.float32)
    for index, cluster in enumerate(regressor.clusters):
        own = cluster.examples
        arrays |= {f"cluster{index}_{name}": getattr(own, name).astype(kind) for name, kind in _CLUSTER.items()}
        rows = [[getattr(hyper, name) for name in _HYPER] for hyper in own.hyper]
        arrays[f"cluster{index}_hyper"] = np.array(rows, dtype=np.float64).reshape(-1, len(_HYPER))
    return arrays


def _regressor_of(header: dict[str, Any], arrays: Arrays) -> SilhouetteRegressor:
    named = header["components"]
    components = PoseComponents(tuple(named["names"]), tuple(named["circular"]), named["heading"])
    config = _config(header["config"])
    examples = []
    for index in range(int(header["clusters"])):
        parts = {name: arrays[f"cluster{index}_{name}"].astype(np.float64) for name in _CLUSTER}
        hyper = tuple(HyperParameters(*row) for row in arrays[f"cluster{index}_hyper"].tolist())
        examples.append(ClusterExamples(**parts, hyper=hyper, sharing=config.regression.sharing))
    gate = None
    if header["gate_inverse_scale"] is not None:
        parts = {name: arrays[f"gate_{name}"].astype(np.float64) for name in _GATE}
        gate = LogisticGate(inverse_scale=float(header["gate_inverse_scale"]), **parts)
    centre, scale = arrays["centre"], float(header["scale"])
    return rebuilt(components, str(header["body"]), config, centre, scale, examples, gate)


def _config(values: dict[str, Any]) -> Config:
    """The settings from what `asdict` made of them, and JSON of that."""
    values = dict(values)
    values["descriptor"] = DescriptorConfig(**values["descriptor"])
    values["regression"] = RegressionConfig(**values["regression"])
    values["logistic"] = GateConfig(**values["logistic"])
    clusters = values["clusters"]
    values["clusters"] = ClusterConfig(tuple(clusters["facing"]), tuple(clusters["splits"]), clusters["first"])
    return Config(**values)
