"""Irregularities: their spectrum and variance, their reproducibility, and how rails get them."""

from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.signal import welch

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.parameters import read_part
from vehicledyn.base.registry import kinds
from vehicledyn.rail.irregularities.erri_b176 import ErriB176, spectra
from vehicledyn.rail.irregularities.irregularity import rails_of
from vehicledyn.symbolic import ops

RANDOM = {"kind": "erri_b176", "level": "low", "seed": 7, "length": 400, "fade": 30}
RECORD = "s [m], alignment [mm], level [mm], cross_level [mm], gauge [mm]\n" + "\n".join(
    f"{k}, {3 * np.sin(0.7 * k)}, {2 * np.cos(0.9 * k)}, {4 * np.sin(0.5 * k)}, {np.cos(k)}"
    for k in range(401)
)
EXAMPLES = {"erri_b176": RANDOM, "record": {"kind": "record", "file": "rough.csv", "fade": 30}}
NAMES = ("alignment", "level", "cross_level")


def both_rails(shift):
    s = ops.symbol("s")
    outputs = [ops.column(list(shift.at(side, s))) for side in ("left", "right")]
    function = ca.Function("rails", [s], [ca.vertcat(*outputs)])
    return lambda place: np.array(function(place)).ravel()


@pytest.mark.parametrize("kind", kinds("irregularity"))
def test_every_kind_fades_and_is_the_same_again(kind, tmp_path):
    (tmp_path / "rough.csv").write_text(RECORD)
    first, again = (
        both_rails(read_part("irregularity", EXAMPLES[kind]).shift(tmp_path)) for _ in "ab"
    )
    places = np.linspace(-50.0, 500.0, 111)
    values = np.array([first(s) for s in places])
    assert np.array_equal(values, np.array([again(s) for s in places]))
    outside = (places < -1.0) | (places > 401.0)
    assert values[outside] == pytest.approx(0.0, abs=1e-15)
    assert (values[~outside].std(axis=0) > 1e-4).all()
    assert not np.array_equal(values[:, 1], values[:, 3])


@pytest.mark.parametrize("level", ["low", "high"])
def test_record_has_its_spectrum(level):
    """The estimate of 190 averages scatters by 7 %; that of the variance not at all."""
    record = ErriB176(level=level, seed=11, length=20_000.0, fade=0.0)
    step, values = record.length / record.count, record.records()
    band = 2.0 * np.pi / record.longest, 2.0 * np.pi / record.shortest
    for name in NAMES:
        wanted, _ = quad(lambda w, n=name: float(spectra(level, np.array(w))[n]), *band)
        assert values[name].var() == pytest.approx(wanted, rel=2e-3)
        frequency, density = welch(values[name], 1.0 / step, nperseg=int(200.0 / step))
        omega, density = 2.0 * np.pi * frequency, density / (2.0 * np.pi)
        inside = (omega > 1.15 * band[0]) & (omega < 0.97 * band[1])
        ratio = density[inside] / spectra(level, omega[inside])[name]
        assert ratio.mean() == pytest.approx(1.0, abs=0.02)
        assert np.abs(ratio - 1.0).max() < 0.35
        assert density[omega > 1.1 * band[1]].max() < 1e-3 * density[inside].max()


def test_quantities_are_independent_and_near_gaussian():
    values = ErriB176(level="low", seed=5, length=20_000.0, fade=0.0).records()
    rows = np.array([values[name] / values[name].std() for name in NAMES])
    assert np.corrcoef(rows) == pytest.approx(np.eye(3), abs=0.04)
    assert (rows**4).mean(axis=1) == pytest.approx(3.0, abs=0.15)
    alone = ErriB176(level="low", seed=5, length=20_000.0, fade=0.0, quantities=("level",))
    assert np.array_equal(alone.records()["level"], values["level"])


def test_seed_gives_the_same_record_on_every_machine():
    record = ErriB176(level="low", seed=1, length=100.0, fade=0.0).records()["level"]
    known = [-0.0010623511989126789, -0.0016871990018603547, -0.0010153151678878492]
    assert record[[0, 7, 333]] == pytest.approx(known, rel=1e-9)
    other = ErriB176(level="low", seed=2, length=100.0, fade=0.0).records()["level"]
    assert abs(np.corrcoef(record, other)[0, 1]) < 0.5


def test_rails_get_the_irregularities_with_their_signs():
    one = {
        name: np.full(41, value)
        for name, value in {
            "alignment": 1.0,
            "level": 2.0,
            "cross_level": 0.4,
            "gauge": 0.6,
        }.items()
    }
    shift = both_rails(rails_of(0.0, 0.5, one, fade=5.0))
    assert shift(10.0) == pytest.approx([1.3, 1.8, 0.7, 2.2], abs=1e-12)
    assert shift(2.5) == pytest.approx(0.5 * np.array([1.3, 1.8, 0.7, 2.2]), abs=1e-12)
    partial = rails_of(0.0, 0.5, {"level": one["level"]}, fade=5.0)
    assert partial.at("left", 3.0)[0] == 0.0
    assert partial.left_vertical is partial.right_vertical


def recorded(lines, folder):
    text = "\n".join(["s [m], level [mm]", *(f"{s:.9g}, {level:.9g}" for s, level in lines)])
    (folder / "record.csv").write_text(text)
    wish = {"kind": "record", "file": "record.csv", "fade": 0.0}
    return both_rails(read_part("irregularity", wish).shift(folder))


def test_a_single_bump_leaves_the_rail_beside_it_flat(tmp_path):
    """A spline through these lines sags by 5 m; a gap is bridged without an extremum."""
    rail = recorded([(0, 0), (20, 0), (20.6, 30), (21.2, 0), (40, 0), (60, 6)], tmp_path)
    level = {s: 1e3 * rail(float(s))[1] for s in (5, 10, 19, 20.3, 20.6, 20.9, 22, 30, 39)}
    assert level[20.6] == pytest.approx(30.0, rel=5e-3), "the table has places beside it"
    assert [level[20.3], level[20.9]] == pytest.approx([15.0, 15.0], rel=0.02)
    for place in (5, 10, 19, 22, 30, 39):
        assert level[place] == pytest.approx(0.0, abs=1e-3), place
    climb = [1e3 * rail(s)[1] for s in np.linspace(40.0, 58.0, 73)]
    assert (np.diff(climb) > -1e-6).all() and 0.0 < climb[40] < 6.0


def test_distances_that_scatter_are_joined_by_a_spline(tmp_path):
    def wave(s):
        return 5.0 * np.sin(2.0 * np.pi * s / 3.0)

    scatter = np.random.default_rng(3).uniform(-0.05, 0.05, 200)
    places = 0.25 * np.arange(200) + scatter - scatter[0]
    rail = recorded(zip(places, wave(places), strict=True), tmp_path)
    inside = np.linspace(5.0, 44.0, 157)
    found = np.array([1e3 * rail(s)[1] for s in inside])
    assert found == pytest.approx(wave(inside), abs=0.02)


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("longest", 2.0, "longer than the shortest"),
        ("length", 30.0, "twice the longest"),
        ("fade", 300.0, "half the record"),
        ("seed", -1, "at least 0"),
        ("quantities", [], "name some"),
        ("level", "middle", "must be 'low' or 'high'"),
    ],
)
def test_impossible_irregularities_are_refused(field, value, words):
    with pytest.raises(ValueError, match=words):
        read_part("irregularity", {**RANDOM, field: value}).shift(Path())
