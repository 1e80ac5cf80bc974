import pytest

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.symbolic.parameters import ParameterTable


class Inner(ParameterSet):
    """Numbers inside."""

    stiffness: float = quantity("N/m", "Stiffness")


class Outer(ParameterSet):
    """Numbers outside."""

    mass: float = quantity("kg", "Mass")
    place: tuple[float, float, float] = quantity("m", "Place")
    label: str
    inner: Inner


@pytest.fixture
def entered():
    table = ParameterTable()
    numbers = Outer(
        mass="2 t", place=["1 m", "2 m", "3 mm"], label="x", inner={"stiffness": "5 N/m"}
    )
    return table, table.add_set("car", numbers)


def test_every_quantity_is_entered_with_unit_and_meaning(entered):
    table, _ = entered
    assert [(e.name, e.value, e.unit, e.description) for e in table.entries] == [
        ("car.mass", 2000.0, "kg", "Mass"),
        ("car.place.x", 1.0, "m", "Place"),
        ("car.place.y", 2.0, "m", "Place"),
        ("car.place.z", 0.003, "m", "Place"),
        ("car.inner.stiffness", 5.0, "N/m", "Stiffness"),
    ]


def test_the_set_comes_back_with_symbols(entered):
    table, symbols = entered
    assert isinstance(symbols, Outer)
    assert symbols.label == "x"
    found = [symbols.mass, *symbols.place, symbols.inner.stiffness]
    assert [s.name() for s in found] == [e.name for e in table.entries]


def test_a_name_is_entered_once():
    table = ParameterTable()
    table.add("mass", 1.0, "kg", "Mass")
    with pytest.raises(ValueError, match="'mass' is declared twice"):
        table.add("mass", 2.0, "kg", "Mass")
