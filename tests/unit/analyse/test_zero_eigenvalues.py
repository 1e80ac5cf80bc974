"""Zero eigenvalues: free bodies, chains, and modes beside them, against closed forms."""

import numpy as np
import pytest

from vehicledyn.analyse.modes import eigenmodes
from vehicledyn.analyse.response_figures import key_figures
from vehicledyn.analyse.transfer import InputTerm, TransferSystem
from vehicledyn.analyse.zero_eigenvalues import staircase


def chain(masses, springs):
    """Return A of masses in a row; springs join neighbours, the first and last to the ground."""
    n = len(masses)
    stiffness = np.zeros((n, n))
    for k, value in enumerate(springs):
        for i in (k - 1, k):
            for j in (k - 1, k):
                if 0 <= i < n and 0 <= j < n:
                    stiffness[i, j] += value if i == j else -value
    inverse = np.diag(1.0 / np.asarray(masses))
    return np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness, np.zeros((n, n))]])


def names_of(n):
    return [f"x{k}" for k in range(n)] + [f"v{k}" for k in range(n)]


@pytest.mark.parametrize("n", [1, 2, 5, 30, 80])
def test_chain_of_masses_between_walls(n):
    """ω_k = 2 √(k/m) sin(k π / (2 (N + 1))), shapes sin(j k π/(N + 1))."""
    stiffness, mass = 4.7e4, 2.3
    modes = eigenmodes(chain([mass] * n, [stiffness] * (n + 1)), names_of(n))
    assert len(modes) == n
    for k, mode in enumerate(modes, 1):
        exact = 2.0 * np.sqrt(stiffness / mass) * np.sin(k * np.pi / (2 * (n + 1)))
        assert mode.eigenvalue.imag == pytest.approx(exact, rel=1e-11)
        assert abs(mode.damping_ratio) < 1e-12
        shape = np.sin(np.arange(1, n + 1) * k * np.pi / (n + 1))
        own = mode.shape[:n]
        largest = np.argmax(np.abs(shape))
        assert own / own[largest] == pytest.approx(shape / shape[largest], abs=1e-9)


@pytest.mark.parametrize("n", [2, 3, 12])
def test_free_chain_has_an_exact_double_zero(n):
    """ω_k = 2 √(k/m) sin(k π / (2 N)) for k = 1 … N - 1, and a body that moves as a whole."""
    a = chain([1.7] * n, [0.0, *([900.0] * (n - 1)), 0.0])
    modes = eigenmodes(a, names_of(n))
    free, drift = (m for m in modes if m.is_zero)
    assert (free.kind, drift.kind) == ("free", "drift")
    assert free.shape == pytest.approx(np.r_[np.ones(n), np.zeros(n)], abs=1e-12)
    assert np.abs(a @ free.shape).max() < 1e-9
    assert drift.shape[n:] == pytest.approx(np.ones(n), abs=1e-12)
    assert np.abs(a @ (a @ drift.shape)).max() < 1e-9
    for k, mode in enumerate((m for m in modes if not m.is_zero), 1):
        exact = 2.0 * np.sqrt(900.0 / 1.7) * np.sin(k * np.pi / (2 * n))
        assert mode.eigenvalue.imag == pytest.approx(exact, rel=1e-11)
        assert np.abs(a @ mode.shape - mode.eigenvalue * mode.shape).max() < 1e-10
        assert np.sum(mode.participation) == pytest.approx(1.0, rel=1e-12)


def test_zeros_in_odd_units():
    """Stiff and soft, large and small masses: the free body is still told from slow modes."""
    a = chain([1e-3, 1e4, 5.0], [0.0, 1e7, 1e-2, 0.0])
    modes = eigenmodes(a, names_of(3))
    assert [mode.kind for mode in modes] == ["free", "drift", "oscillation", "oscillation"]
    assert modes[2].eigenvalue.imag == pytest.approx(
        np.sqrt(1e-2 / 5.0 * (1 + 5.0 / 1e4)), rel=1e-6
    )


def test_chains_in_random_axes():
    """Jordan blocks of zero of sizes 3, 2 and 1, and a rotation, hidden by a similarity."""
    rng = np.random.default_rng(7)
    blocks = np.zeros((8, 8))
    blocks[0, 1] = blocks[1, 2] = blocks[3, 4] = 1.0
    blocks[6:, 6:] = [[-0.2, 3.0], [-3.0, -0.2]]
    turned = rng.normal(size=(8, 8))
    a = turned @ blocks @ np.linalg.inv(turned)
    stairs = staircase(a)
    assert [step.null.shape[1] for step in stairs.steps] == [3, 2, 1]
    modes = eigenmodes(a, [f"s{k}" for k in range(8)])
    assert [mode.level for mode in modes] == [1, 1, 1, 2, 2, 3, 0]
    assert modes[-1].eigenvalue == pytest.approx(-0.2 + 3.0j, rel=1e-10)
    for mode in modes[:-1]:
        moved = mode.shape
        for _ in range(mode.level):
            assert np.abs(moved).max() > 1e-6
            moved = a @ moved
        assert np.abs(moved).max() < 1e-9


def test_a_body_at_steady_turn_is_named_by_what_is_held():
    """The shape of a held state is the motion it leads to, not the state alone."""
    a = np.array([[0.0, 1.0, 0.0], [0.0, -4.0, 8.0], [0.0, 0.0, 0.0]])
    modes = eigenmodes(a, ["angle", "rate", "torque"])
    assert {m.dominant[0]: m.level for m in modes if m.is_zero} == {"angle": 1, "torque": 2}
    (held,) = (m for m in modes if m.dominant == ("torque",))
    assert held.shape == pytest.approx([0.0, 2.0, 1.0])


def test_a_pole_that_is_hit_exactly_is_infinite():
    """x'' = u at every frequency, and beside it an oscillator of exactly 1/(2 π) Hz."""
    a = np.array([[0.0, 1.0], [-1.0, 0.0]])
    term = InputTerm(np.array([[0.0, 1.0], [0, 0], [0, 0]]), np.zeros((3, 1)))
    system = TransferSystem(a, np.array([[1.0, 0.0]]), ((term,),))
    at_pole, beside = np.array([1.0, 2.0]) / (2.0 * np.pi)
    found = system.response([at_pole, beside])[:, 0, 0]
    assert abs(found[0]) > 1e15
    assert found[1] == pytest.approx(-1.0 / 3.0, rel=1e-12)
    assert system.static_gain() == pytest.approx(np.array([[1.0]]))


def test_first_order_lag_and_its_integral():
    """1/(1 + T s): static gain 1, -3 dB at 1/(2 π T), and no static gain of the integral."""
    lag = 0.4
    a = np.array([[-1.0 / lag, 0.0], [1.0, 0.0]])
    term = InputTerm(np.array([[1.0 / lag, 0.0], [0, 0], [0, 0]]), np.zeros((3, 2)))
    system = TransferSystem(a, np.eye(2), ((term,),))
    frequencies = np.geomspace(0.01, 10.0, 30)
    s = 2j * np.pi * frequencies
    found = system.response(frequencies)[:, 0]
    assert found[:, 0] == pytest.approx(1.0 / (1.0 + lag * s), rel=1e-12)
    assert found[:, 1] == pytest.approx(1.0 / (s * (1.0 + lag * s)), rel=1e-12)
    gain = system.static_gain()[0]
    assert gain[0] == pytest.approx(1.0, rel=1e-14)
    assert np.isnan(gain[1])
    figures = key_figures(lambda f: abs(system.response(f)[0, 0, 0]), frequencies, float(gain[0]))
    assert figures.bandwidth == pytest.approx(1.0 / (2.0 * np.pi * lag), rel=1e-9)
    assert figures.peak is None
