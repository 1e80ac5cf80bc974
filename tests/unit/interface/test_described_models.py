"""Models that are described with changes of whatever a run would let change."""

import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.interface.targets import read_described


def test_parameters_of_a_model_change_the_model():
    """No scenario is needed for them."""
    found = read_described("iltis", ["parameters.chassis.mass=1300 kg"])
    assert found.choices is None
    assert found.written.resolved["chassis"]["mass"] == 1300.0


def test_what_is_chosen_for_a_model_changes_its_usual_run():
    """Tyres, the road and how the wheels turn are those that a run would have."""
    found = read_described("iltis", ["tyres.front.a0=2700 N/rad", "chassis.mass=1300 kg"])
    assert found.choices.tyres.front.a0 == 2700.0
    assert found.choices.tyres.rear.a0 == 2625.0
    assert found.written.resolved["chassis"]["mass"] == 1300.0


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("tyres.a=1", "unknown key; did you mean 'a4'"),
        ("wheel_spin=fre", "must be 'free' or 'prescribed', is 'fre'"),
        ("parameters.tyres.a0=1", "'tyres' is outside 'parameters': set tyres or tyres.KEY"),
        ("parameters.chassis.mas=1 kg", "did you mean 'mass'"),
    ],
)
def test_errors_are_those_of_a_run(setting, words):
    """An unknown key or value is refused with what is known."""
    with pytest.raises(InputError, match=words):
        read_described("iltis", [setting])
