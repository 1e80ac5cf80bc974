"""Motion laws: their closed forms, ends, derivatives, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from cams_examples import cam, rise_and_fall

from vehicledyn.base.parameters import read_part
from vehicledyn.base.registry import kinds
from vehicledyn.symbolic import ops

OVER = np.radians(80.0)
EXTRA = {
    "spline": {"angles": ["40 deg", "80 deg"], "lifts": ["3 mm", "5 mm"]},
    "table": {"file": "law.csv", "periodic": False},
    "dwell": {},
}
POLYNOMIAL = {"start": [0.0, 0.0, 0.0], "end": [0.0, 0.0, 0.0]}


def law(kind, folder=Path(), **fields):
    given = {"kind": kind, "over": "80 deg", **EXTRA.get(kind, {"lift": "5 mm"}), **fields}
    return read_part("motion_law", given).beside(folder)


@pytest.mark.parametrize("kind", kinds("motion_law"))
def test_laws_rise_as_they_say_and_their_derivatives_fit(kind, tmp_path):
    Path(tmp_path, "law.csv").write_text("a [deg],b [mm]\n0,0\n20,1\n40,3\n80,5\n")
    found = law(kind, tmp_path)
    curve = found.placed(0.3, 0.001)
    ends = curve.derivatives(np.array([0.3, 0.3 + OVER]))[0]
    assert ends == pytest.approx([0.001, 0.001 + found.rise], abs=1e-15)
    x, step = 0.3 + OVER * np.linspace(0.011, 0.989, 37), 1e-5
    rows = curve.derivatives(x)
    slope = (curve.derivatives(x + step) - curve.derivatives(x - step)) / (2.0 * step)
    smooth = np.abs(slope[2] - rows[3]) < 1e-4  # no knot of the law within the step
    assert smooth.sum() >= 30
    assert np.abs(slope[:3] - rows[1:])[:, smooth].max() < 1e-7
    symbol = ops.symbol("x")
    value = ops.numeric([symbol], curve.value(symbol))
    assert np.array([value(at)[0, 0] for at in x]) == pytest.approx(rows[0], abs=1e-16)


@pytest.mark.parametrize(
    ("kind", "velocity", "acceleration"),
    [
        ("harmonic", np.pi / 2, np.pi**2 / 2),
        ("cycloidal", 2.0, 2.0 * np.pi),
        ("polynomial_345", 1.875, 10.0 / np.sqrt(3.0)),
        ("polynomial_4567", 2.1875, 84.0 / (5.0 * np.sqrt(5.0))),
        ("modified_sine", np.pi / (np.pi + 4.0) * 4.0, 4.0 * np.pi**2 / (np.pi + 4.0)),
        ("modified_trapezoid", 2.0, 8.0 * np.pi / (np.pi + 2.0)),
        ("parabolic", 2.0, 4.0),
    ],
)
def test_greatest_velocity_and_acceleration(kind, velocity, acceleration):
    """Closed forms of the laws' characteristic numbers; mod. sine c_v = 4 π / (π + 4)."""
    rows = law(kind, lift="1 m").curve().derivatives(np.linspace(0.0, 1.0, 200_001))
    assert rows[1].max() == pytest.approx(velocity, rel=1e-9)
    assert np.abs(rows[2]).max() == pytest.approx(acceleration, rel=1e-9)


def test_polynomial_of_boundary_conditions():
    x = np.linspace(0.0, 1.0, 11)
    found = law("polynomial", **POLYNOMIAL).curve().derivatives(x)
    assert found == pytest.approx(law("polynomial_4567").curve().derivatives(x), abs=1e-11)
    through = law("polynomial", places=[0.3], values=[0.4], start=[0.5], end=[0.2, -1.0])
    rows = through.curve().derivatives(np.array([0.0, 0.3, 1.0]))
    assert [rows[0, 1], rows[1, 0], rows[1, 2], rows[2, 2]] == pytest.approx([0.4, 0.5, 0.2, -1.0])


@pytest.mark.parametrize(
    ("laws", "words"),
    [
        (rise_and_fall("cycloidal", "5 mm")[:3], "take 280 deg in all.*add a dwell of 80 deg"),
        (
            [{"kind": "cycloidal", "over": "360 deg", "lift": "5 mm"}],
            "rise by 5 mm in all; make the falls",
        ),
    ],
)
def test_motions_that_do_not_close_are_refused(laws, words):
    found = cam(motion=laws, base_radius="30 mm", follower={"kind": "flat"})
    with pytest.raises(ValueError, match=words):
        _ = found.curve


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"kind": "dwell", "lift": "1 mm"}, "neither lift nor swing"),
        ({"kind": "harmonic"}, "either its lift"),
        ({"kind": "harmonic", "lift": "1 mm", "swing": "1 deg"}, "either its lift"),
        ({"kind": "polynomial", "lift": "1 mm", "places": [1.5], "values": [1]}, "between 0 and 1"),
        ({"kind": "polynomial", "lift": "1 mm", "start": [0.0] * 30}, "degree 33"),
        ({"kind": "spline", "angles": ["30 deg", "20 deg"], "lifts": [1, 2]}, "growing"),
        ({"kind": "spline", "angles": ["30 deg"], "lifts": [1, 2]}, "1 angles and 2 values"),
    ],
)
def test_laws_with_wrong_numbers_are_refused(fields, words):
    with pytest.raises(ValueError, match=words):
        read_part("motion_law", {"over": "80 deg", **fields})


@pytest.mark.parametrize("degree", [3, 5])
def test_a_periodic_spline_is_smooth_at_its_ends(degree):
    angles = [f"{a} deg" for a in range(0, 361, 30)]
    lifts = [0.004 * (1 - np.cos(np.radians(a))) for a in range(0, 361, 30)]
    lifts[-1] = 0.0
    found = cam(
        motion=[
            {
                "kind": "spline",
                "over": "360 deg",
                "angles": angles,
                "lifts": lifts,
                "degree": degree,
                "periodic": True,
            }
        ],
        base_radius="30 mm",
        follower={"kind": "flat"},
    )
    assert max(abs(jump) for _, jump in found.curve.jumps(min(degree - 1, 3))) < 1e-12
    x = np.linspace(0.0, 6.28, 50)
    rows = found.curve.derivatives(x)
    assert rows[0] == pytest.approx(0.004 * (1 - np.cos(x)), abs=2e-5 if degree == 3 else 2e-6)
