"""Pages of optima, identified and scattering parameters, and of derivatives, say all there is."""

from dataclasses import replace

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.results.report.table_content import table_content
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.identification_table import (
    IdentificationTable,
    read_identification,
    write_identification,
)
from vehicledyn.results.tables.optimum_table import (
    FrontPoint,
    OptimumTable,
    read_optimum,
    write_optimum,
)
from vehicledyn.results.tables.sensitivity_table import SensitivityTable, write_sensitivity
from vehicledyn.results.tables.uncertainty_table import UncertaintyTable, write_uncertainty

MASS, LENGTH = Quantity("mass", "kg", "Mass"), Quantity("length", "m", "Length")
ROLL = Quantity("max(roll)", "rad", "Largest roll")
PAIR = np.array([2.0, 1.0])


def optimum(path):
    points = [FrontPoint(PAIR, 0.2, 0.4, 1e-7, violation, 3) for violation in (0.0, 0.5)]
    table = OptimumTable(
        "Best", "converged", (MASS, LENGTH), PAIR / 2.0, PAIR, 0.7 * PAIR, PAIR, (ROLL,),
        np.array([[0.4], [0.3]]), np.array([[0.1, -0.2]]), np.array([PAIR, PAIR]),
        np.array([0.4, 0.3]), np.zeros(2), 1e-7, 2, ("a note",), tuple(points), ROLL,
        limits=("max(roll) at most 0.3 rad: active",),
    )  # fmt: skip
    write_optimum(path, table)
    again = read_optimum(path)
    assert (again.limits, again.notes) == (table.limits, table.notes)
    assert [(p.n_runs, p.is_kept) for p in again.front] == [(3, True), (3, False)]
    assert again.front_figure == Quantity("max(roll)", "rad", "max(roll) of the compromise")


def identification(path):
    covariance = np.array([[0.01, 0.019], [0.019, 0.04]])
    table = IdentificationTable(
        "Found", "converged", 4, (MASS, LENGTH), PAIR, PAIR, PAIR - 1e-6, PAIR + 1e-6, covariance,
        0.25, 0.4, (ROLL,), np.zeros(2), PAIR[::-1], PAIR, PAIR, PAIR, ("a note",),
    )  # fmt: skip
    write_identification(path, table)


def uncertainty(path):
    one, nothing = np.array([0.1]), np.full((1, 2), np.nan)
    table = UncertaintyTable(
        "Scatter", "sequence", 3, (MASS, LENGTH), (ROLL,), one, one, one, one,
        np.array([[0.6, 0.3]]), nothing, np.ones((3, 2)), np.ones((3, 1)), ("a risk",), ("a note",),
    )  # fmt: skip
    write_uncertainty(path, table)


def sensitivity(path):
    table = SensitivityTable(
        "Slopes", "pendulum", (MASS, LENGTH), PAIR, (ROLL,), np.array([0.3]),
        np.array([[np.nan, -0.2]]), notes=("a note",),
    )  # fmt: skip
    write_sensitivity(path, table)


@pytest.mark.parametrize(
    ("write", "told"),
    [
        (optimum, ["at its bound", "active", "-0.2", "rad/kg", "constraints not kept"]),
        (identification, ["0.999999", "+0.95 !", "0.5"]),
        (uncertainty, ["a risk", "60.0 %"]),
        (sensitivity, ["-0.2", "rad/m", "a dash marks them"]),
    ],
)
def test_a_page_says_what_was_found_and_noted_and_never_nan(tmp_path, write, told):
    path = tmp_path / "table.h5"
    write(path)
    content = table_content(path)
    text = repr((content.key_figures, [figure.text for figure in content.key_figures]))
    text += repr([section.blocks for section in content.details()])
    for words in ("a note", *told):
        assert words in text, words
    assert "nan" not in text


@pytest.mark.parametrize(
    ("write", "names", "words"),
    [
        (identification, ["mass", "length"], "Mass (95 %: 1.999999 kg to 2.000001 kg)"),
        (uncertainty, ["max(roll)"], "Mean of max(roll) (deviation 5.73 deg)"),
        (optimum, ["mass", "length", "max(roll)"], "Mass, at the optimum"),
    ],
)
def test_results_in_memory_have_a_summary_and_a_table(tmp_path, write, names, words):
    """Of what was found, one row each."""
    write(tmp_path / "a.h5")
    data = vd.open_result(tmp_path / "a.h5")
    assert list(data.summary) == names
    assert next(iter(data.summary.values())).description == words
    found = data.to_dataframe()
    assert list(found.index) == [name for name in names if write is not optimum or "(" not in name]


def test_a_parameter_that_the_data_cannot_tell_has_a_summary(tmp_path):
    """Its interval has no ends."""
    identification(tmp_path / "a.h5")
    table = replace(
        read_identification(tmp_path / "a.h5"), low=np.full(2, -np.inf), high=np.full(2, np.inf)
    )
    write_identification(tmp_path / "b.h5", table)
    (mass, _) = vd.open_result(tmp_path / "b.h5").summary.values()
    assert mass.description == "Mass (95 %: -inf kg to inf kg)"
