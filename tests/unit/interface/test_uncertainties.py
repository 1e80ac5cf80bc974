"""Uncertainty of runs, from Python."""

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import InputError

LAWS = {"length": {"kind": "normal", "mean": "1 m", "deviation": "5 mm"}}
LAWS["parameters.mass"] = {"kind": "uniform", "from": "0.9 kg", "to": "1.1 kg"}
OF, SHORT = ["final(upper.angle)"], {"duration": "0.3 s"}


def test_first_order_agrees_with_samples():
    """Nearly linear figures: deviation within errors; the mass of a pendulum does not matter."""
    linear = vd.uncertainty("double_pendulum", OF, LAWS, **SHORT)
    assert linear.n_runs == 1
    assert linear.shares[0] == pytest.approx([1.0, 0.0], abs=1e-9)
    drawn = vd.uncertainty("double_pendulum", OF, LAWS, method="sequence", number=64, **SHORT)
    assert drawn.found.deviation == pytest.approx(linear.found.deviation, rel=0.05)
    assert drawn.found.mean == pytest.approx(linear.found.mean, abs=3e-2 * drawn.found.deviation[0])
    assert "final(upper.angle)" in drawn.as_text()


def test_risks_and_indices():
    """A limit at the median is passed by half of all samples; one parameter brings all scatter."""
    middle = float(vd.uncertainty("double_pendulum", OF, LAWS, **SHORT).found.mean[0])
    limits = {OF[0]: {"at_most": f"{middle!r} rad"}}
    found = vd.uncertainty(
        "double_pendulum", OF, LAWS, method="sobol", number=32, limits=limits, **SHORT
    )
    (risk,) = found.as_dict()["risks"]
    assert risk["interval"][0] < 0.5 < risk["interval"][1]
    assert found.n_runs == 32 * 4
    assert np.abs(found.totals[0] - [1.0, 0.0]).max() < 0.1


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"parameters": {"lenght": LAWS["length"]}}, "did you mean 'length'"),
        ({"parameters": {"length": {"kind": "norml"}}}, "kind 'norml'"),
        ({"parameters": {"length": {"kind": "normal", "mean": "1 m"}}}, "mean, deviation"),
        ({"parameters": {"length": LAWS["length"] | {"mean": "1 kg"}}}, "kg"),
        ({"parameters": {"length": LAWS["length"] | {"deviation": "-1 mm"}}}, "above zero"),
        ({"parameters": {}}, "at least one"),
        ({"method": "guess"}, "method 'guess'"),
        ({"method": "sobol", "number": 30}, "power of two"),
        ({"of": ["upper.angle"]}, "is a curve"),
        ({"of": ["max(upper.angel)"]}, "did you mean 'upper.angle'"),
        ({"limits": {OF[0]: {"at_most": "1 rad"}}}, "needs samples"),
    ],
)
def test_what_means_nothing_is_refused(changes, match):
    """Each with one clear message."""
    given = {"of": OF, "parameters": LAWS} | changes
    of, laws = given.pop("of"), given.pop("parameters")
    with pytest.raises(InputError, match=match):
        vd.uncertainty("double_pendulum", of, laws, **given, **SHORT)
