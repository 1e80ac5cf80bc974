"""Words for what fails inside a kernel: a loop, or the contact of a wheel."""

import re
from dataclasses import replace

import pytest
from solve_examples import slider_crank

from vehicledyn.solve.engine import Ledger, Status
from vehicledyn.solve.failures import describe_failure
from vehicledyn.symbolic.equations import Block


@pytest.mark.parametrize(
    ("is_loop", "status", "words"),
    [
        (True, Status.NOT_CONVERGED, "block 'x' at t = 2 s: .* the loop cannot close here"),
        (False, Status.NOT_CONVERGED, "contact of 'x' at t = 2 s: .* no point of contact is found"),
        (True, Status.SINGULAR, "block 'x' at t = 2 s: .* the loop is at a dead centre"),
        (False, Status.SINGULAR, "contact of 'x' at t = 2 s: .* the wheel may lie flat"),
    ],
)
def test_loops_and_contacts_have_words_of_their_own(is_loop, status, words):
    e = replace(slider_crank(), blocks=(Block("x", 0, 2, 1e-12, is_loop=is_loop),))
    assert re.match(words, describe_failure(e, status, 2.0, Ledger()))
