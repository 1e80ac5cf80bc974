"""The elementary functions of compiled kernels against NumPy's in extended precision."""

import ctypes

import numpy as np
import pytest

from vehicledyn.codegen.printers.kernel_source import shared_source
from vehicledyn.codegen.toolchain.compiler import build_library, find_compiler, suitable_lanes
from vehicledyn.kernel.lanes import CHOICES

NAMES = ("sincos", "sin", "atan", "atan2", "asin", "acos", "exp", "log", "tanh", "pow", "floor")
TWO_IN, TWO_OUT = ("atan2", "pow"), ("sincos",)
UNITS = 2.2  # in the last place


def build(lanes, folder):
    """Return a caller of the functions of elementary.c by name, as a kernel of so many lanes."""
    doors = [
        f"VD_EXPORT void door_{name}(int n, double *a, double *b, double *c) "
        + f"{{ vd_{name}(n, a, b{', c' if name in TWO_IN + TWO_OUT else ''}); }}"
        for name in NAMES
    ]
    parts = [shared_source("real.h"), shared_source("elementary.c"), *doors]
    source = "\n".join([f"#define VD_LANES {lanes}", *parts])
    library = ctypes.CDLL(str(build_library(find_compiler(), source, folder)))

    def function(name, *given):
        n = len(given[0])
        arrays = [np.zeros(n + 8) for _ in range(3)]
        for array, values in zip(arrays, given, strict=False):
            array[:n] = values
        door = getattr(library, f"door_{name}")
        door(n, *[ctypes.c_void_p(array.ctypes.data) for array in arrays])
        return [array[:n] for array in arrays[len(given) :]]

    return function


@pytest.fixture(scope="module")
def call(tmp_path_factory, needs_compiler):
    """Call a function as a kernel for one case does."""
    return build(1, tmp_path_factory.mktemp("elementary"))


def spread(low, high, *, signs=(-1, 1)):
    """Random numbers of all magnitudes between two."""
    rng = np.random.default_rng(7)
    return np.exp(rng.uniform(np.log(low), np.log(high), 20_000)) * rng.choice(signs, 20_000)


def between(low, high):
    return np.random.default_rng(8).uniform(low, high, 20_000)


def units(found, exact):
    """Return the largest error in units in the last place."""
    return float((np.abs(found - exact) / np.spacing(np.abs(exact.astype(float)))).max())


QUARTERS = np.arange(-10_000, 10_000) * np.pi / 2
CASES = {
    "sin": ("sincos", 0, np.sin, [between(-4, 4), spread(1e-20, 1e5), QUARTERS, between(1e6, 1e9)]),
    "cos": ("sincos", 1, np.cos, [between(-4, 4), spread(1e-20, 1e5), QUARTERS, between(1e6, 1e9)]),
    "atan": ("atan", 0, np.arctan, [between(-4, 4), spread(1e-20, 1e20)]),
    "asin": ("asin", 0, np.arcsin, [between(-1, 1), spread(1e-10, 1)]),
    "acos": ("acos", 0, np.arccos, [between(-1, 1), 1 - spread(1e-16, 1, signs=(1,))]),
    "exp": ("exp", 0, np.exp, [between(-1, 1), between(-700, 700), spread(1e-20, 1)]),
    "log": (
        *("log", 0, np.log),
        [
            *(between(0.5, 2), spread(1e-300, 1e300, signs=(1,))),
            *(between(2.3e-308, 9e-308), between(1e308, 1.79e308)),
        ],
    ),
    "tanh": ("tanh", 0, np.tanh, [between(-1, 1), between(-30, 30), spread(1e-20, 1)]),
}
SPECIAL = np.array(
    [0.0, -0.0, 1, -1, 2, -2, 0.5, np.inf, -np.inf, np.nan, 5e-324, 1e-310, 1e308, 800, -800, 1e22]
)


@pytest.mark.parametrize("name", CASES)
def test_errors_are_small(call, name):
    function, place, exact, ranges = CASES[name]
    for values in ranges:
        wanted = exact(values.astype(np.longdouble))
        assert units(call(function, values)[place], wanted) < UNITS


def test_errors_of_the_angle_of_a_point_are_small(call):
    for y, x in [
        (between(-1, 1), spread(1e-8, 1e8)),
        (spread(1e-8, 1e8), between(-1, 1)),
        (between(-1, 1), -np.abs(spread(1e-3, 1e3))),
    ]:
        wanted = np.arctan2(y.astype(np.longdouble), x.astype(np.longdouble))
        assert units(call("atan2", y, x)[0], wanted) < UNITS


def alike(found, wanted):
    """Return where two arrays agree but for rounding, signs of zeros and no-numbers included."""
    with np.errstate(invalid="ignore"):
        near = np.abs(found - wanted) <= 1e-15 * np.abs(wanted)
    return (
        (np.isnan(found) & np.isnan(wanted))
        | ((found == wanted) & (np.signbit(found) == np.signbit(wanted)))
        | near & (wanted != 0.0)
    )


@pytest.mark.parametrize("name", CASES)
def test_special_values(call, name):
    function, place, exact, _ = CASES[name]
    with np.errstate(all="ignore"):
        wanted = exact(SPECIAL)
    found = call(function, SPECIAL)[place]
    if name == "sin":  # of -0 is +0, as elementary.c says
        found[1] = -found[1]
    assert alike(found, wanted).all(), SPECIAL[~alike(found, wanted)]


def test_angles_of_special_points(call):
    y, x = (grid.ravel() for grid in np.meshgrid(SPECIAL, SPECIAL))
    wanted = np.arctan2(y, x)
    found = call("atan2", y, x)[0]
    good = alike(found, wanted)
    assert good.all(), list(zip(y[~good], x[~good], found[~good], wanted[~good], strict=True))


def test_a_sine_is_the_same_with_and_without_its_cosine(call):
    for values in (SPECIAL, between(-4, 4), spread(1e-20, 1e9), np.full(8, 0.3)):
        assert np.array_equal(call("sin", values)[0], call("sincos", values)[0], equal_nan=True)


@pytest.mark.parametrize("name", ["sincos", "sin", "atan", "exp", "log", "tanh", "acos"])
def test_the_place_in_an_array_does_not_matter(call, name):
    values = np.abs(between(-1, 1))
    values[::97] = 1e9  # given to the C library
    whole = np.array(call(name, values)[0])
    for first, count in [(1, 1), (3, 2), (5, 7), (96, 9)]:
        part = call(name, values[first : first + count])[0]
        assert np.array_equal(part, whole[first : first + count], equal_nan=True)


@pytest.mark.parametrize("lanes", [lanes for lanes in CHOICES if 1 < lanes <= suitable_lanes()])
def test_the_number_of_lanes_does_not_matter(call, lanes, tmp_path):
    wide = build(lanes, tmp_path)
    for name in NAMES:
        points = [np.concatenate([SPECIAL, spread(1e-6, 1e6)[:2000], between(-1, 1)[:2000]])]
        if name in TWO_IN:
            points.append(points[0][::-1])
        for alone, abreast in zip(call(name, *points), wide(name, *points), strict=True):
            assert np.array_equal(alone, abreast, equal_nan=True), name
