"""Every tyre of the catalogue: signs, symmetry, friction, finiteness; and each law's own facts."""

import math

import numpy as np
import pytest

import vehicledyn.road  # noqa: F401
from vehicledyn.base.registry import find, kinds
from vehicledyn.road.tyres import calspan, magic_formula_1987
from vehicledyn.road.tyres.calspan import Calspan
from vehicledyn.road.tyres.linear import Linear
from vehicledyn.road.tyres.magic_formula_1987 import MagicFormula1987
from vehicledyn.road.tyres.tyre import TyreInput
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.parameters import ParameterTable

LINEAR = {
    "nominal_load": "4 kN",
    "longitudinal_stiffness": "80 kN",
    "cornering_stiffness": "45 kN/rad",
    "camber_stiffness": "2 kN/rad",
    "trail": "30 mm",
    "friction": 0.9,
}
EXAMPLES = {"calspan": {}, "magic_formula_1987": {}, "linear": LINEAR}
AWKWARD = [
    (load, slip, angle, camber)
    for load in (0.0, 1e-9, 1.0, 4e3, 2e4, 1e5)
    for slip in (-100.0, -1.0, 0.0, 50.0)
    for angle in (-math.pi / 2, 0.0, 0.1)
    for camber in (0.0, -0.05, 1.5)
]


def tyre(kind):
    return find("tyre", kind)(**EXAMPLES[kind])


def vector(kind_or_tyre, *felt):
    law = tyre(kind_or_tyre) if isinstance(kind_or_tyre, str) else kind_or_tyre
    forces = law.forces(TyreInput(*felt))
    return np.array(
        [float(forces.longitudinal_force), forces.lateral_force, forces.aligning_moment]
    )


def test_every_tyre_has_an_example():
    assert set(kinds("tyre")) == set(EXAMPLES)


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
def test_signs(kind):
    along, across, moment = vector(kind, 4e3, 0.02, 0.03, 0.0)
    assert along >= 0.0 and across < 0.0 and moment > 0.0
    assert vector(kind, 4e3, 0.0, 0.0, 0.05)[1] < 0.0


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
@pytest.mark.parametrize("felt", [(4e3, 0.05, 0.04, 0.02), (500.0, -0.3, 0.4, -0.1)])
def test_left_and_right_are_mirrored(kind, felt):
    load, slip, angle, camber = felt
    mirrored = vector(kind, load, slip, -angle, -camber)
    assert mirrored * [1, -1, -1] == pytest.approx(vector(kind, *felt), rel=1e-12)


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
def test_no_load_no_force(kind):
    assert np.all(vector(kind, 0.0, 0.3, 0.2, 0.1) == 0.0)
    assert np.abs(vector(kind, 1e-6, 0.3, 0.2, 0.1)).max() < 1e-5


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
def test_slip_never_gives_energy(kind):
    for slip in (-1.0, -0.1, 0.0, 0.05, 3.0):
        for angle in (-1.2, -0.1, 0.0, 0.02, 0.5):
            along, across, _ = vector(kind, 4e3, slip, angle, 0.0)
            assert along * slip - across * math.tan(angle) >= 0.0


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
def test_values_and_slopes_are_finite_everywhere(kind):
    symbols = [ops.symbol(name) for name in ("load", "slip", "angle", "camber")]
    forces = tyre(kind).forces(TyreInput(*symbols))
    column = ops.column([forces.longitudinal_force, forces.lateral_force, forces.aligning_moment])
    value = ops.numeric(symbols, column)
    slope = ops.numeric(symbols, ops.jacobian(column, ops.column(symbols)))
    for felt in AWKWARD:
        values, slopes = value(*felt)[:, 0], slope(*felt)
        assert np.isfinite(values).all() and np.isfinite(slopes).all(), felt
        assert np.hypot(values[0], values[1]) <= 2.0 * felt[0], felt


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
def test_continuous_along_random_lines(kind):
    rng = np.random.default_rng(1)
    ends = rng.uniform([0, -2, -1.5, -0.4], [3e4, 2, 1.5, 0.4], size=(6, 2, 4))
    for start, stop in ends:
        steps = np.linspace(0, 1, 2001)
        forces = np.array([vector(kind, *(start + s * (stop - start))) for s in steps])
        jumps = np.abs(np.diff(forces, axis=0)).max(axis=0)
        assert np.all(jumps < [1e3, 1e3, 60.0])


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
def test_parameters_may_be_symbols(kind):
    table = ParameterTable()
    symbolic = table.add_set("tyre", tyre(kind))
    assert len(table.entries) > 5
    felt = TyreInput(4e3, 0.02, 0.05, 0.01)
    symbols = [entry.symbol for entry in table.entries]
    force = ops.numeric(symbols, ops.column([symbolic.forces(felt).lateral_force]))
    found = force(*[entry.value for entry in table.entries])[0, 0]
    assert found == pytest.approx(vector(kind, 4e3, 0.02, 0.05, 0.01)[1], rel=1e-14)


@pytest.mark.parametrize(
    ("module", "name"),
    [(calspan, "FORCE_FLOOR"), (calspan, "FRICTION_FLOOR"), (magic_formula_1987, "SLIP_FLOOR")],
)
def test_halving_a_floor_moves_nothing(module, name, monkeypatch):
    kind = module.__name__.rpartition(".")[2]
    before = vector(kind, 3e3, 0.05, 0.06, 0.02)
    monkeypatch.setattr(module, name, 0.5 * getattr(module, name))
    assert vector(kind, 3e3, 0.05, 0.06, 0.02) == pytest.approx(before, abs=1e-6)


def test_calspan_slides_at_its_friction():
    load = 4e3
    friction = (-0.464e-4 * load + 1.216 + 2.18e-11 * load**2) * 1.0274
    assert vector("calspan", load, 0.0, 0.8, 0.0)[1] == pytest.approx(-friction * load, rel=1e-12)


def test_calspan_coefficients_can_be_overridden_one_by_one():
    changed = Calspan(skid_number=0.5)
    assert changed.a0 == Calspan().a0 == 2625.0
    assert abs(vector(changed, 4e3, 0, 0.8, 0)[1]) < abs(vector("calspan", 4e3, 0, 0.8, 0)[1])


def test_magic_formula_reaches_its_peaks_in_combined_slip():
    """At ρ = 1 the force lies on the ellipse through the two pure peaks."""
    slips, angles = np.linspace(0.02, 0.4, 2000), np.linspace(0.02, 0.5, 2000)
    along = max(vector("magic_formula_1987", 4e3, s, 0.0, 0.0)[0] for s in slips)
    across = max(-vector("magic_formula_1987", 4e3, 0.0, a, 0.0)[1] for a in angles)
    assert along == pytest.approx(-21.3 * 16 + 1144 * 4, rel=1e-6)
    assert across == pytest.approx(-22.1 * 16 + 1011 * 4, rel=1e-6)
    for slip, angle in ((0.05, 0.05), (0.1, 0.2), (-0.3, 0.1), (-1.0, 0.6)):
        fx, fy, _ = vector("magic_formula_1987", 4e3, slip, angle, 0.0)
        assert math.hypot(fx / along, fy / across) <= 1.0 + 1e-9


def test_magic_formula_on_ice_keeps_its_slope_and_scales_its_peak():
    ice, dry = MagicFormula1987(friction=0.3), MagicFormula1987()
    assert vector(ice, 4e3, 0, 1e-6, 0)[1] == pytest.approx(
        vector(dry, 4e3, 0, 1e-6, 0)[1], rel=1e-5
    )
    assert vector(ice, 4e3, 0.03, 0, 0)[0] == pytest.approx(
        0.3 * vector(dry, 4e3, 0.1, 0, 0)[0], rel=1e-9
    )


def test_magic_formula_takes_a_single_coefficient():
    changed = MagicFormula1987(lateral={"a2": 900.0})
    assert changed.lateral.a1 == -22.1
    assert changed.lateral.a2 == 900.0


def test_linear_is_linear_to_half_the_friction_and_saturates():
    assert vector("linear", 2e3, 0.01, 0.0, 0.0)[0] == pytest.approx(400.0, rel=1e-6)
    assert vector("linear", 4e3, 0.0, -0.02, 0.01)[1] == pytest.approx(900 - 20, rel=1e-6)
    for slip, angle in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.7)):
        fx, fy, _ = vector("linear", 4e3, slip, angle, 0.0)
        assert math.hypot(fx, fy) == pytest.approx(0.9 * 4e3, rel=1e-12)


def test_linear_names_what_is_missing():
    with pytest.raises(ValueError, match="friction"):
        Linear(**{k: v for k, v in LINEAR.items() if k != "friction"})
