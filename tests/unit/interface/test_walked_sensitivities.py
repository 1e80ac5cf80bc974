"""Every analysis is differentiated or refused with a reason, and no parameter is left out."""

import inspect

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.analyses.sensitivity.known_analyses import ANALYSES
from vehicledyn.analyses.sensitivity.refused_names import REASONS
from vehicledyn.base.errors import InputError

RK4 = {
    "solver": {"kind": "rk4", "step": "1 ms"},
    "output": {"interval": "10 ms"},
    "duration": "0.3 s",
}
SWING = {"kind": "sine", "amplitude": "rod * 4 rad/m", "frequency": "3 Hz"}
MOVED = {"motion": {"crank.angle": SWING}, "duration": "20 ms"}
ROAD = "body.height, road.height"
TURN = "rocker.angle, crank.angle, 20 deg"
RISE = "wheel.contact_z"
AXIS = "caster", "lateral_offset", "side_centre_x", "side_centre_z", "roll_centre_z"
WALKS = {
    "channels": ("double_pendulum", ["upper.angle", "energy.kinetic"], RK4),
    "figures": ("quarter_car", ["rms(tyre.force)", "peak(body.height)"], RK4),
    "equilibrium": ("jeep_suspension", ["equilibrium.*"], {}),
    "eigenvalues": ("double_spring_mass", ["eigenvalues"], {}),
    "mode shapes": ("double_spring_mass", ["mode_shapes"], {}),
    "gain and phase": ("quarter_car", [f"gain({ROAD}, 2 Hz)", f"phase({ROAD}, 2 Hz)"], {}),
    "resonance": (
        "quarter_car",
        [f"peak_gain({ROAD}, 0.5 Hz:3 Hz)", f"peak_frequency({ROAD}, 0.5 Hz:3 Hz)"],
        {},
    ),
    "kinematics": (
        "four_bar",
        [f"kinematics({TURN})", f"kinematics(ratio.crank.angle.{TURN})"],
        {},
    ),
    "axes": (
        "double_wishbone_suspension",
        [
            *(f"kinematics(instant.{RISE}.wheel.{name}, {RISE}, 3 mm)" for name in AXIS),
            f"kinematics(roll_centre.{RISE}.wheel, {RISE}, 3 mm)",
            f"kinematics(motion_ratio.{RISE}.wheel.strut, {RISE}, 3 mm)",
            f"kinematics(ratio.{RISE}.wheel.turning_x, {RISE}, 3 mm)",
            f"kinematics(swing.wheel.roll_centre_z, {RISE}, 3 mm, rack.displacement=1 mm)",
        ],
        {},
    ),
    "rig": (
        "double_wishbone_suspension",
        [
            *(f"rig(*, {test}, 20 mm)" for test in ("parallel", "steer")),
            *(f"rig(*, {test})" for test in ("lateral", "longitudinal", "aligning")),
            "rig(*, roll, 1 deg)",
        ],
        {},
    ),
    "steady": (
        "small_car",
        [
            "steady(understeer_angle, constant_radius, 3 m/s^2)",
            "steady(smallest_wheel_load, constant_radius, 3 m/s^2)",
        ],
        {},
    ),
    "inverse": ("slider_crank", ["inverse(crank.angle_power)"], MOVED),
}


OWN = ["body.*", "front.*", "rear.*", "track", "hub.*", "wheel.*"]
"""Parameters of a car but those of its tyres, which have a section of their own."""


def _figures(model, of, changes, to="parameters.*"):
    """Return the table, all values and their derivatives, those of curves behind the others."""
    table = vd.sensitivity(model, of, to, set=changes).report.table
    curves = np.asarray(table.channel_slopes).reshape(-1, len(table.parameters))
    values = np.concatenate([table.values, np.ravel(table.channel_values)])
    return table, values, np.concatenate([table.slopes, curves])


@pytest.mark.long
@pytest.mark.parametrize("name", WALKS)
def test_no_parameter_is_left_out(name):
    """All change at once by random parts, written into the model that is then built anew."""
    model, of, settings = WALKS[name]
    to = OWN if name == "steady" else ["parameters.*"]
    table, _, slopes = _figures(model, of, settings, to)
    values = np.array(table.parameter_values)
    parts = values * np.random.default_rng(5).uniform(-1.0, 1.0, len(values))

    def moved(part):
        new = zip(table.parameters, values + part * parts, strict=True)
        changes = {f"parameters.{p.name}": f"{float(v)!r} {p.unit}" for p, v in new if v}
        return _figures(model, of, {**settings, **changes}, to)[1]

    wide, near = ((moved(h) - moved(-h)) / (2.0 * h) for h in (5e-4, 2.5e-4))
    expected = (4.0 * near - wide) / 3.0
    along, size = slopes @ parts, np.abs(slopes * parts).sum(axis=1)
    assert np.isfinite(along).all()
    floor = 1e-9 * size.max()
    assert np.abs(along - expected) / np.maximum(size, floor) == pytest.approx(0.0, abs=1e-8)


def test_every_analysis_is_asked_for_or_refused():
    """Those that return values have names of their own here, or a reason against them."""
    analyses = [
        name
        for name in vd.__all__
        if (found := getattr(vd, name)) is not vd.sensitivity
        and inspect.isfunction(found)
        and found.__annotations__.get("return") in ("LabelledData", "LinearModel")
    ]
    assert {"equilibrium", "rig", "hunt"} < set(analyses)
    own = {*ANALYSES, "open_result"}
    assert not set(analyses) - own - set(REASONS)


@pytest.mark.parametrize("name", REASONS)
def test_other_analyses_are_refused_with_the_reason(name):
    with pytest.raises(InputError, match=f"results of '{name}' are not asked for so"):
        vd.sensitivity("quarter_car", f"{name}(wheel.toe_gain)")
