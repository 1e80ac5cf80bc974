import functools

import jsonschema
import pytest
from small_catalogue import SCENARIO

from vehicledyn.base.errors import InputError
from vehicledyn.base.yaml import parse_yaml
from vehicledyn.files.scenario import load_scenario, scenario_schema


@pytest.fixture
def validator(catalogue):
    return checked()


@functools.cache
def checked():
    """Return what checks scenarios of the small catalogue, whose schema is itself checked."""
    schema = scenario_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def accepts(validator, path):
    return validator.is_valid(parse_yaml(path.read_text(), "").data)


GOOD = [
    (),
    (("speed: 36 km/h", "speed: 10 m/s"),),
    (("speed: 36 km/h", "speed: '10 m/s'"),),
    (("speed: 36 km/h", "speed: 1e1 m/s"),),
    (("speed: 36 km/h", "speed: 0"),),
    (("speed: 36 km/h", "speed: '0.0'"),),
    (("speed: 36 km/h", "speed: .5 m/s"),),
    (("mass: 1.2 t", "centre: {y: 3 mm}"),),
    (("mass: 1.2 t", "centre: [0, 2 m, 3 mm]"),),
    (("chassis:\n    mass: 1.2 t", "controller: {angle: 3 deg}"),),
    (("{kind: linear, stiffness: 30 kN}", "{front: {kind: rigid}, rear: {kind: rigid}}"),),
    (("road:\n  kind: flat", "road:"),),
    (("step: 1 ms", "step: 5e-3 s"),),
    (("  kind: fixed\n  step: 1 ms", "  kind: adaptive\n  relative_tolerance: 1e-6"),),
    (("spacing: 18 m", "spacing: 18 m\n  helpers: [{kind: preview, preview: 1 s}]"),),
    (("parameters:\n  chassis:\n    mass: 1.2 t", "parameters:"),),
]
BAD = [
    (("speed: 36", "sped: 36"),),
    (("speed: 36 km/h", "speed: fast"),),
    (("speed: 36 km/h", "speed: 10"),),
    (("speed: 36 km/h", "speed: '1e1'"),),
    (("mass: 1.2 t", "centre: [1, 2 m, 3 mm]"),),
    (("mass: 1.2 t", "centre: {y: 3}"),),
    (("speed: 36 km/h", "speed: -1"),),
    (("model: cart", "model: card"),),
    (("kind: slalom", "kind: slalm"),),
    (("  kind: slalom\n", ""),),
    (("kind: preview", "kind: fixed_wheel"),),
    (("mass: 1.2 t", "mas: 1"),),
    (("mass: 1.2 t", "centre: {w: 1}"),),
    (("mass: 1.2 t", "centre: [1, 2]"),),
    (("{kind: linear, stiffness: 30 kN}", "{kind: linear}"),),
    (("{kind: linear, stiffness: 30 kN}", "{front: {kind: rigid}}"),),
    (("wheel_spin: free", "wheel_spin: loose"),),
    (("  interval: 10 ms\n", ""),),
]


@pytest.mark.parametrize("changes", GOOD)
def test_schema_accepts_what_validation_accepts(validator, write, changes):
    path = write(*changes)
    load_scenario(path)
    assert accepts(validator, path)


@pytest.mark.parametrize("changes", BAD)
def test_schema_refuses_what_validation_refuses(validator, write, changes):
    path = write(*changes)
    with pytest.raises(InputError):
        load_scenario(path)
    assert not accepts(validator, path)


def test_every_property_is_described_and_no_other_is_allowed(validator):
    schema = validator.schema
    objects = [schema, *(d for d in schema["$defs"].values() if d.get("type") == "object")]
    assert len(objects) > 10
    for entry in objects:
        assert entry["additionalProperties"] is False
        for name, inner in entry.get("properties", {}).items():
            described = "description" in inner or "$ref" in inner or name in ("kind", "parameters")
            assert described, name


def test_units_stand_in_the_descriptions(validator):
    assert validator.schema["properties"]["speed"]["description"] == "Speed at the start [m/s]"


def test_the_scenario_of_the_tests_is_good(validator):
    assert list(validator.iter_errors(parse_yaml(SCENARIO, "").data)) == []
