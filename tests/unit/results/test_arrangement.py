"""Lines are put into panels where each can be read."""

import numpy as np
import pytest

from vehicledyn.results.labelled.requested import save_standard
from vehicledyn.results.plots.arrangement import MOST_LINES, MOST_PANELS, arranged
from vehicledyn.results.plots.plot_description import Panel, TimePlot
from vehicledyn.results.store.reader import open_result

TIME = np.linspace(0.0, 1.0, 11)


def groups(make_result, lines):
    values = {f"c.{k}": ("m", line) for k, line in enumerate(lines)}
    names = tuple(values)
    plot = TimePlot("all", "All", (Panel("Value", "m", names, names),), arranged=True)
    with open_result(make_result(time=TIME, values=values)) as result:
        found = arranged(result, plot)
    return [[int(name[2:]) for name in panel.channels] for panel in found.panels], found.title


def test_small_lines_leave_the_panel_of_large_ones(make_result):
    found, _ = groups(make_result, [TIME, 0.01 * TIME, 0.5 * TIME, 0.02 * TIME])
    assert found == [[0, 2], [1, 3]]


def test_a_line_far_away_does_not_flatten_the_others(make_result):
    found, _ = groups(make_result, [TIME, 1000.0 + TIME, 1000.0 - TIME])
    assert found == [[0], [1, 2]]


@pytest.mark.parametrize("constant", [0.0, 0.3])
def test_constant_lines_join_where_they_are_near(make_result, constant):
    still = np.full(len(TIME), constant)
    assert groups(make_result, [still, TIME])[0] == [[0, 1]]
    assert groups(make_result, [TIME, still + 1000.0])[0] == [[0], [1]]


def test_gaps_in_a_line_do_no_harm(make_result):
    broken = np.where(TIME > 0.5, np.nan, TIME)
    assert groups(make_result, [TIME, broken, np.full(len(TIME), np.nan)])[0] == [[0, 1, 2]]


def test_many_lines_are_cut_and_the_title_says_so(make_result):
    count = MOST_LINES * MOST_PANELS + 1
    found, title = groups(make_result, [TIME] * count)
    assert [len(panel) for panel in found] == [MOST_LINES] * MOST_PANELS
    assert title == f"All (the first {count - 1} of {count})"


def test_an_arranged_figure_names_every_line(make_result, tmp_path):
    plots = [
        {
            "name": "all",
            "kind": "time",
            "title": "All",
            "arranged": True,
            "panels": [{"label": "Value", "unit": "m", "channels": ["c.large", "c.small"]}],
        }
    ]
    values = {"c.large": ("m", TIME), "c.small": ("m", 1e-3 * TIME)}
    path = make_result(time=TIME, values=values, plots=plots)
    (picture,) = save_standard({"": path}, tmp_path / "figures", formats=["svg"])
    assert picture.read_text().count('id="legend_') == 2
