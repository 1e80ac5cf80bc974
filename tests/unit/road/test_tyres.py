"""Every tyre of the catalogue: signs, symmetry, friction, finiteness; and each law's own facts."""

import csv
import importlib
import inspect
import math
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

import vehicledyn.road  # noqa: F401
from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import find, kinds
from vehicledyn.road.tyres import brush, calspan, similarity, tmeasy
from vehicledyn.road.tyres.calspan import Calspan
from vehicledyn.road.tyres.linear import Linear
from vehicledyn.road.tyres.magic_formula_1987 import MagicFormula1987
from vehicledyn.road.tyres.scaling_factors import UNREAD, ScalingFactors
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
PAC2002 = {"file": "passenger_235_60R16_pac2002.tir"}
MF61 = {"file": "passenger_R0394_mf61.tir"}
BRUSH = {
    "nominal_load": "4 kN",
    "slip_stiffness": "80 kN",
    "half_length": "60 mm",
    "friction": 0.9,
    "camber_stiffness": "2 kN/rad",
}
DUGOFF = {"longitudinal_stiffness": "80 kN", "cornering_stiffness": "60 kN/rad", "friction": 0.9}
TMEASY = {
    "nominal_load": "3 kN",
    "longitudinal": {
        "slope": ["120 kN", "200 kN"],
        "peak_slip": [0.11, 0.12],
        "peak_force": ["3.3 kN", "6 kN"],
        "sliding_slip": [0.5, 0.5],
        "sliding_force": ["3 kN", "5.7 kN"],
    },
    "lateral": {
        "slope": ["55 kN", "80 kN"],
        "peak_slip": [0.2, 0.22],
        "peak_force": ["3.1 kN", "5.4 kN"],
        "sliding_slip": [0.8, 0.8],
        "sliding_force": ["3 kN", "5.3 kN"],
    },
    "trail": "30 mm",
    "camber_slip": 0.05,
}
MF89 = {  # numbers of SAE 870421 in the form of 1989, its camber terms left out
    "lateral": [1.3, -22.1, 1011, 1050, 4.8, 0, -0.354, 0.707, 0.028, 0, 0, 14.8, 0, 0],
    "longitudinal": [1.65, -21.3, 1144, 49.6, 226, 0.069, -0.006, 0.056, 0.486, 0, 0],
    "aligning": [2.4, -2.72, -2.28, -1.86, -2.73, 0.11, 0.03, -0.07, 0.643, -4.04, 0, 0.015,
                 0, 0, -0.066, 0.945, 0, 0],
}  # fmt: skip
EXAMPLES = {
    "calspan": {},
    "magic_formula_1987": {},
    "linear": LINEAR,
    "pac2002": PAC2002,
    "magic_formula_61": MF61,
    "file": MF61,
    "brush": BRUSH,
    "dugoff": DUGOFF,
    "tmeasy": TMEASY,
    "magic_formula_1989": MF89,
}
OF_FILES = {
    "pac2002": {},
    "magic_formula_52": {"FITTYP": "6"},
    "magic_formula_61": {},
    "magic_formula_62": {"FITTYP": "62"},
    "file": {},
}
"""Laws of files; those without a file in the library are tested with others' numbers."""

ODD = {"pac2002", "magic_formula_61", "file"}
"""Laws whose tyres are not their own mirror images: plysteer and conicity."""

COMPLETE = {"calspan", "linear", "magic_formula_1987", "pac2002", "magic_formula_61", "file"}
"""Laws with camber and aligning moment; other laws may leave these out."""
AWKWARD = [
    (load, slip, angle, camber)
    for load in (0.0, 1e-9, 1.0, 4e3, 2e4, 1e5)
    for slip in (-100.0, -1.0, 0.0, 50.0)
    for angle in (-math.pi / 2, 0.0, 0.1)
    for camber in (0.0, -0.05, 1.5)
]


def tyre(kind):
    return find("tyre", kind)(**EXAMPLES[kind])


def symmetric(kind):
    """Return a tyre that is its own mirror image."""
    change = {"mirror": "symmetric"} if kind in ODD else {}
    return find("tyre", kind)(**EXAMPLES[kind], **change)


def vector(kind_or_tyre, *felt):
    law = tyre(kind_or_tyre) if isinstance(kind_or_tyre, str) else kind_or_tyre
    forces = law.forces(TyreInput(*felt))
    return np.array(
        [float(forces.longitudinal_force), forces.lateral_force, forces.aligning_moment]
    )


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
def test_friction_of_the_ground_scales_that_of_the_law(kind):
    dry = tyre(kind)
    own = getattr(dry, dry.friction_field)
    icy = find("tyre", kind)(**EXAMPLES[kind] | {dry.friction_field: 0.25 * own})
    for slip, angle in ((0.0, 0.004), (0.0, 0.1), (-0.4, 0.0), (0.3, -0.4)):
        felt = 3700.0, slip, angle, 0.0, 20.0
        found = vector(dry.on_ground(0.25), *felt)
        assert found == pytest.approx(vector(icy, *felt), rel=1e-12, abs=1e-9)
    assert abs(found[1]) < 0.6 * abs(vector(dry, *felt)[1])


def test_every_tyre_has_an_example():
    assert set(kinds("tyre")) == set(EXAMPLES) | set(OF_FILES)


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
def test_signs(kind):
    along, across, moment = vector(symmetric(kind), 4e3, 0.02, 0.03, 0.0)
    assert along >= 0.0 and across < 0.0
    assert moment > 0.0 or (kind not in COMPLETE and moment == 0.0)
    leaning = vector(symmetric(kind), 4e3, 0.0, 0.0, 0.05)[1]
    assert leaning < 0.0 or (kind not in COMPLETE and leaning == 0.0)


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
@pytest.mark.parametrize("felt", [(4e3, 0.05, 0.04, 0.02), (500.0, -0.3, 0.4, -0.1)])
def test_left_and_right_are_mirrored(kind, felt):
    load, slip, angle, camber = felt
    law = symmetric(kind)
    mirrored = vector(law, load, slip, -angle, -camber)
    assert mirrored * [1, -1, -1] == pytest.approx(vector(law, *felt), rel=1e-12)


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
def test_no_load_no_force(kind):
    assert np.all(vector(kind, 0.0, 0.3, 0.2, 0.1) == 0.0)
    assert np.abs(vector(kind, 1e-6, 0.3, 0.2, 0.1)).max() < 1e-5


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
def test_slip_never_gives_energy(kind):
    for slip in (-1.0, -0.1, 0.0, 0.05, 3.0):
        for angle in (-1.2, -0.1, 0.0, 0.02, 0.5):
            along, across, _ = vector(symmetric(kind), 4e3, slip, angle, 0.0)
            assert along * slip - across * math.tan(angle) >= 0.0


def of_symbols(kind):
    """Return the forces of a law as a function of four numbers, fast to call."""
    symbols = [ops.symbol(name) for name in ("load", "slip", "angle", "camber")]
    forces = tyre(kind).forces(TyreInput(*symbols))
    column = [forces.longitudinal_force, forces.lateral_force, forces.aligning_moment]
    return ops.numeric(symbols, ops.column(column))


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
    """Residual moments change by a quarter within a step: 1.5 mrad of the 5.7 of their width."""
    value = of_symbols(kind)
    rng = np.random.default_rng(1)
    ends = rng.uniform([0, -2, -1.5, -0.4], [3e4, 2, 1.5, 0.4], size=(6, 2, 4))
    for start, stop in ends:
        along = start + np.linspace(0, 1, 2001)[:, None] * (stop - start)
        forces = value(*along.T[:, None]).T
        jumps = np.abs(np.diff(forces, axis=0)).max(axis=0)
        narrow = 0.3 * np.ptp(forces[:, 2]) if kind in OF_FILES else 0.0
        assert np.all(jumps < [1e3, 1e3, max(60.0, narrow)])


@pytest.mark.parametrize("kind", sorted(EXAMPLES))
def test_parameters_may_be_symbols(kind):
    table = ParameterTable()
    symbolic = table.add_set("tyre", tyre(kind))
    assert len(table.entries) > (0 if kind in OF_FILES else 2)
    felt = TyreInput(4e3, 0.02, 0.05, 0.01)
    symbols = [entry.symbol for entry in table.entries]
    force = ops.numeric(symbols, ops.column([symbolic.forces(felt).lateral_force]))
    found = force(*[entry.value for entry in table.entries])[0, 0]
    assert found == pytest.approx(vector(kind, 4e3, 0.02, 0.05, 0.01)[1], rel=1e-14)


@pytest.mark.parametrize(
    ("module", "name", "kind"),
    [
        (calspan, "FORCE_FLOOR", "calspan"),
        (calspan, "FRICTION_FLOOR", "calspan"),
        (similarity, "SLIP_FLOOR", "magic_formula_1987"),
        (brush, "SLIP_FLOOR", "brush"),
        (brush, "ROLLING_FLOOR", "brush"),
        (tmeasy, "SLIP_FLOOR", "tmeasy"),
    ],
)
def test_halving_a_floor_moves_nothing(module, name, kind, monkeypatch):
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


@pytest.mark.parametrize(("slip", "angle"), [(0.01, 0.0), (0.0, 0.05), (-0.04, 0.03), (0.3, 0.4)])
def test_dugoff_is_the_sum_over_bristles_under_uniform_pressure(slip, angle):
    load, stiffness, length = 4e3, 80e3, 0.12
    law = find("tyre", "dugoff")(**DUGOFF | {"cornering_stiffness": "80 kN/rad"})
    sx, sy = slip / (1.0 + slip), math.tan(angle) / (1.0 + slip)
    size = math.hypot(sx, sy)
    x = (np.arange(200_000) + 0.5) * length / 200_000
    shear = np.minimum(2.0 * stiffness / length**2 * size * x, 0.9 * load / length)
    force = shear.mean() * length
    wanted = (force * sx / size, -force * sy / size, 0.0)
    assert vector(law, load, slip, angle, 0.0) == pytest.approx(wanted, rel=1e-8, abs=1e-6)


PUBLISHED = {  # load, angle [deg], F_y, M_z; F_x at κ = 0.1 and -0.1: two public programs agree
    2000.0: (-1977.75919, 9.584, 2579.71182, -2285.65078),
    4000.0: (-3858.21376, 32.045, 5091.57157, -4521.01847),
    6000.0: (-5588.67090, 63.080, 7459.77988, -6633.22061),
}


@pytest.mark.parametrize("load", sorted(PUBLISHED))
def test_magic_formula_61_gives_the_numbers_of_public_programs(load):
    across, moment, driving, braking = PUBLISHED[load]
    _, fy, mz = vector("magic_formula_61", load, 0.0, math.radians(4.0), 0.0)
    assert fy == pytest.approx(across, abs=1e-3) and mz == pytest.approx(moment, abs=1e-3)
    for slip, force in ((0.1, driving), (-0.1, braking)):
        assert vector("magic_formula_61", load, slip, 0.0, 0.0)[0] == pytest.approx(force, abs=1e-3)


def test_magic_formula_61_in_combined_slip():
    fx, fy, _ = vector("magic_formula_61", 4000.0, 0.1, math.radians(4.0), 0.0)
    assert fx == pytest.approx(4167.96742, abs=1e-3) and fy == pytest.approx(-2606.96426, abs=1e-3)


@pytest.mark.parametrize(
    ("load", "along", "across"),
    [(2000, 0.30400, 0.29403), (4000, 0.66371, 0.52301), (6000, 1.00478, 0.66241)],
)
def test_relaxation_lengths_of_pac2002(load, along, across):
    found = tyre("pac2002").relaxation_lengths(TyreInput(load, 0.0, 0.0, 0.0))
    assert float(found.longitudinal) == pytest.approx(along, abs=1e-5)
    assert float(found.lateral) == pytest.approx(across, abs=1e-5)


def test_relaxation_lengths_of_61_are_stiffness_over_stiffness():
    law, step = tyre("magic_formula_61"), 1e-6
    found = law.relaxation_lengths(TyreInput(6752.0, 0.0, 0.0, 0.0))
    ends = [vector(law, 6752.0, s - 0.0010644, 0.0, 0.0)[0] for s in (step, -step)]
    slope = (ends[0] - ends[1]) / (2 * step)
    assert float(found.longitudinal) == pytest.approx(slope / 391219.8116, rel=2e-2)


def reference(name):
    path = Path(__file__).parents[4] / "shared" / "reference" / "road" / "tyres" / name
    if not path.exists():
        pytest.skip("needs the reference data, which a clone does not have")
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


@pytest.mark.parametrize(
    ("kind", "name", "columns", "sign"),
    [
        ("magic_formula_61", "mf61_peers_steady_state.csv", ("Fx_ref", "Fy_ref", "Mz_ref"), 1),
        ("pac2002", "pac2002_peers_steady_state.csv",
         ("Fx_opentire", "Fy_opentire", "Mz_opentire", "Mx_opentire", "My_opentire"), -1),
    ],
)  # fmt: skip
def test_tables_of_public_programs(kind, name, columns, sign):
    law = tyre(kind)
    for row in reference(name)[::3]:
        angle, camber = (math.radians(float(row[f"{n}_deg"])) for n in ("alpha", "gamma"))
        f = law.forces(TyreInput(float(row["Fz"]), float(row["kappa"]), angle, camber, 16.6))
        found = [f.longitudinal_force, f.lateral_force, f.aligning_moment, f.overturning_moment]
        found.append(sign * f.rolling_resistance)
        for value, column in zip(found, columns, strict=False):
            assert float(value) == pytest.approx(float(row[column]), abs=1e-5)


def test_conventions_of_other_programs():
    rows = reference("mf61_peers_steady_state.csv")
    library = find("tyre", "magic_formula_61")(**MF61, convention="mf_tyre_library")
    angles = find("tyre", "magic_formula_61")(**MF61, convention="angles")
    for row in rows[::5]:
        angle, camber = (math.radians(float(row[f"{n}_deg"])) for n in ("alpha", "gamma"))
        felt = (float(row["Fz"]), float(row["kappa"]), angle, camber)
        assert vector(library, *felt)[2] == pytest.approx(float(row["Mz_teasit"]), abs=1e-3)
        drag = library.forces(TyreInput(*felt, 16.6)).rolling_resistance
        assert float(drag) == pytest.approx(float(row["My_teasit"]), abs=1e-4)
        brian = [float(row["Fx_brian"]), float(row["Fy_brian"])]
        assert vector(angles, *felt)[:2] == pytest.approx(brian, abs=1e-4)


CHRONO = {"uncombined": "none", "friction_ellipse_default": "ellipse", "mf_combined": "pacejka"}


def test_chrono_rules():
    folder = Path(__file__).parents[4] / "shared" / "reference" / "road" / "vehicles"
    rows = reference("chrono_pac02_eval.csv")
    laws = {
        (car, mode): find("tyre", "pac2002")(
            file=str(folder / f"chrono_{name}_Pac02Tire.tir"), convention="chrono", combined=way
        )
        for car, name in (("sedan", "Sedan"), ("hmmwv", "HMMWV"))
        for mode, way in CHRONO.items()
    }
    for row in rows[::29]:
        law = laws[row["tir"].partition("/")[0], row["mode"]]
        felt = [float(row[n]) for n in ("Fz_N", "kappa", "alpha_rad", "gamma_rad")]
        wanted = [float(row[n]) for n in ("Fx_tyre_N", "Fy_tyre_N", "Mz_tyre_Nm")]
        assert vector(law, *felt) == pytest.approx(wanted, abs=1e-6)
        lengths = law.relaxation_lengths(TyreInput(*felt))
        assert float(lengths.longitudinal) == pytest.approx(float(row["sigma_kappa_m"]), abs=1e-9)
        assert float(lengths.lateral) == pytest.approx(float(row["sigma_alpha_m"]), abs=1e-9)


RECORDED = {  # wheel: load, slip, slip angle, camber, F_x, F_y of a run at 22.2 m/s
    "left": (2190.0888, 0.019527, -0.044577, 0.030036, 688.55015, 1549.6202),
    "right": (5816.8863, -0.006698, -0.01322, 0.005479, -717.82106, 1040.0314),
}


@pytest.mark.parametrize("side", RECORDED)
def test_chrono_feeds_its_formula_on_a_car_in_its_own_way(side):
    """A recorded corner of Chrono's sedan: no camber, slips over |v| + 0.1 m/s, other side."""
    file = {"file": "passenger_245_40R18_pac2002.tir", "convention": "chrono_vehicle"}
    law = find("tyre", "file")(**file).mounted(side)
    *felt, along, across = RECORDED[side]
    found = law.forces(TyreInput(*felt, 22.2))
    forces = [float(found.longitudinal_force), float(found.lateral_force)]
    assert forces == pytest.approx([along, across], abs=0.2)
    wanted = (0.344 - 0.009 / 3.0) / math.cos(0.03)
    assert law.rolling_radius(0.344, 0.335, 0.03) == pytest.approx(wanted, rel=1e-14)


def test_a_tyre_of_the_other_side_is_mirrored():
    right = tyre("magic_formula_61")  # the file is that of a right tyre
    left = right.mounted("left")
    there = vector(right.mounted("right"), 4e3, 0.02, 0.03, 0.01)
    assert vector(left, 4e3, 0.02, -0.03, -0.01) == pytest.approx(there * [1, -1, -1], rel=1e-12)
    assert there == pytest.approx(vector(right, 4e3, 0.02, 0.03, 0.01), rel=1e-12)
    assert right.model_copy(update={"mirror": "never"}).mounted("left").mirror == "never"


def test_scaling_friction_and_pressure():
    base = {**MF61}
    slick = find("tyre", "file")(**base, friction=0.5)
    half = find("tyre", "file")(**base, scaling={"LMUX": 0.5, "LMUY": 0.5})
    assert vector(slick, 4e3, 0.1, 0.1, 0.0) == pytest.approx(vector(half, 4e3, 0.1, 0.1, 0.0))
    soft = find("tyre", "file")(**base, pressure="2 bar")
    assert vector(soft, 4e3, 0.0, 0.02, 0.0)[1] != pytest.approx(vector("file", 4e3, 0, 0.02, 0)[1])
    without = find("tyre", "file")(file="passenger_235_60R16_pac2002.tir", pressure="2 bar")
    with pytest.raises(InputError, match=r"pressure: the file has none \(NOMPRES in"):
        vector(without, 4e3, 0.0, 0.02, 0.0)
    with pytest.raises(ValueError, match="LMUX"):
        find("tyre", "file")(**base, scaling={"LMUX": 0.0})
    for name in ("LMUZ", "LGYR", "LCZ"):
        with pytest.raises(Exception, match=name):
            find("tyre", "file")(**base, scaling={name: 1.0})


@pytest.mark.parametrize("version", UNREAD)
def test_scaling_factors_that_no_formula_reads_are_refused(version):
    """Those that are taken stand in the formulas of the version."""
    names = ("formula_61", "turn_slip") if version[0] == "6" else ("formula_52", "formula_chrono")
    modules = [*(f"pacejka.{n}" for n in (*names, "state", "relaxation_lengths")), "file_tyre"]
    found = [importlib.import_module(f"vehicledyn.road.tyres.{name}") for name in modules]
    formulas = "".join(map(inspect.getsource, found))
    read = {name for name in ScalingFactors.model_fields if f"p.{name}" in formulas}
    assert set(ScalingFactors.model_fields) - read == set(UNREAD[version])


def test_a_scaling_factor_of_another_version_is_named():
    of_52 = find("tyre", "file")(file="passenger_235_60R16_pac2002.tir", scaling={"LKYC": 2.0})
    with pytest.raises(InputError, match=r"\.tir: scaling\.LKYC: Magic Formula pac2002 has no"):
        vector(of_52, 4e3, 0.0, 0.02, 0.0)


def test_a_law_refuses_files_of_another_version():
    wrong = find("tyre", "magic_formula_62")(**MF61)
    with pytest.raises(
        InputError, match=r"is of version 6.1, the law 'magic_formula_62' takes 6.2"
    ):
        vector(wrong, 4e3, 0.0, 0.0, 0.0)
    unknown = find("tyre", "file")(**MF61, convention="newest")
    with pytest.raises(InputError, match="no convention named 'newest'"):
        vector(unknown, 4e3, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("kind", sorted(OF_FILES))
def test_laws_of_files_of_every_version(kind, tmp_path):
    name = PAC2002 if kind in ("pac2002", "magic_formula_52") else MF61
    text = (resources.files("vehicledyn.library.tyres") / name["file"]).read_text()
    for key, value in OF_FILES[kind].items():
        text = text.replace("PROPERTY_FILE_FORMAT = 'PAC2002'", f"{key} = {value}")
        text = text.replace("FITTYP = 61", f"{key} = {value}")
    (tmp_path / "a.tir").write_text(text)
    law = find("tyre", kind)(file="a.tir").placed(tmp_path)
    assert not law.problems_beside(Path())
    usual = vector("pac2002" if name is PAC2002 else "file", 3e3, 0.05, 0.06, 0.02)
    assert vector(law, 3e3, 0.05, 0.06, 0.02) == pytest.approx(usual, rel=1e-12)
    assert law.ranges["load"].highest > 5e3


def test_rolling_resistance_turns_with_the_wheel():
    law = tyre("file")
    for speed, sign in ((10.0, -1), (-10.0, 1), (0.0, 0)):
        found = law.forces(TyreInput(4e3, 0.0, 0.0, 0.0, speed)).rolling_resistance
        assert np.sign(float(found)) == sign


def test_rolling_resistance_grows_with_the_power_of_the_load_that_the_file_gives():
    """0.85 in QSY7, as in SAE J2452, is a coefficient that hardly depends on the load."""

    def of_load(load, **more):
        felt = TyreInput(load, 0.0, 0.0, 0.0, 16.6)
        return -float(find("tyre", "file")(**MF61, **more).forces(felt).rolling_resistance)

    assert of_load(6752.0) == pytest.approx(6752 * 0.3943 * 0.01044, rel=1e-12)
    assert of_load(3376.0) == pytest.approx(of_load(6752.0) * 0.5**0.85, rel=1e-12)
    book = of_load(3376.0, convention="mf_tyre_library")
    assert book == pytest.approx(0.5 * of_load(3376.0), rel=1e-12)


SCALED = {"LMUX": 0.8, "LMUY": 0.85, "LFZO": 1.1, "LKY": 0.9, "LS": 1.2, "LTR": 0.9}
SCALED |= {"LKYC": 1.1, "LVY": 1.3}
MF_EVAL = {  # load, slip, slip angle, camber, speed: F_x, F_y, M_z, M_x
    (4e3, 0.05, 0.06, -0.03, 20.0): [2678.371895, -2679.99894, 8.838194, 92.990812],
    (7e3, -0.08, -0.04, 0.05, 10.0): [-5654.655925, 2180.423414, 3.961961, -150.605368],
    (2.5e3, 0.0, 0.1, -0.06, -15.0): [-9.395757, -2179.417277, 6.39912, 77.422617],
}
TURNED = [  # the same and turn slip, F_y, M_z
    ((4e3, 0.0, 0.05, 0.02, 10.0, 0.3), -3738.124326, 6.667524),
    ((6e3, 0.0, -0.03, -0.04, 10.0, -0.6), 5299.178583, 12.118345),
    ((2.5e3, 0.0, 0.0, 0.0, 10.0, 1.0), -1864.713156, -19.215233),
]


def test_the_convention_of_mf_eval():
    """Equations (A48) to (A60) of Besselink's paper, by an independent program."""
    law = find("tyre", "file")(**MF61, convention="mf_eval", scaling=SCALED, pressure="2.3 bar")
    for felt, wanted in MF_EVAL.items():
        f = law.forces(TyreInput(*felt))
        found = [f.longitudinal_force, f.lateral_force, f.aligning_moment, f.overturning_moment]
        assert [float(x) for x in found] == pytest.approx(wanted, abs=1e-4)


def test_friction_that_decays_with_sliding_speed_acts_in_the_moment_too():
    """λ*_μy in (4.E40), (4.E45) and (4.E47), by an independent program."""
    law = find("tyre", "file")(**MF61, scaling={"LMUV": 0.15, "LMUX": 0.9, "LMUY": 1.1})
    found = vector(law, 4e3, -0.05, 0.08, 0.03, 40.0)
    assert found == pytest.approx([-1990.234862, -3439.196327, 8.059504], abs=1e-5)


def test_turn_slip_by_an_independent_program():
    law = tyre("file")
    for felt, across, moment in TURNED:
        f = law.forces(TyreInput(*felt))
        assert float(f.lateral_force) == pytest.approx(across, abs=1e-3)
        assert float(f.aligning_moment) == pytest.approx(moment, abs=0.1)


def test_turn_slip_takes_force_and_is_none_without_it():
    law = tyre("file")
    straight = law.forces(TyreInput(4e3, 0.05, 0.05, 0.0, 10.0))
    curved = law.forces(TyreInput(4e3, 0.05, 0.05, 0.0, 10.0, 0.5))
    barely = law.forces(TyreInput(4e3, 0.05, 0.05, 0.0, 10.0, 1e-9))
    assert 0.0 < float(curved.longitudinal_force) < float(straight.longitudinal_force)
    for one, other in zip(vars(barely).values(), vars(straight).values(), strict=True):
        assert float(one) == pytest.approx(float(other), rel=2e-3, abs=0.5)
