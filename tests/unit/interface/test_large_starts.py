"""Starts at which neighbouring numbers are too far apart are refused by every analysis alike."""

import pytest
from small_systems import pendulum

import vehicledyn as vd

TEXT = r"'rod\.angle': 1e\+09 rad is too large to start from"


@pytest.mark.parametrize("analysis", [vd.simulate, vd.modes])
@pytest.mark.parametrize("start", ["nominal", "static"])
def test_analyses_refuse_them_alike(analysis, start):
    settings = {"start": start, "backend": "interpreted"}
    if analysis is vd.simulate:
        settings["duration"] = "0.1 s"
    with pytest.raises(vd.InputError, match=TEXT):
        analysis(pendulum(angle=1e9), **settings)


def test_equilibria_refuse_them_too():
    with pytest.raises(vd.InputError, match=TEXT):
        vd.equilibrium(pendulum(angle=1e9), backend="interpreted")


def test_sweeps_refuse_them_as_single_runs_do():
    vary = {"initial.rod.angle": ["1 rad", "1e9 rad"]}
    settings = {"duration": "0.1 s", "backend": "interpreted", "workers": 1}
    study = vd.sweep(pendulum(), vary=vary, **settings)
    assert study["case.status"].values.tolist() == ["done", "failed"]
