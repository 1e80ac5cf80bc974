"""Figures of hunting studies: the bifurcation diagram and the root locus."""

import numpy as np
import pytest

from vehicledyn.results.plots.hunt_figures import hunt_figures
from vehicledyn.results.tables.hunt_table import HuntTable, Quantity


def study(eigenvalues, figures):
    return HuntTable(
        title="t",
        model="m",
        parameter=Quantity("speed", "m/s", "Speed"),
        channels=(Quantity("y", "m", "Shift"),),
        locus_values=np.array([40.0, 50.0, 60.0, 70.0]),
        eigenvalues=eigenvalues,
        cycles=(),
        simulated=(),
        figures=figures,
        status="ok",
        message="",
    )


@pytest.mark.parametrize(("figures", "place"), [({"linear_critical": 57.5}, 57.5), ({}, 56.0)])
def test_equilibrium_is_dashed_from_the_critical_value_on(figures, place):
    """Between coarse values growth is -3 and 2 1/s: linearly none at three fifths of the way."""
    growth = np.array([-10.0, -3.0, 2.0, 4.0])
    table = study(np.stack([growth + 5.0j, growth - 5.0j], axis=1), figures)
    diagram = dict(hunt_figures(table))["bifurcation"]
    lines = {line.get_linestyle(): line.get_xdata() for line in diagram.axes[0].get_lines()}
    assert lines["-"] == pytest.approx([40.0, 50.0, place], abs=1e-4)
    assert lines["--"] == pytest.approx([place, 60.0, 70.0], abs=1e-4)


def test_root_locus_shows_weak_damping_and_what_grows():
    """λ = 2π f (-D ± i √(1 - D²)) with D of 4, 1, -2, -3 % beside creep at -9000 1/s."""
    damping = np.array([0.04, 0.01, -0.02, -0.03])
    root = 2.0 * np.pi * 7.0 * (-damping + 1j * np.sqrt(1.0 - damping**2))
    fast = np.full(4, -9000.0 + 0.0j)
    strong = np.full(4, -30.0 + 30.0j)
    columns = [root, root.conj(), fast, strong, strong.conj()]
    figure = dict(hunt_figures(study(np.stack(columns, axis=1), {})))["root_locus"]
    calm, growing = (line.get_ydata() for line in figure.axes[0].get_lines()[:2])
    assert sorted(set(calm.round(9))) == pytest.approx([1.0, 4.0])
    assert sorted(set(growing.round(9))) == pytest.approx([-3.0, -2.0])
    assert np.unique(figure.axes[1].get_lines()[1].get_ydata().round(9)) == pytest.approx([
        7.0 * np.sqrt(1.0 - 0.03**2), 7.0 * np.sqrt(1.0 - 0.02**2)
    ])  # fmt: skip
    low, high = figure.axes[2].get_ylim()
    assert low < -9000.0 and high < 10.0
