"""Analyses take any model with the interface of runnable things, of whatever class it is."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vehicledyn.catalogue
from vehicledyn.analyses.linear.eigenmodes import find_modes
from vehicledyn.analyses.linear.linear_inputs import Excited
from vehicledyn.analyses.preparation import build_model
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.ports import Ports
from vehicledyn.analyses.preparation.prepared import by_partitioning
from vehicledyn.analyses.preparation.runnable import Subject
from vehicledyn.files.scenario import load_model

INTERFACE = [name for name in vars(Subject) if not name.startswith("_")]


@dataclass(frozen=True)
class Foreign:
    """A model of a class that no analysis knows; all it has is the interface."""

    own: Any

    def __getattr__(self, name):
        if name not in INTERFACE:
            raise AttributeError(name)
        return getattr(self.own, name)

    def with_system(self, system):
        return Foreign(self.own.with_system(system))


@pytest.fixture(scope="module", params=["quarter_car", "iltis"])
def target(request):
    return load_model(request.param)


def test_modes_of_a_foreign_model_are_the_same(target, monkeypatch):
    quiet = {"backend": "interpreted", "progress": lambda *_: None}
    speeds = [20.0] if target.name == "iltis" else []
    known = find_modes(target, speeds=speeds, **quiet)
    monkeypatch.setattr(
        "vehicledyn.analyses.preparation.prepare.build_subject",
        lambda target: Foreign(build_model.build_subject(target)),
    )
    foreign = find_modes(target, speeds=speeds, **quiet)
    for one, other in zip(known.speeds, foreign.speeds, strict=True):
        np.testing.assert_array_equal(
            [mode.eigenvalue for mode in one.modes], [mode.eigenvalue for mode in other.modes]
        )


def test_inputs_go_into_a_foreign_model(target):
    excited = Excited(Foreign(build_subject(target)))
    before = len(excited.system.parts)
    excited.add_thrust()
    excited.add("steering" if excited.subject.ports.steering else "wheel.force_z")
    assert len(excited.system.parts) > before or excited.subject.ports.steering
    assert isinstance(excited.subject, Foreign)
    assert by_partitioning(excited.subject).system.constraint_method == "partitioning"


def test_ports_name_what_a_vehicle_has():
    subject = build_subject(load_model("iltis"))
    ports = subject.ports
    assert {joint.name for joint in subject.system.joints()} >= {
        ports.steering, f"{ports.body}.x", *(wheel.spin for wheel in ports.wheels)
    }  # fmt: skip
    assert build_subject(load_model("quarter_car")).ports == Ports()


def test_nothing_asks_for_the_class_of_a_model():
    """Scenario or model, file or catalogue: what differs is behind the interface."""
    package = Path(vehicledyn.catalogue.__file__).parent
    asked = re.compile(
        r"isinstance\([^()]*\b(Loaded(Model|Scenario)|(Road|System)Subject|\w+Model)\b"
    )
    found = [
        f"{path.relative_to(package)}: {line.strip()}"
        for path in sorted(package.rglob("*.py"))
        for line in path.read_text(encoding="utf-8").splitlines()
        if asked.search(line)
    ]
    assert found == []
