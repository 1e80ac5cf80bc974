from typing import Literal

import pytest
from pydantic import ValidationError

from vehicledyn.base import registry
from vehicledyn.base.parameters import (
    ParameterSet,
    Vector,
    as_plain,
    part,
    quantity,
    read_part,
    units_of,
)


class Calm(ParameterSet):
    preview: float = quantity("s", "Preview time", gt=0)


class Body(ParameterSet):
    mass: float = quantity("kg", "Mass", gt=0)
    centre: Vector = quantity("m", "Centre of mass")
    spin: Literal["free", "prescribed"] = "free"
    driver: ParameterSet | None = part("driver", "Who drives", default=None)
    others: tuple[ParameterSet, ...] = part("driver", "Others", default=())


GOOD = {"mass": "2 t", "centre": [1, "2 mm", 0.5], "driver": {"kind": "calm", "preview": "100 ms"}}


@pytest.fixture(autouse=True)
def drivers(monkeypatch):
    monkeypatch.setattr(registry, "_catalogues", {})
    registry.register("driver", "calm")(Calm)


def complaints(**changes):
    with pytest.raises(ValidationError) as refused:
        Body.model_validate(GOOD | changes)
    return {line["loc"]: line["msg"] for line in refused.value.errors()}


def test_units_and_parts_are_read():
    body = Body.model_validate(GOOD)
    assert (body.mass, body.centre) == (2000.0, (1.0, 0.002, 0.5))
    assert body.driver == Calm(preview=0.1)


def test_plain_data_can_be_read_again():
    body = Body.model_validate(GOOD | {"others": [{"kind": "calm", "preview": 1}]})
    assert Body.model_validate(as_plain(body)) == body
    assert units_of(body, "body.") == {
        "body.mass": "kg",
        "body.centre": "m",
        "body.driver.preview": "s",
        "body.others.0.preview": "s",
    }


@pytest.mark.parametrize(
    ("change", "place", "message"),
    [
        ({"mass": -1}, ("mass",), "must be greater than 0 kg, is -1.0"),
        ({"mass": "3 m"}, ("mass",), "'3 m' has the wrong unit: a quantity in kg is needed here"),
        ({"mass": float("inf")}, ("mass",), "expected a finite number, found 'inf'"),
        ({"mass": True}, ("mass",), "expected a number in kg, found true"),
        ({"mass": {"value": 1}}, ("mass",), "expected a number in kg, found a mapping"),
        ({"centre": [1, 2]}, ("centre",), "expected 3 values, found 2"),
        ({"centre": []}, ("centre",), "expected 3 values, found 0"),
        ({"centre": [1, 2, 3, 4]}, ("centre",), "expected 3 values, found 4"),
        ({"centre": 1}, ("centre",), "expected a list, found '1.0'"),
        ({"spin": "fre"}, ("spin",), "must be 'free' or 'prescribed', is 'fre'; "
         "did you mean 'free'?"),
        ({"mas": 1}, ("mas",), "unknown key; did you mean 'mass'?"),
        ({"zzzz": 1}, ("zzzz",), "unknown key. Known: mass, centre, spin, driver, others"),
        ({"driver": {"kind": "clam"}}, ("driver", "kind"), "no driver named 'clam'; "
         "did you mean 'calm'? Known: calm"),
        ({"driver": {}}, ("driver", "kind"), "missing: the kind of driver. Known: calm"),
        ({"driver": 3}, ("driver",), "expected a mapping with 'kind', found '3'"),
        ({"driver": {"kind": "calm"}}, ("driver", "preview"), "missing: Preview time, in s"),
        ({"others": [{"kind": "calm", "preview": 0}]}, ("others", 0, "preview"),
         "must be greater than 0 s, is 0.0"),
    ],
)  # fmt: skip
def test_each_problem_is_one_complaint(change, place, message):
    assert complaints(**change) == {place: message}


def test_every_wrong_component_is_told():
    assert set(complaints(centre=["1 s", 2, "x"])) == {("centre", 0), ("centre", 2)}


def test_all_problems_come_at_once():
    found = complaints(mass=0, centre=[1], spin=3, driver={"kind": "calm", "preview": "1 m"}, x=1)
    assert set(found) == {("mass",), ("centre",), ("spin",), ("driver", "preview"), ("x",)}


def test_finished_part_is_kept():
    driver = Calm(preview=1.0)
    assert read_part("driver", driver) is driver


def test_sets_are_frozen():
    with pytest.raises(ValidationError):
        Body.model_validate(GOOD).mass = 3.0


@pytest.mark.parametrize(
    ("mass", "words"), [(10**400, "too large"), ("1 Gg^99", "exponent 99 is too large")]
)
def test_absurd_numbers_are_refused(mass, words):
    assert words in complaints(mass=mass)["mass",]
