"""What every kind of segment must obey: it fits between its neighbours and turns as it bends."""

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.parameters import read_part
from vehicledyn.base.registry import kinds
from vehicledyn.rail.track.alignment import Alignment
from vehicledyn.rail.track.layout_pieces import pieces_of

ARC = {"kind": "arc", "length": 40, "radius": -150, "cant": -0.1, "widening": 0.01}


@pytest.mark.parametrize("kind", kinds("segment"))
@pytest.mark.parametrize("reverse", [False, True])
def test_segment_joins_a_straight_and_an_arc(kind, reverse):
    own = {"kind": kind, "length": 35.0, **({"radius": -150} if kind == "arc" else {})}
    written = [{"kind": "straight", "length": 20}, own, ARC]
    segments = [read_part("segment", item) for item in (written[::-1] if reverse else written)]
    pieces, faults = pieces_of(segments, 1.435)
    if segments[1].constant:  # Nothing leads from its cant to that of the arc.
        assert [f.field for f in faults] == ["cant"]
        return
    assert faults == []
    alignment = Alignment(pieces, 1.5)
    s = np.linspace(0.5, alignment.length - 0.5, 1001)
    step = 1e-6
    for value, slope in (
        (alignment.heading, alignment.curvature),
        (alignment.cant, alignment.cant_slope),
        (lambda x: alignment.widening(x)[1], lambda x: alignment.widening_slope(x)[1]),
    ):
        difference = (value(s + step) - value(s - step)) / (2.0 * step)
        assert difference == pytest.approx(slope(s), abs=2e-8)
    assert alignment.widening(s)[0] == pytest.approx(0.0, abs=1e-15)
    middle = alignment.length - 20.0 if not reverse else 20.0
    assert alignment.curvature(np.array(middle)) == pytest.approx(-1 / 150.0)
    assert alignment.widening(np.array(middle))[1] == pytest.approx(-0.01 * -1.0 * -1.0)


def test_widening_moves_the_inner_rail():
    for sign in (1.0, -1.0):
        arc = read_part("segment", {**ARC, "radius": sign * 150, "cant": 0.0})
        left, right = Alignment(pieces_of([arc], 1.435)[0], 1.5).widening(np.array(5.0))
        assert (left, right) == ((0.01, 0.0) if sign > 0.0 else (0.0, -0.01))


@pytest.mark.parametrize("kind", ["clothoid", "bloss", "cosine", "klein", "ramp"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_widening_between_reversed_arcs_passes_from_rail_to_rail(kind, sign):
    """Both rails move along the transition, so that the gauge changes as its shape does."""
    written = [
        {**ARC, "radius": sign * 200, "cant": sign * 0.1, "widening": 0.008},
        {"kind": kind, "length": 90},
        {**ARC, "radius": -sign * 180, "cant": -sign * 0.09, "widening": 0.012},
    ]
    pieces, faults = pieces_of([read_part("segment", item) for item in written], 1.435)
    assert faults == []
    alignment = Alignment(pieces, 1.5)
    s = np.linspace(0.0, alignment.length, 1701)
    share = (alignment.cant(s) - sign * 0.1) / (-sign * 0.19)
    left, right = alignment.widening(s)
    assert left - right == pytest.approx(0.008 + 0.004 * share, abs=1e-12)
    inner, outer = (left, -right) if sign > 0.0 else (-right, left)
    assert inner == pytest.approx(0.008 * (1.0 - share), abs=1e-12)
    assert outer == pytest.approx(0.012 * share, abs=1e-12)
    inside = s[(np.abs(s - 40.0) > 0.01) & (np.abs(s - 130.0) > 0.01)][1:-1]
    for rail in (0, 1):
        difference = (
            alignment.widening(inside + 1e-6)[rail] - alignment.widening(inside - 1e-6)[rail]
        ) / 2e-6
        assert difference == pytest.approx(alignment.widening_slope(inside)[rail], abs=2e-8)


def test_widening_that_jumps_is_refused():
    written = [{**ARC, "cant": 0.0}, {**ARC, "radius": 150, "cant": 0.0}]
    _, faults = pieces_of([read_part("segment", item) for item in written], 1.435)
    assert [(f.number, f.field) for f in faults] == [(1, "widening")]
