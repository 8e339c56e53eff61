"""Particle filters: table of contents.

============  ===================  ==================================================
name          file                 one line
============  ===================  ==================================================
condensation  `condensation.py`    the plain particle filter; the one to compare with
annealed      `annealed.py`        layers of sharpening likelihood and shrinking noise
agp-pf        `agp_pf.py`          annealed, with particles from a guess among the first (Sedai, 2013)
demc          `demc.py`            differential evolution Markov chains (Du, 2005)
tempered      `tempered.py`        annealing whose moves are Metropolis-correct
guided        `guided.py`          climb the contour, then draw from its curvature; the default
============  ===================  ==================================================

Shared parts: `particles` (weights and what is read off them), `resampling`, `dynamics`, `schedule` (annealing
exponents), `moves` (differential evolution, exchange), `guess` (a state guessed from one picture), `state` (State,
Info, common settings, how a step ends).

A filter is a module with `init`, `step`, `Config`, `PRINTED` and `WORKING`; a row of `METHODS` makes it appear
in the conformance tests, the command line and the documentation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import Any

from muybridge.errors import InputError
from muybridge.filters import agp_pf, annealed, condensation, demc, guided, tempered
from muybridge.filters.dynamics import ConstantVelocity, Dynamics, GaussianWalk, NearlyConstantVelocity
from muybridge.filters.guess import Guess, GuessingLikelihood
from muybridge.filters.particles import Weights, covariance, maximum_estimate, mean_estimate, standard_deviation
from muybridge.filters.resampling import RESAMPLING, resample
from muybridge.filters.state import CommonConfig, Info, Likelihood, State, state_from_arrays, state_to_arrays


@dataclass(frozen=True)
class Method:
    """A filter by name.

    init(rng, mean, sd, config, lower, upper) -> State; step(rng, state, likelihood, dynamics, config) -> (State, Info).
    `PRINTED` are the settings of the paper, `WORKING` those that were measured to work.
    """

    name: str
    description: str
    init: Callable[..., Any]
    step: Callable[..., Any]
    Config: type[CommonConfig]
    PRINTED: CommonConfig
    WORKING: CommonConfig
    State: type[State]


def method_from_module(name: str, module: ModuleType, description: str) -> Method:
    """The row of a module that keeps to the layout of a filter file."""
    return Method(
        name, description, module.init, module.step, module.Config, module.PRINTED, module.WORKING, module.State
    )


METHODS: dict[str, Method] = {
    row.name: row
    for row in (
        method_from_module("condensation", condensation, "select, predict, measure; the filter to compare with"),
        method_from_module("annealed", annealed, "layers of sharpening likelihood and shrinking noise"),
        method_from_module("agp-pf", agp_pf, "annealed, with particles from a guess among the first"),
        method_from_module("demc", demc, "differential evolution Markov chains climb the likelihood together"),
        method_from_module("guided", guided, "climb to the mode by the contour, draw particles from its curvature"),
        method_from_module("tempered", tempered, "annealing whose moves leave the posterior invariant"),
    )
}


def method(name: str) -> Method:
    """The filter of that name; InputError names the known ones."""
    if name not in METHODS:
        raise InputError("filter", expected=" | ".join(METHODS), got=repr(name))
    return METHODS[name]


__all__ = [
    "METHODS",
    "RESAMPLING",
    "CommonConfig",
    "ConstantVelocity",
    "Dynamics",
    "GaussianWalk",
    "Guess",
    "GuessingLikelihood",
    "Info",
    "Likelihood",
    "Method",
    "NearlyConstantVelocity",
    "State",
    "Weights",
    "covariance",
    "maximum_estimate",
    "mean_estimate",
    "method",
    "method_from_module",
    "resample",
    "standard_deviation",
    "state_from_arrays",
    "state_to_arrays",
]
