"""What every filter must do, whatever it does inside: for the registry and the skeleton in docs/add-a-filter.md."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace

import numpy as np

from filters.oracles import GaussianLikelihood, NormalEquations
from muybridge.errors import InputError
from muybridge.filters import ConstantVelocity, GaussianWalk, Method, state_from_arrays, state_to_arrays

SIZE = 4
LOWER, UPPER = np.array([-1.0, -1.0, -np.inf, 0.0]), np.array([1.0, np.inf, 1.0, 0.0])
SD = np.full(SIZE, 0.3)


@dataclass
class Scripted:
    """A Gaussian that keeps every pose it was asked about, and whose answers may be damaged on the way out."""

    damage: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None
    asked: list[np.ndarray] = field(default_factory=list)
    answered: list[np.ndarray] = field(default_factory=list)

    def log_prob(self, poses: np.ndarray) -> np.ndarray:
        self.asked.append(poses.copy())
        answer = GaussianLikelihood(np.zeros(poses.shape[1]), 0.3).log_prob(poses)
        self.answered.append(answer if self.damage is None else self.damage(poses, answer))
        return self.answered[-1]

    def normal_equations(
        self, pose: np.ndarray, spread: float, components: np.ndarray | None = None
    ) -> NormalEquations:
        return GaussianLikelihood(np.zeros(pose.size), 0.3).normal_equations(pose, spread, components)


def all_of(value: float) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    return lambda poses, answer: np.full(len(poses), value)


def partly(poses: np.ndarray, answer: np.ndarray) -> np.ndarray:
    """Impossible, NaN and +inf in three regions off the middle."""
    regions = [poses[:, 0] < -0.25, poses[:, 0] > 0.35, poses[:, 1] > 0.5]
    return np.select(regions, [-np.inf, np.nan, np.inf], answer)


def small(method: Method, **settings: object):
    return replace(method.WORKING, particles=60, sharpness=1.0, **settings)


def start(method: Method, config, seed: int = 0, size: int = SIZE):
    rng = np.random.default_rng(seed)
    state = method.init(rng, np.zeros(size), SD[:size], config, LOWER[:size], UPPER[:size])
    return rng, state


def dynamics(size: int = SIZE) -> ConstantVelocity:
    return ConstantVelocity(SD[:size], LOWER[:size], UPPER[:size], gain=0.5)


def frames(method: Method, config, count: int = 4, seed: int = 0) -> list:
    rng, state = start(method, config, seed)
    out = []
    for _ in range(count):
        state, info = method.step(rng, state, Scripted(), dynamics(), config)
        out.append((state, info))
    return out


def bytes_of(state) -> bytes:
    return b"".join(np.ascontiguousarray(array).tobytes() for array in state_to_arrays(state).values())


def check_begins_with_as_many_particles_as_are_set(method: Method) -> None:
    """Those of the config, or of the working settings where none is given; limits may be left out as well."""
    for given in (small(method), None):
        settings = (np.random.default_rng(0), np.zeros(SIZE), SD) + (() if given is None else (given,))
        state = method.init(*settings)
        assert isinstance(state, method.State)
        assert state.particles.shape == ((given or method.WORKING).particles, SIZE)


def check_shapes_and_limits(method: Method) -> None:
    for estimate in ("mean", "maximum"):
        config = small(method, estimate=estimate)
        for state, info in frames(method, config):
            assert state.particles.shape == (60, SIZE) and state.log_weights.shape == (60,)
            assert state.estimate.shape == state.velocity.shape == (SIZE,)
            assert all(array.dtype == np.float64 for array in state_to_arrays(state).values())
            assert ((state.particles >= LOWER) & (state.particles <= UPPER)).all()
            assert ((state.estimate >= LOWER - 1e-12) & (state.estimate <= UPPER + 1e-12)).all()
            assert abs(np.exp(state.log_weights).sum() - 1.0) < 1e-9
            assert 1.0 - 1e-9 <= info.ess <= 60 * (1 + 1e-9) and not info.collapsed
            assert info.survival_rate.shape == info.exponents.shape == info.acceptance.shape
            assert info.spread_before.shape == info.spread_after.shape == (SIZE,)
            assert np.isfinite(info.log_likelihood) and isinstance(info.remedy, str)


def check_one_dimension(method: Method) -> None:
    config = small(method)
    rng, state = start(method, config, size=1)
    state, _ = method.step(rng, state, Scripted(), dynamics(1), config)
    assert state.estimate.shape == (1,)


def check_proposals_stay_within_limits(method: Method) -> None:
    config, likelihood = small(method), Scripted()
    rng, state = start(method, config)
    method.step(rng, state, likelihood, dynamics(), config)
    asked = np.concatenate(likelihood.asked)
    assert ((asked >= LOWER - 1e-12) & (asked <= UPPER + 1e-12)).all()


def check_counts_its_evaluations(method: Method) -> None:
    config, likelihood = small(method), Scripted()
    rng, state = start(method, config)
    _, info = method.step(rng, state, likelihood, dynamics(), config)
    assert info.evaluations == sum(map(len, likelihood.asked)) > 0


def check_same_seed_same_bytes(method: Method) -> None:
    """Alone, again, and four at a time in threads; another seed differs."""
    config = small(method)
    alone = bytes_of(frames(method, config)[-1][0])
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda _: bytes_of(frames(method, config)[-1][0]), range(4)))
    assert set(together) == {alone}
    assert bytes_of(frames(method, config, seed=1)[-1][0]) != alone


def check_saved_state_continues(method: Method) -> None:
    config = small(method)
    rng, state = start(method, config)
    state, _ = method.step(rng, state, Scripted(), dynamics(), config)
    saved, rng_state = state_to_arrays(state), rng.bit_generator.state
    expected, _ = method.step(rng, state, Scripted(), dynamics(), config)
    again = np.random.default_rng(99)
    again.bit_generator.state = rng_state
    restored = state_from_arrays(saved, type(state))
    assert bytes_of(method.step(again, restored, Scripted(), dynamics(), config)[0]) == bytes_of(expected)


def check_state_given_is_not_changed(method: Method) -> None:
    config = small(method)
    rng, state = start(method, config)
    before = bytes_of(state)
    for array in state_to_arrays(state).values():
        array.flags.writeable = False
    method.step(rng, state, Scripted(), dynamics(), config)
    assert bytes_of(state) == before


def check_collapse_is_a_status(method: Method) -> None:
    """Nobody possible, or all answers NaN: the state stays, Info says what to do, and the next good frame goes on."""
    config = small(method)
    for value in (-np.inf, np.nan):
        rng, state = start(method, config)
        kept, info = method.step(rng, state, Scripted(all_of(value)), dynamics(), config)
        assert info.collapsed and info.remedy and info.ess == 0.0 and info.log_likelihood == -np.inf
        assert info.invalid == (info.evaluations if np.isnan(value) else 0)
        assert bytes_of(kept) == bytes_of(state)
        _, info = method.step(rng, kept, Scripted(), dynamics(), config)
        assert not info.collapsed


def check_damaged_answers_are_survived(method: Method) -> None:
    """Some impossible, some NaN, some +inf: counted, never chosen, nothing NaN comes out."""
    config = small(method)
    rng, state = start(method, config)
    for _ in range(3):
        likelihood = Scripted(partly)
        state, info = method.step(rng, state, likelihood, dynamics(), config)
        answers = np.concatenate(likelihood.answered)
        assert info.invalid == np.sum(np.isnan(answers) | (answers == np.inf)) > 0
        assert not info.collapsed and np.isfinite(state.estimate).all() and np.isfinite(state.particles).all()
        alive = state.particles[state.log_weights > -np.inf]
        assert np.isfinite(partly(alive, np.zeros(len(alive)))).all()


def check_bad_likelihood_is_named(method: Method) -> None:
    class Column(Scripted):
        def log_prob(self, poses: np.ndarray) -> np.ndarray:
            return np.zeros((len(poses), 1))

    config = small(method)
    rng, state = start(method, config)
    try:
        method.step(rng, state, Column(), dynamics(), config)
    except InputError as error:
        assert "log_prob" in str(error)
    else:
        raise AssertionError("an answer of the wrong shape was taken")


def check_follows_a_motion(method: Method) -> None:
    """Target moves half a noise unit a frame, likelihood sd 1 unit, four dimensions: mean error below 1 unit.

    Standing still for these 30 frames ends 15 units away; the posterior's own sd is below .7.
    """
    config = replace(method.WORKING, sharpness=1.0)
    rng = np.random.default_rng(0)
    state = method.init(rng, np.zeros(SIZE), np.ones(SIZE), config)
    for frame in range(1, 31):
        likelihood = GaussianLikelihood(np.full(SIZE, 0.5 * frame), 1.0)
        state, _ = method.step(rng, state, likelihood, GaussianWalk(np.ones(SIZE)), config)
    assert np.abs(state.estimate - 15.0).mean() < 1.0


def check_takes_what_is_usual_into_account(method: Method) -> None:
    """Everybody is near .3 (sd .1), the pictures say 0 (sd .3): the estimate moves by .1 at least.

    At .1 picture and prediction pull back with at most 2 x .1 / .3^2 = 2.2, what is usual pulls on with
    .2 x 5 / (4 + 2^2) / .1^2 = 12; they balance at .25. A mean of 60 particles of sd .1, a third of them effective,
    over four components, is off by .011: the bound is 13 of these below.
    """
    estimates = []
    for usual_sd in (np.inf, 0.1):
        rng = np.random.default_rng(0)
        state = method.init(rng, np.zeros(SIZE), SD, small(method))
        moves = GaussianWalk(SD, usual=np.full(SIZE, 0.3), usual_sd=np.full(SIZE, usual_sd))
        for _ in range(3):
            state, _ = method.step(rng, state, GaussianLikelihood(np.zeros(SIZE), 0.3), moves, small(method))
        estimates.append(state.estimate)
    assert (estimates[1] - estimates[0]).mean() > 0.1


CHECKS = [value for name, value in list(globals().items()) if name.startswith("check_")]
