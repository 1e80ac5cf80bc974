"""State space of transfer systems, and balanced truncation."""

import numpy as np
import pytest

from vehicledyn.analyse.state_space import StateSpace, proper, reduced
from vehicledyn.analyse.transfer import InputTerm, TransferSystem
from vehicledyn.base.errors import InputError

A = np.array([[0.0, 1.0, 0.0], [-9.0, -0.6, 1.0], [0.0, 0.0, -2.0]])
FREQUENCIES = np.array([0.05, 0.5, 3.0])


def transfer(state, output, c, delay=0.0):
    """Return a system of one input with its terms by powers of s."""
    term = InputTerm(np.array(state, dtype=float), np.array(output, dtype=float), delay, 2.0)
    return TransferSystem(A, np.array(c, dtype=float), ((term,),))


@pytest.mark.parametrize(
    ("state", "output", "c", "order"),
    [
        ([[0, 0, 1], [0, 0, 0], [0, 0, 0]], [[3], [0], [0]], [[1, 0, 0]], 0),
        ([[0, 0, 1], [0, 2, 1], [0, 0, 0]], [[0], [0], [0]], [[1, 0, 0]], 0),
        ([[0, 0, 1], [0, 1, 0], [1, 0, 0]], [[0], [-1], [0]], [[1, 0, 0]], 0),
        ([[0, 0, 1], [0, 1, 0], [0, 0, 0]], [[0], [5], [0]], [[1, 0, 0]], 1),
        ([[0, 0, 1], [0, 1, 0], [0, 1, 0]], [[0], [0], [1]], [[0, 1, 0]], 2),
    ],
)
def test_the_response_is_that_of_the_transfer_system(state, output, c, order):
    """To rounding, by the input or the derivative of it that the system takes."""
    system = transfer(state, output, c)
    found, orders = proper(system)
    assert orders == [order]
    assert len(found.a) == len(A) + order
    power = (2j * np.pi * FREQUENCIES) ** order
    expected = system.response(FREQUENCIES)[:, 0, 0]
    assert found.response(FREQUENCIES)[:, 0, 0] * power == pytest.approx(expected, rel=1e-12)


def test_a_delay_has_no_state_space():
    """It is refused."""
    with pytest.raises(InputError, match="one after the other"):
        proper(transfer([[0, 0, 1], [0, 0, 0], [0, 0, 0]], [[0], [0], [0]], [[1, 0, 0]], 0.1))


def test_a_reduced_system_keeps_what_grows_and_its_bound():
    """Twenty modes to eight states beside an integrator; Hankel values of one mode in closed form.

    One state of decay a and gain b c has the Hankel singular value |b c| / (2 a).
    """
    rng = np.random.default_rng(3)
    decay = np.append(-np.geomspace(0.1, 100.0, 20), 0.0)
    b, c = rng.normal(size=(21, 1)), rng.normal(size=(1, 21))
    turn = np.linalg.qr(rng.normal(size=(21, 21)))[0]
    whole = StateSpace(
        turn @ np.diag(decay) @ turn.T, turn @ b, c @ turn.T, np.zeros((1, 1)), np.zeros(0)
    )
    small = reduced(whole, 9)
    assert len(small.a) == 9
    assert np.sort(np.abs(np.linalg.eigvals(small.a)))[0] == pytest.approx(0.0, abs=1e-10)
    frequencies = np.geomspace(1e-3, 100.0, 60)
    missed = np.abs(whole.response(frequencies) - small.response(frequencies))
    assert 0.0 < missed.max() <= small.error * (1.0 + 1e-9)
    assert small.error < 1e-2 * np.abs(small.hankel).max()
    alone = StateSpace(np.array([[-2.0]]), np.array([[3.0]]), np.array([[5.0]]), np.zeros((1, 1)),
                       np.zeros(0))  # fmt: skip
    assert reduced(alone, 1).hankel == pytest.approx([15.0 / 4.0], rel=1e-12)
    with pytest.raises(InputError, match="give 1 to"):
        reduced(whole, 0)
