"""Bounds of parameters in system files, and those of the library's parts."""

import pytest

import vehicledyn
from vehicledyn.base.errors import InputError
from vehicledyn.files.expressions.parameters import read_parameters


def problems(**facts):
    return [words for _, words in read_parameters({"a": facts, "b": 2}).problems]


@pytest.mark.parametrize(
    ("facts", "words"),
    [
        ({"value": 0, "above": 0}, ["must be greater than 0, is 0"]),
        ({"value": "1 kg", "above": 0}, []),
        ({"value": "0 kg", "least": 0}, []),
        ({"value": "-1 g", "least": 0}, ["must be at least 0 kg, is -0.001"]),
        ({"value": "4 mm", "least": "1 cm"}, ["must be at least 0.01 m, is 0.004"]),
        ({"value": "b - 3", "least": 0}, ["must be at least 0, is -1"]),
        ({"value": ["1 m", "2 m", "3 m"], "least": 0}, ["least: only one number has a bound"]),
    ],
)
def test_a_number_keeps_its_bounds(facts, words):
    assert problems(**facts) == words


@pytest.mark.parametrize("bound", ["1 kg", "b", "nothing"])
def test_bounds_are_numbers_of_the_same_unit(bound):
    (words,) = problems(value="4 mm", least=bound)
    assert words


@pytest.mark.parametrize(
    ("model", "name", "value"),
    [
        ("sedan", "driveline.ratio", "0"),
        ("front_wheel_drive_car", "transaxle.ratio", "-4"),
        ("automatic_sedan", "gearbox.ratios.third", "0"),
        ("manual_sedan", "gearbox.ratios.sixth", "0"),
        ("sedan", "driveline.cage.inertia", "-1 kg*m^2"),
        ("sedan", "driveline.clutch.torque", "-10 N*m"),
        ("controlled_sedan", "brakes.wheel_radius", "0 m"),
        ("tractor_semitrailer", "drive_axle.air.area", "0 m^2"),
    ],
)
def test_parts_of_cars_refuse_what_they_cannot_be(model, name, value):
    with pytest.raises(InputError, match=rf"parameters\.{name}: must be (greater than|at least) 0"):
        vehicledyn.load(model, set={f"parameters.{name}": value})
