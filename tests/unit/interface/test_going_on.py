"""Analyses that are stopped go on with what they kept, to the same result in every bit."""

import pytest
from going_on import arrays, stopped

import vehicledyn as vd
from vehicledyn.base.errors import Interrupted

RK4 = {"kind": "rk4", "step": "5 ms"}
LONG = ("rig", "contacts", "inverse", "steady")
CASES = {
    "rig": (vd.rig, ["wishbone_arms_axle", "roll", "-10 mrad:10 mrad:4"], {}),
    "kinematics": (vd.kinematics, ["four_bar", {"crank.angle": "-60 deg:0 deg:8"}], {}),
    "inverse": (
        vd.inverse, ["slider_crank"], {"duration": "60 ms", "set": {"output.interval": "0.1 ms"}},
    ),
    "modes": (
        vd.modes, ["double_spring_mass"],
        {"cases": {str(k): {"parameters.upper.stiffness": f"{k} kN/m"} for k in (1, 2, 3)}},
    ),
    "contacts": (vd.contact_geometry, ["S1002", "60E1"], {"shifts": [0.0, 1e-3, 4e-3]}),
    "motion": (
        vd.sensitivity, ["double_pendulum", "max(lower.angle)", "length"],
        {"set": {"duration": "13 s", "output.interval": "10 ms"}, "solver": RK4},
    ),
    "steady": (vd.steady, ["small_car"], {"moments": False, "limits": False}),
    "critical speed": (
        vd.sensitivity, ["simple_wheelset", "critical_speed"], {"speed": "50 m/s"},
    ),
    "kinematic slopes": (
        vd.sensitivity,
        ["four_bar", "kinematics(rocker.angle, crank.angle, -60 deg:-40 deg:3)"], {},
    ),
    "forces' slopes": (
        vd.sensitivity, ["slider_crank", "inverse(crank.angle.work)"], {"duration": "90 ms"},
    ),
}  # fmt: skip


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=pytest.mark.long if n in LONG else ()) for n in CASES],
)
def test_what_is_stopped_goes_on_to_the_same_result(tmp_path, monkeypatch, name):
    analysis, arguments, options = CASES[name]
    out, whole = tmp_path / "out.h5", tmp_path / "whole.h5"
    with monkeypatch.context() as patch:
        steps = stopped(patch, 0)
        analysis(*arguments, save_to=whole, **options)
    assert len(set(steps)) > 2
    with monkeypatch.context() as patch, pytest.raises((KeyboardInterrupt, Interrupted)):
        stopped(patch, len(steps) // 2 + 1)
        analysis(*arguments, save_to=out, **options)
    assert (tmp_path / "out.h5.checkpoint").exists()
    with monkeypatch.context() as patch:
        rest = stopped(patch, 0)
        analysis(*arguments, save_to=out, resume=True, **options)
    assert set(rest) == set(steps[len(steps) // 2 :])
    assert not (tmp_path / "out.h5.checkpoint").exists()
    first, second = arrays(whole), arrays(out)
    assert first.keys() == second.keys()
    assert [key for key in first if first[key] != second[key]] == []
