"""Arguments of the wrong kind are refused by their names, whatever the function."""

import inspect
from collections.abc import Iterable, Mapping
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.argument_names import arguments_named
from vehicledyn.base.checked_arguments import checked
from vehicledyn.base.errors import InputError
from vehicledyn.base.units import to_si

FUNCTIONS = [
    name for name in vd.__all__ if inspect.isfunction(getattr(vd, name)) and name != "models"
]


def scattered(**given):
    law = {"body.mass": {"kind": "normal", "mean": "300 kg", "deviation": "1 kg"}}
    vd.uncertainty("quarter_car", "max(body.height)", law, method="sequence", **given)


def slope(of, to):
    vd.sensitivity("quarter_car", of, to, duration="0.1 s")


MEASURED = {"body.height": ([0.0, 0.1], [0.0, 0.0], "1 mm")}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_argument_of_the_front_door_is_checked(name):
    """A value of no known kind is refused before anything is read, by the argument's name."""
    function = getattr(vd, name)
    parameters = inspect.signature(function).parameters.values()
    required = {
        p.name: {} if p.annotation.startswith("Mapping") else "c"
        for p in parameters
        if p.default is p.empty and p.kind is not p.VAR_KEYWORD
    }
    for parameter in parameters:
        if parameter.kind is not parameter.VAR_KEYWORD:
            with pytest.raises(InputError, match=f"{parameter.name}: expected .* found <obj"):
                function(**{**required, parameter.name: object()})


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: vd.simulate("quarter_car", backend="compield"), "backend: expected 'auto', 'co"),
        (lambda: vd.simulate("quarter_car", backend="compield"), "did you mean 'compiled'?"),
        (lambda: vd.write_equations("quarter_car", "fortran"), "to: expected 'c', 'python', "),
        (lambda: vd.response("quarter_car", "a", "b", at="1 Hz"), "at: expected a list of nu"),
        (
            lambda: vd.uncertainty("quarter_car", "time", {"body.mass": "300 kg"}),
            "parameters: expected a mapping from names to mappings, found {'body.mass': '300 kg'}",
        ),
        (lambda: vd.modes("quarter_car", speed=np.ones((2, 2))), "speed: expected a number, "),
        (lambda: vd.tyre("c", loads=b"12"), "loads: expected a list of numbers or texts, found"),
        (lambda: vd.load(5), "source: expected a text, a path, a System or what vehicledyn.load"),
        (
            lambda: vd.identify("quarter_car", MEASURED, {"body.mass": {}}),
            "parameters.body.mass.from: missing; give both bounds",
        ),
        (lambda: vd.contact_geometry("S1002", "60E1", shifts=[]), "shifts: give one value or more"),
        (lambda: vd.rig("sedan", "twist"), "test: no test named 'twist'"),
        (
            lambda: vd.rig("double_wishbone_axle", "steer", steering="rak"),
            "steering: no coordinate named 'rak'",
        ),
        (
            lambda: vd.kinematics("four_bar", {"crank.angel": ("0 deg", "9 deg", 2)}),
            "drives: no coordinate or sensor of positions named 'crank.angel'; did you mean",
        ),
        (
            lambda: vd.kinematics("four_bar", {"crank.angle": ("0 deg", "9 deg", 2)}, hold="x"),
            "hold: no coordinate named 'x'",
        ),
        (
            lambda: vd.cam({"follower": {"kind": "flat"}}),
            "cam:1:1: give either a motion with a base_radius, or an outline",
        ),
        (lambda: vd.rig("sedan", values=("0 m", "1 m")), "values=('0 m', '1 m'): write (from, to,"),
        (lambda: vd.rig("sedan", travel="high"), "travel='high': expected a number with a unit"),
        (lambda: vd.sensitivity("four_bar", "max(x)"), "of: 'max(x)' is neither a key figure nor"),
        (lambda: vd.sensitivity("four_bar", "max(crank.angle)", "x"), "to: 'x' matches no"),
        (lambda: vd.contact_geometry("S10022", "60E1"), "wheel: 'S10022' is neither a file nor"),
        (
            lambda: vd.contact_geometry("S1002", "60E1", right_rail="60E11"),
            "right_rail: '60E11' is neither a file nor",
        ),
        (lambda: vd.sweep("four_bar", vary={"duratio": [1]}, channels="x"), "vary['duratio']: "),
        (lambda: vd.sweep("four_bar", vary={"x": [1]}, channels=5), "expected a text, a list of"),
        (lambda: vd.modes({}), "model: give one or more"),
        (lambda: vd.contact_geometry("S1002", "60E1", gauge=1e200), "gauge=1e+200: must be below"),
        (lambda: vd.report("a" * 3000), "result: 'aaaaaaaaaaaa...aaaaaaaaaaaaa' names no file: "),
        (lambda: vd.hunt("simple_wheelset", 1, 2, points=10**39), "points=1000000000000"),
        (lambda: scattered(number=10**39), "number: 1000000000000"),
        (lambda: scattered(seed=-1), "seed: -1: give a whole number"),
        (lambda: slope("quarter_car", "quarter_car"), "of: 'quarter_car' is neither a key figure"),
        (lambda: slope("mean(body.height)", "quarter_car"), "to: 'quarter_car' matches no param"),
        (
            lambda: vd.sensitivity("quarter_car", "critical_speed", "quarter_car"),
            "scenario or to: 'quarter_car' has no parameter 'speed'",
        ),
        (lambda: vd.load_plugin("a\0b"), "path: 'a\\x00b' names no file: embedded null byte"),
    ],
)  # fmt: skip
def test_messages_say_what_is_expected(call, words):
    with pytest.raises(InputError) as refused:
        call()
    assert words in str(refused.value)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"workers": -3}, "workers=-3: give 1 or more"),
        ({"workers": 0}, "workers=0: give 1 or more"),
        ({"lanes": 0}, "lanes=0: choose 1, 4 or 8"),
        ({"vary": {"parameters.body.mas": ["1 kg"]}}, "vary['parameters.body.mas']: "),
        ({"vary": {"parameters.body.mas": ["1 kg"]}}, "1 problem in the study"),
        ({"vary": {}}, "vary: cases.vary: nothing varies"),
        ({"vary": None, "cases": {"kind": "random", "number": 0}}, "cases: cases.number: "),
    ],
)
def test_sweeps_from_python_name_arguments(given, words):
    """Neither a study file nor places in one are mentioned, and no process is waited for."""
    vary = {"parameters.body.mass": ["300 kg"]}
    with pytest.raises(InputError) as refused:
        vd.sweep("quarter_car", **{"vary": vary, "duration": "0.1 s", "workers": 1, **given})
    assert words in str(refused.value)
    assert "study:" not in str(refused.value)


def test_other_callers_give_other_names():
    """The command line, say, has options in place of arguments."""

    class Options:
        def argument(self, name):
            return f"--{name}"

    @checked
    def halve(value: float) -> float:
        return value / 2

    assert halve(np.float64(3.0)) == 1.5
    with (
        arguments_named(Options()),
        pytest.raises(InputError, match=r"^--value: expected a number"),
    ):
        halve(True)
    with pytest.raises(TypeError, match=r"halve\(\) missing 1 required positional argument"):
        halve()


@pytest.mark.parametrize("value", [np.array([1.0, 2.0]), np.True_, 10**400])
def test_what_only_looks_like_a_number_is_refused(value):
    """Arrays and truths of NumPy have the methods of numbers, and whole ones may be too large."""

    @checked
    def halve(value: float) -> float:
        return value / 2

    with pytest.raises(InputError, match=r"^value: expected a number, found "):
        halve(value)


def test_truths_and_numbers_of_numpy_are_taken():
    @checked
    def scaled(value: float, twice: bool, times: int | None = None) -> float:
        return value * (2 if twice else 1) * (times or 1)

    assert scaled(np.array(3.0), np.True_, np.int64(2)) == 12.0
    with pytest.raises(InputError, match="twice: expected True or False"):
        scaled(3.0, np.array([True, False]))
    with pytest.raises(InputError, match="times: expected a whole number"):
        scaled(3.0, np.False_, np.array([1, 2]))


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda data, a: data[["body.height"]], "name: expected a text, found ['body.height']"),
        (lambda data, a: data.names(3), "patterns: expected a text, found 3"),
        (lambda data, a: data.plot("body.height", against=["time"]), "against: expected a text or"),
        (lambda data, a: data.plot("body.height", others={"old": "x"}), "others: expected a "),
        (lambda data, a: data.save(3), "path: expected a text or a path, found 3"),
        (lambda data, a: data.export(None), "path: expected a text or a path, found None"),
        (lambda data, a: a.to(1e3), "unit: expected a text, found 1000.0"),
    ],
)  # fmt: skip
def test_results_refuse_what_they_cannot_use(ask, words):
    data = vd.equilibrium("quarter_car")
    with pytest.raises(InputError) as refused:
        ask(data, data[next(iter(data))])
    assert words in str(refused.value)


@pytest.mark.parametrize("number", [np.float32(0.5), np.int64(2), np.float64(0.5), 2])
def test_quantities_take_numbers_of_numpy(number):
    assert to_si(number, "kg") == float(number)


def test_a_noise_that_is_none_is_named():
    measured = {"body.height": ([0.0, 0.1], [0.0, 0.0], "1 kg")}
    with pytest.raises(InputError, match=r"^measured: body\.height: noise: "):
        vd.identify("quarter_car", measured, {"body.mass": {"from": "1 kg", "to": "2 kg"}})


def test_arrays_of_results_are_lists_of_numbers():
    speeds = vd.modes("small_car", speed=[10.0, 20.0])["speed"]
    again = vd.modes("small_car", speed=speeds)["speed"]
    assert list(again) == [10.0, 20.0]


def test_numbers_of_other_libraries_become_pythons_own():
    """Decimals, fractions and arrays arrive as numbers and lists, paths are ones of a file."""

    @checked
    def taken(share: float, by: Mapping[str, float], of: Iterable[float | str], n: int = 1):
        return [share, by, of, n]

    found = taken(Decimal("0.5"), {"a": Fraction(1, 4)}, np.array([1.0, 2.0]), np.int64(3))
    assert found == [0.5, {"a": 0.25}, [1.0, 2.0], 3]
    assert [type(item) for item in (found[0], found[1]["a"], found[2], found[3])] == [
        float, float, list, int,
    ]  # fmt: skip
