"""Figures of hunting studies: the bifurcation diagram and the root locus."""

import numpy as np
import pytest

from vehicledyn.results.plots.branch_curve import branch_curve
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


def test_a_branch_is_the_curve_of_its_directions():
    """Quarters of a circle with tangents of any sense and length; chords would miss it by 0.08."""
    angle = np.radians(np.arange(0.0, 271.0, 45.0))
    points = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    size = np.where(np.arange(len(angle)) % 2, -3.0, 0.5)[:, None]
    ways = size * np.stack([-np.sin(angle), np.cos(angle)], axis=1)
    pieces = branch_curve(points, ways)
    radius = np.linalg.norm(np.concatenate(pieces), axis=1)
    assert np.abs(radius - 1.0).max() < 5e-3
    straight = branch_curve(points, np.full_like(points, np.nan))
    assert np.linalg.norm(np.concatenate(straight), axis=1).min() < 0.93


def test_a_corner_of_a_branch_stays_a_corner():
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    ways = np.array([[1.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    first, last = branch_curve(points, ways)
    assert np.abs(first[:, 1]).max() < 1e-12
    assert last[:, 0].min() >= 1.0 - 1e-12 and last[:, 0].max() < 1.2


def test_hopf_bifurcations_are_marked_with_plain_numbers():
    roots = np.array([-1.0, -0.5, 0.5, 1.0]) + 2j * np.pi * np.array([5.0, 5.5, 6.0, 6.5])
    figures = {"linear_critical": 55.0, "linear_critical_frequency": 5.75}
    table = study(np.stack([roots, roots.conj()], axis=1), figures)
    figure = dict(hunt_figures(table))["root_locus"]
    marks = [[line for line in axes.lines if line.get_marker() == "D"] for axes in figure.axes]
    assert [float(mark[0].get_ydata()[0]) for mark in marks] == [0.0, 5.75, 0.0]
    figure.draw_without_rendering()
    ticks = [t.get_text() for axes in figure.axes for t in axes.get_yticklabels() if t.get_text()]
    assert ticks and not any("times" in text or "^" in text for text in ticks)
    assert figure.axes[-1].get_xlabel() == "Speed [m/s]"
