"""Derivatives of runs that change their dependent coordinates, or pass singular configurations."""

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import NumericalError

pytestmark = [pytest.mark.long, pytest.mark.usefixtures("needs_compiler")]

OF = ["crank.angle", "rocker.angle", "lever.angle"]
RK4 = {
    "duration": "0.1 s",
    "solver": {"kind": "rk4", "step": "0.5 ms"},
    "output": {"interval": "20 ms"},
}


def bar(name, parent, at, angle, length, rate=0.0, role="auto", mass=1.0):
    """Return a bar in the plane that turns about its end."""
    return vd.Body(
        name, parent, (*at, 0.0), (vd.Joint("R3", f"{name}.angle", angle, role, rate),),
        mass=mass, inertia=(0.02, 0.02, 0.02), com=(0.5 * length, 0.0, 0.0),
    )  # fmt: skip


def double_loop():
    """Return two four-bars one on the other, whose dependent coordinates change on the way."""
    table = vd.ParameterTable()
    mass = table.add("coupler_mass", 1.0, "kg", "Mass of the coupler")
    bodies = (
        bar("crank", vd.GROUND, (0.0, 0.0), 1.2, 0.3, 9.0, "independent"),
        bar("coupler", "crank", (0.3, 0.0), -0.9, 0.9, mass=mass),
        bar("rocker", vd.GROUND, (0.8, 0.0), 1.3, 0.7),
        bar("lever", "coupler", (0.5, 0.1), 0.9, 0.5),
        bar("stay", vd.GROUND, (-0.3, 0.7), 0.3, 1.2),
    )
    cuts = (
        vd.BallCut("first", "coupler", (0.9, 0.0, 0.0), "rocker", (0.7, 0.0, 0.0)),
        vd.BallCut("second", "lever", (0.5, 0.0, 0.0), "stay", (1.2, 0.0, 0.0)),
    )
    return vd.System("double_loop", table, bodies, cuts, gravity=(0.0, -9.81, 0.0))


@pytest.mark.parametrize("interval", ["20 ms", "5 ms"])
def test_tangents_follow_a_change_of_dependent_coordinates(interval):
    """Through a change in a sampling interval, also where samples alone tell of it.

    Against Richardson's differences of runs.
    """
    given = RK4 | {"output": {"interval": interval}}

    def curves(mass=1.0):
        run = vd.simulate(double_loop(), set={"parameters.coupler_mass": f"{mass!r} kg"}, **given)
        return np.array([run[name].values for name in OF])

    found = vd.sensitivity(double_loop(), OF, "coupler_mass", **given)
    assert any("become dependent at 0.0545 s" in note for note in found.notes)
    assert found["channel_value"].values == pytest.approx(curves(), abs=1e-12)
    near, wide = ((curves(1.0 + h) - curves(1.0 - h)) / (2.0 * h) for h in (1e-3, 2e-3))
    slopes = found["channel_slope"].values[:, :, 0]
    assert np.abs(slopes[:, -1]).min() > 1e-3
    assert slopes == pytest.approx((4.0 * near - wide) / 3.0, abs=1e-9)


def test_samples_are_those_of_runs_through_a_change():
    """Without gradients, too: the last sample of a sequence without scatter is that of the run."""
    law = {"kind": "normal", "mean": "1 kg", "deviation": "1e-9 kg"}
    of = "final(lever.angle)"
    drawn = vd.uncertainty(
        double_loop(), of, {"coupler_mass": law}, method="sequence", number=2, **RK4
    )
    run = vd.simulate(double_loop(), **RK4)
    assert drawn.found.mean[0] == pytest.approx(run["lever.angle"].values[-1], abs=1e-9)


def test_a_passage_through_a_singular_configuration_has_no_derivatives():
    """Crank and rod of equal length meet at a quarter turn; the run passes, tangents end."""
    table = vd.ParameterTable()
    mass = table.add("slider_mass", 1.3, "kg", "Mass of the slider")
    slide = vd.Joint("T1", "slider.x", np.cos(0.6))
    bodies = (
        bar("crank", vd.GROUND, (0.0, 0.0), 0.6, 0.5, 5.0, "independent"),
        bar("rod", "crank", (0.5, 0.0), -1.2, 0.5),
        vd.Body("slider", vd.GROUND, joints=(slide,), mass=mass),
    )
    pin = vd.BallCut("pin", "rod", (0.5, 0.0, 0.0), "slider", (0.0, 0.0, 0.0))
    system = vd.System("even", table, bodies, (pin,), gravity=(0.0, 0.0, 0.0))
    with pytest.raises(NumericalError, match="singular"):
        vd.sensitivity(system, "slider.x", "slider_mass", **RK4 | {"duration": "0.4 s"})
