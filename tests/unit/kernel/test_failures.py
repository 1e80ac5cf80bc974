"""Words for what fails inside a kernel: a loop, the contact of a wheel, or a friction force."""

import re
from dataclasses import replace

import pytest
from solve_examples import slider_crank

from vehicledyn.kernel.engine import Ledger, Status
from vehicledyn.kernel.failure_messages import describe_failure
from vehicledyn.symbolic.equations import Block


@pytest.mark.parametrize(
    ("kind", "status", "words"),
    [
        ("loop", Status.NOT_CONVERGED, "block 'x' at t = 2 s: .* the loop cannot close here"),
        (
            "contact",
            Status.NOT_CONVERGED,
            "contact of 'x' at t = 2 s: .* no point of contact is found",
        ),
        ("loop", Status.SINGULAR, "block 'x' at t = 2 s: .* the loop is at a dead centre"),
        ("contact", Status.SINGULAR, "contact of 'x' at t = 2 s: .* the wheel may lie flat"),
        ("force", Status.NOT_CONVERGED, "forces of 'x' at t = 2 s: .* no force .* fits"),
        ("force", Status.SINGULAR, "forces of 'x' at t = 2 s: .* friction jams"),
    ],
)
def test_loops_and_contacts_have_words_of_their_own(kind, status, words):
    e = replace(slider_crank(), blocks=(Block("x", 0, 2, 1e-12, kind=kind),))
    assert re.match(words, describe_failure(e, status, 2.0, Ledger()))
