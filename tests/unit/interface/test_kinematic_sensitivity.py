"""Derivatives of kinematic curves by parameters."""

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import InputError

NAMES = ["crank.length", "coupler.length", "rocker.length", "ground"]


def test_a_four_bar_follows_its_closed_form():
    """The coupler's length binds crank and rocker: one equation, differentiated by hand."""
    found = vd.sensitivity(
        "four_bar", "kinematics(rocker.angle, crank.angle, -60 deg:60 deg:3)", [*NAMES, "*.mass"]
    )
    assert found["figure"].values[0].startswith("rocker.angle at crank.angle = ")
    crank, coupler, rocker, ground = found["parameter_value"].values[:4]
    places = np.radians([-60.0, -20.0, 20.0, 60.0])
    for angle, turned, slopes in zip(
        places, found["figure_value"].values, found["figure_slope"].values, strict=True
    ):
        along = ground + rocker * np.cos(turned) - crank * np.cos(angle)
        across = rocker * np.sin(turned) - crank * np.sin(angle)
        assert along**2 + across**2 == pytest.approx(coupler**2, rel=1e-12)
        by_parameter = np.array(
            [
                -along * np.cos(angle) - across * np.sin(angle),
                -coupler,
                along * np.cos(turned) + across * np.sin(turned),
                along,
            ]
        )
        by_angle = rocker * (across * np.cos(turned) - along * np.sin(turned))
        assert slopes[:4] == pytest.approx(-by_parameter / by_angle, rel=1e-10)
        assert not slopes[4:].any()


def test_bump_steer_follows_the_hardpoints():
    """Mixed derivatives are alike: how the toe's own slopes change along the travel."""

    def slopes(of, place):
        found = vd.sensitivity(
            "double_wishbone_suspension", f"kinematics({of}, wheel.z, {place!r} m)", "*.z"
        )
        return found["figure_value"].values[0], found["figure_slope"].values[0]

    value, found = slopes("ratio.wheel.z.wheel.toe_angle", 0.3)
    run = vd.kinematics("double_wishbone_suspension", {"wheel.z": "0.3 m"})
    assert value == run["ratio.wheel.z.wheel.toe_angle"].values[0]
    wide, near = (
        (slopes("wheel.toe_angle", 0.3 + h)[1] - slopes("wheel.toe_angle", 0.3 - h)[1]) / (2.0 * h)
        for h in (1e-3, 5e-4)
    )
    exact = (4.0 * near - wide) / 3.0
    assert found == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())


def test_swing_axes_are_those_of_two_drives():
    """As the sweep finds them; their derivatives are walked with those of other axes."""
    drives = {"wheel.z": "0.3 m", "rack.displacement": "2 mm"}
    run = vd.kinematics("double_wishbone_suspension", drives)
    of = "kinematics(swing.wheel.side_centre_x, wheel.z, 0.3 m, rack.displacement=2 mm)"
    found = vd.sensitivity("double_wishbone_suspension", of, "*.z")
    assert found["figure_value"].values[0] == run["swing.wheel.side_centre_x"].values[0]
    assert found["figure"].values[0].endswith("at wheel.z = 0.3 m, rack.displacement = 2 mm")
    twice = of.replace("=2 mm", "=1 mm:2 mm:1")
    with pytest.raises(InputError, match="only the first drive takes a range"):
        vd.sensitivity("double_wishbone_suspension", twice)


@pytest.mark.parametrize(
    ("of", "to", "match"),
    [
        ("kinematics(rocker.angle, crank.angle)", "*", "write kinematics"),
        ("kinematics(rocker.angel, crank.angle, 0 deg)", "*", r"rocker\.angle"),
        ("kinematics(rocker.angle, crank.angel, 0 deg)", "*", r"crank\.angle"),
        ("kinematics(rocker.angle, crank.angle, 3 kg)", "*", "kg"),
        ("kinematics(rocker.angle, crank.angle, 0 deg)", "grond", "did you mean 'ground'"),
        ("kinematics(ratio.x.rocker.angle, crank.angle, 0 deg)", "*", "along the drive"),
        ("kinematics(swing.wheel.roll_centre_z, crank.angle, 0 deg)", "*", "needs two drives"),
        ("kinematics(rocker.angle, crank.angle, 0 deg, crank.angle=1 deg)", "*", "given twice"),
        ("kinematics(rocker.angle, crank.angle, 0 deg, wheel.z=1 mm)", "*", "no .*'wheel.z'"),
        (["kinematics(rocker.angle, crank.angle, 0 deg)", "eigenvalues"], "*", "one after the"),
    ],
)
def test_names_are_checked(of, to, match):
    """Of channels, drives, values and parameters."""
    with pytest.raises(InputError, match=match):
        vd.sensitivity("four_bar", of, to)
