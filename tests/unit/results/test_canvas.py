"""Axes of figures leave out what no scale reaches."""

import io

import numpy as np
import pytest

from vehicledyn.results.plots.canvas import MOST_INCHES, new_canvas
from vehicledyn.results.plots.picture_files import save_figures, settle

HOSTILE = [1e308, -1e308, np.nan, np.inf, 1.0]
PLACES = np.arange(5.0)


@pytest.mark.parametrize(
    "draw",
    [
        lambda axes: axes.plot(HOSTILE, PLACES),
        lambda axes: axes.plot([1e308] * 2, [1e308] * 2),
        lambda axes: axes.semilogy(PLACES, HOSTILE),
        lambda axes: axes.axvline(1e308),
        lambda axes: axes.barh(PLACES, HOSTILE),
        lambda axes: axes.hist(HOSTILE, bins=20),
        lambda axes: axes.hist([1.0, 1.0 + 1e-15], bins=20),
        lambda axes: axes.scatter(HOSTILE, HOSTILE, c=PLACES),
        lambda axes: axes.fill_between(PLACES, HOSTILE, 0.0),
        lambda axes: axes.text(np.inf, 1.0, "a"),
        lambda axes: axes.annotate("a", (1e308, 1.0)),
        lambda axes: axes.set_xlim(0.0, np.nan),
        lambda axes: axes.set_xlim(2.0, 2.0),
        lambda axes: axes.set_ylim((-1e308, 1e308)),
    ],
)
def test_numbers_that_no_scale_reaches_are_left_out(draw):
    figure = new_canvas(2.0, 1.0)
    axes = figure.subplots()
    draw(axes)
    settle(figure)
    figure.savefig(io.BytesIO(), format="svg")
    assert np.abs([*axes.get_xlim(), *axes.get_ylim()]).max() <= 1e101


def test_usual_numbers_are_drawn_as_they_are():
    figure = new_canvas(2.0, 1e9)
    assert figure.get_size_inches()[1] == MOST_INCHES
    axes = figure.subplots()
    (line,) = axes.plot([0.0, 2.0], [3.0, 5.0])
    assert line.get_ydata().tolist() == [3.0, 5.0]
    axes.set_xlim(left=-1.0)
    assert axes.get_xlim()[0] == -1.0


def test_figures_of_equal_and_long_names_have_files_of_their_own(tmp_path):
    names = ["a", "a", "A", "x" * 300]
    figures = [new_canvas(1.0, 1.0) for _ in names]
    for figure in figures:
        figure.subplots().set_axis_off()
    written = save_figures(zip(names, figures, strict=True), tmp_path, ["svg"])
    assert [path.stem for path in written] == ["a", "a_2", "A_3", "x" * 100]
    assert all(path.is_file() for path in written)
