"""A search for an equilibrium that a law makes impossible names the law."""

from functools import partial

import pytest

import vehicledyn as vd
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.prepare import not_held
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.registry import find
from vehicledyn.road.tyres.linear import Linear


def linear(stiffness):
    return Linear(
        nominal_load=4e3,
        longitudinal_stiffness=stiffness,
        cornering_stiffness=5e4,
        friction=1.0,
    )


@pytest.mark.parametrize(
    ("tyre", "pulls"),
    [
        (find("tyre", "calspan"), False),
        (find("tyre", "magic_formula_1987"), True),
        (partial(linear, 1e5), True),
        (partial(linear, 0.0), False),
    ],
)
def test_tyre_knows_whether_it_pulls_along(tyre, pulls):
    """By its law, or by a stiffness of zero."""
    assert tyre().pulls_along == pulls


def test_wheels_of_a_vehicle_say_that_nothing_turns_them():
    """The spin of each of the four wheels, and what to do."""
    car = vd.load("small_car", set={"tyres.kind": "calspan"})
    why = not_held(build_subject(car))
    assert len(why) == 4
    assert all("'wheel_spin: prescribed'" in words for words in why.values())


@pytest.mark.long
def test_failed_search_names_the_law():
    """The Iltis on Calspan's tyres with free wheels has no steady state to start from."""
    words = "'calspan' have no longitudinal force.*'wheel_spin: prescribed'"
    changes = {"tyres.kind": "calspan", "wheel_spin": "free", "start": "steady"}
    with pytest.raises(NumericalError, match=words):
        vd.equilibrium(
            vd.load("iltis_standstill", set=changes), speed="10 m/s", backend="interpreted"
        )
