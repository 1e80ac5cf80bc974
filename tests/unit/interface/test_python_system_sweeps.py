"""Sweeps of systems that were built in Python, in this process and in others."""

from dataclasses import dataclass

import numpy as np
import pytest
from small_systems import pendulum

import vehicledyn as vd

VARY = {"length": ["1 m", "2 m"], "initial.rod.angle_rate": ["0 rad/s", "1 rad/s"]}
QUICK = {"duration": "0.2 s", "backend": "interpreted"}


@dataclass(frozen=True)
class Named(vd.BasePart):
    """A part without effect whose class no other process can import."""

    name: str = "named"


@pytest.mark.parametrize("workers", [1, 2])
def test_cases_move_as_single_runs_do(workers):
    study = vd.sweep(pendulum(), vary=VARY, workers=workers, **QUICK)
    assert study["initial.rod.angle_rate"].unit == "rad/s"
    single = vd.load(pendulum()).changed({"length": "2 m", "initial.rod.angle_rate": "1 rad/s"})
    motion = vd.simulate(single, **QUICK)
    assert study["rod.angle"][3] == pytest.approx(motion["rod.angle"].values, abs=1e-9)
    begun = np.diff(study["rod.angle"][:, :2])[:, 0] / 0.01
    assert begun == pytest.approx([0.0, 1.0, 0.0, 1.0], abs=0.05)


def test_a_scenario_changed_in_memory_is_swept():
    changed = vd.load(pendulum()).changed(length="3 m")
    study = vd.sweep(changed, vary={"initial.rod.angle": ["10 deg"]}, workers=1, **QUICK)
    motion = vd.simulate(changed.changed({"initial.rod.angle": "10 deg"}), **QUICK)
    assert study["rod.angle"][0] == pytest.approx(motion["rod.angle"].values, abs=1e-9)


def test_classes_that_others_cannot_import_stay_here():
    system = pendulum().with_parts(Named())
    study = vd.sweep(system, vary={"length": ["1 m", "2 m"]}, **QUICK)
    assert study["case.status"].values.tolist() == ["done", "done"]
    with pytest.raises(vd.InputError, match=r"workers=2: system 'pendulum' cannot leave .*import"):
        vd.sweep(system, vary={"length": ["1 m", "2 m"]}, workers=2, **QUICK)


def test_another_system_does_not_go_on_with_a_study(tmp_path):
    kept = {"vary": {"length": ["1 m"]}, "save_to": tmp_path / "study.h5", "workers": 1, **QUICK}
    vd.sweep(pendulum(), **kept)
    assert len(vd.sweep(pendulum(), resume=True, **kept)["length"]) == 1
    with pytest.raises(vd.InputError, match=r"another|differ"):
        vd.sweep(pendulum(angle=0.1), resume=True, **kept)
