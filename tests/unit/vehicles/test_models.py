"""Every vehicle of the catalogue: it builds, stands, and every channel says what it is."""

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.prepare import equilibrium_point, prepare
from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import find, kinds
from vehicledyn.base.units import to_si
from vehicledyn.files.scenario import load_model


@pytest.fixture(scope="module", params=kinds("model"))
def prepared(request):
    return prepare(load_model(request.param, ()), backend="auto", progress=lambda *_: None)


def test_every_channel_state_and_parameter_has_unit_and_description(prepared):
    e = prepared.equations
    for group in (e.channels, e.states, e.unknowns, e.parameters):
        assert group
        for entry in group:
            assert entry.description.strip(), f"{entry.name} has no description"
            assert to_si(f"1 {entry.unit}", entry.unit) == 1.0, f"{entry.name}: unit not in SI"
        names = [entry.name for entry in group]
        assert len(set(names)) == len(names)


def test_names_that_manoeuvres_need_exist(prepared):
    vehicle, system = prepared.subject.vehicle, prepared.subject.vehicle.system
    coordinates = {joint.name for joint in system.joints()}
    position = {f"{vehicle.chassis}.{c}" for c in ("x", "y", "z", "yaw", "pitch", "roll")}
    assert position | {vehicle.rack} | {c.spin for c in vehicle.corners} <= coordinates
    assert {c.body for c in vehicle.corners} <= {body.name for body in system.bodies}
    assert sum(c.is_front for c in vehicle.corners) == sum(c.is_left for c in vehicle.corners)


def test_wheels_carry_the_weight_of_the_standing_vehicle(prepared):
    point = equilibrium_point(prepared, 0.0, "static")
    outputs = prepared.kernel.outputs(0.0, point.state, point.unknowns)
    values = dict(zip((c.name for c in prepared.equations.channels), outputs, strict=True))
    loads = [values[f"{c.name}.tyre.normal_force"] for c in prepared.subject.vehicle.corners]
    table = {p.name: p.value for p in prepared.equations.parameters}
    mass = table["chassis.mass"] + 4 * (table["a_arm.mass"] + table["wheel.mass"])
    assert np.sum(loads) == pytest.approx(mass * table["gravity"], rel=1e-9)


@pytest.mark.parametrize("model", kinds("model"))
def test_data_file_names_its_source(model):
    text = find("model", model).parameter_file.read_text(encoding="utf-8")
    assert "source:" in text.partition("\n\n")[0]


def test_an_inertia_that_no_body_has_names_the_change():
    told = r"^parameters\.wheel\.inertia_spin: parameters\.wheel: inertia_spin = 10 kg"
    with pytest.raises(InputError, match=told):
        load_model("iltis", ["parameters.wheel.inertia_spin=10 kg m^2"])
