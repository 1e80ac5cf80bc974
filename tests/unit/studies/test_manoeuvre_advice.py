"""What a search for an optimal manoeuvre advises that found none."""

import numpy as np

from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.studies.manoeuvre_optimisation.advice import slip_advice

CHANNELS = [
    Quantity(name, "1", "")
    for name in ("front.tyre.longitudinal_slip", "rear.tyre.longitudinal_slip", "body.speed")
]


def test_wheels_that_lock_are_named_with_a_limit():
    values = np.array([[0.0, 0.0, 30.0], [-0.4, -0.9, 20.0]])
    (note,) = slip_advice(CHANNELS, values, ())
    assert note.startswith("warning: rear.tyre.longitudinal_slip reaches 0.9")
    assert "limits: {rear.tyre.longitudinal_slip: {from: -0.12, to: 0.12}}" in note


def test_what_is_limited_or_small_is_not_named():
    values = np.array([[0.1, -0.9, 30.0]])
    assert slip_advice(CHANNELS, values, {"rear.tyre.longitudinal_slip"}) == []
