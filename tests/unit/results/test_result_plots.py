from xml.etree import ElementTree

import matplotlib.image
import numpy as np
import pytest
from matplotlib.figure import Figure
from result_files import PLOTS, slalom_values

from vehicledyn.base.errors import InputError
from vehicledyn.results.labelled.data import open_result as open_labelled
from vehicledyn.results.labelled.requested import save_requested, save_standard
from vehicledyn.results.plots.figures import draw_figure
from vehicledyn.results.plots.plot_description import read_plots, unit_factor
from vehicledyn.results.plots.plot_style import axis_label
from vehicledyn.results.plots.run_plots import default_plots, plots_of
from vehicledyn.results.store.reader import open_result

PATH, LOADS = PLOTS


def drawn(path, name):
    with open_result(path) as result:
        plot = next(plot for plot in plots_of(result) if plot.name == name)
        return draw_figure(result, plot)


def texts_of(figure):
    return [text.get_text() for axes in figure.axes for text in axes.texts]


def test_pictures_exist_and_show_something(make_result, tmp_path):
    files = save_standard({"": make_result()}, tmp_path / "new" / "plots")
    assert [file.name for file in files] == ["path.png", "path.svg", "loads.png", "loads.svg"]
    for file in files:
        if file.suffix == ".png":
            pixels = matplotlib.image.imread(file)[..., :3]
            assert min(pixels.shape[:2]) > 300
            assert 0.02 < np.mean(np.any(pixels < 0.98, axis=2)) < 0.5
        else:
            root = ElementTree.fromstring(file.read_text())
            assert len(root.findall(".//{http://www.w3.org/2000/svg}path")) > 20


def test_lines_hold_the_converted_values(make_result):
    time, values = slalom_values()
    loads, roll = drawn(make_result(), "loads").axes
    left, right = loads.lines
    assert np.array_equal(left.get_xdata(), time)
    assert left.get_ydata() == pytest.approx(values["wheel_fl.tyre.normal_force"][1] / 1000.0)
    assert right.get_ydata() == pytest.approx(values["wheel_fr.tyre.normal_force"][1] / 1000.0)
    assert roll.lines[0].get_ydata() == pytest.approx(np.degrees(values["chassis.roll"][1]))
    assert left.get_color() != right.get_color()
    assert left.get_linestyle() != right.get_linestyle()


def test_every_axis_is_labelled_and_lines_have_a_legend(make_result):
    path = make_result()
    loads, roll = drawn(path, "loads").axes
    assert loads.get_ylabel() == "Normal force [kN]"
    assert roll.get_ylabel() == "Roll angle [deg]"
    assert roll.get_xlabel() == "Time [s]"
    legend = [text.get_text() for text in loads.get_legend().get_texts()]
    assert legend == ["front left", "front right"]
    for axes in drawn(path, "path").axes:
        assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [m]", "y [m]")


def test_a_legend_of_long_names_stays_in_the_picture(make_result):
    time, values = slalom_values()
    names = [f"rail_large_right.right.contact_{k}.longitudinal_force" for k in range(1, 7)]
    values = {name: ("N", k * time) for k, name in enumerate(names, 1)}
    panel = {"label": "Force", "unit": "N", "channels": names, "labels": names}
    plot = {"name": "forces", "kind": "time", "title": "Forces", "panels": [panel]}
    figure = drawn(make_result(time=time, values=values, plots=[plot], scene={}), "forces")
    figure.draw_without_rendering()
    (axes,) = figure.axes
    assert axes.get_legend().get_window_extent().x1 < figure.bbox.x1
    assert axes.get_window_extent().width > 0.8 * figure.bbox.width


def test_a_slender_course_shows_every_cone_and_the_body_true_to_scale(make_result):
    figure = drawn(make_result(), "path")
    overview, *rows = figure.axes
    assert [text.get_text() for text in overview.texts] == [str(k) for k in range(1, 10)]
    assert len(rows) > 1
    assert set(texts_of(figure)) == {str(k) for k in range(1, 10)}
    for row in rows:
        assert row.get_aspect() == 1.0
        corners = row.collections[0].get_paths()[0].vertices
        lengths = np.hypot(*np.diff(corners, axis=0).T)
        assert np.sort(lengths)[-4:] == pytest.approx([1.6, 1.6, 4.0, 4.0])
    assert rows[0].get_xlim()[0] < 0.0
    assert rows[-1].get_xlim()[1] > 220.0


def test_a_round_course_is_one_picture(make_result):
    angle = np.linspace(0.0, 6.0, 50)
    values = {
        "chassis.x": ("m", 20.0 * np.cos(angle)),
        "chassis.y": ("m", 20.0 * np.sin(angle)),
    }
    plot = {"name": "path", "kind": "path", "x": "chassis.x", "y": "chassis.y"}
    path = make_result(time=angle, values=values, plots=[plot], scene={})
    (axes,) = drawn(path, "path").axes
    assert axes.get_aspect() == 1.0
    assert not axes.collections


def test_a_partial_result_says_so_in_the_title(make_result, tmp_path):
    path = make_result(status="interrupted", message="")
    assert "(partial: interrupted at t = 22 s)" in drawn(path, "loads").get_suptitle()
    assert "partial" not in drawn(make_result("whole.h5"), "loads").get_suptitle()
    assert save_standard({"": path}, tmp_path, formats=["png"])[0].stat().st_size > 10_000


def test_samples_that_are_not_finite_are_left_out(make_result, tmp_path):
    time, values = slalom_values()
    for name in ("chassis.x", "chassis.roll"):
        values[name][1][-5:] = np.nan
    assert len(save_standard({"": make_result(time=time, values=values)}, tmp_path / "p")) == 4
    values["chassis.x"][1][:] = np.inf
    with pytest.raises(InputError, match="no finite positions"):
        save_standard({"": make_result(time=time, values=values)}, tmp_path / "p")


def test_equal_results_give_equal_pictures(make_result, tmp_path):
    first = save_standard({"": make_result("a.h5")}, tmp_path / "a")
    second = save_standard({"": make_result("b.h5")}, tmp_path / "b")
    for one, other in zip(first, second, strict=True):
        assert one.read_bytes() == other.read_bytes()


def test_each_picture_is_drawn_once(make_result, tmp_path, monkeypatch):
    """A layout engine that is left in place makes every format draw twice."""
    drawn, draw = [], Figure.draw
    monkeypatch.setattr(Figure, "draw", lambda f, renderer: (drawn.append(f), draw(f, renderer)))
    assert len(save_standard({"": make_result()}, tmp_path)) == len(drawn) > 0


def test_a_file_without_descriptions_is_plotted_by_unit(make_result, tmp_path):
    path = make_result(plots=())
    with open_result(path) as result:
        plots = {plot.name: plot for plot in default_plots(result)}
        shown = [c for plot in plots.values() for p in plot.panels for c in p.channels]
        assert sorted(shown) == sorted(result.channels)
    assert list(plots) == ["channels_m", "channels_rad", "channels_N"]
    assert len(plots["channels_N"].panels[0].channels) == 2
    assert len(save_standard({"": path}, tmp_path, formats=["png"])) == 3


def test_many_channels_are_spread_over_figures(make_result):
    time = np.linspace(0.0, 1.0, 5)
    values = {f"part_{k}.value_{k % 6}": ("m/s^2", time) for k in range(60)}
    path = make_result(time=time, values=values, plots=())
    with open_result(path) as result:
        plots = default_plots(result)
    assert [plot.name for plot in plots] == [f"channels_m_per_s2_part_{k}" for k in (1, 2, 3)]
    assert max(len(panel.channels) for plot in plots for panel in plot.panels) <= 7


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kind": "tme"}, "did you mean 'time'"),
        ({"name": "../x"}, "a name that a file can have"),
        ({"panels": []}, "no panels"),
        (
            {"panels": [{"label": "a", "unit": "m", "channels": ["x"], "labels": ["b", "c"]}]},
            "labels",
        ),
        ({"panels": [{"label": "a", "channels": ["x"]}]}, "says nothing of its 'unit'"),
    ],
)
def test_descriptions_that_cannot_be_drawn(change, message):
    with pytest.raises(InputError, match=rf"^run\.h5: .*{message}"):
        read_plots([{**LOADS, **change}], "run.h5")


def test_two_plots_of_one_name_are_refused():
    with pytest.raises(InputError, match=r"^run\.h5: two plots are named"):
        read_plots([LOADS, LOADS], "run.h5")


def test_requests_that_cannot_be_met(make_result, tmp_path):
    path = make_result()
    with pytest.raises(InputError, match="did you mean 'loads'"):
        save_requested({"": open_labelled(path)}, tmp_path, patterns=["load"])
    with pytest.raises(InputError, match="picture format"):
        save_standard({"": path}, tmp_path, formats=["bmp"])
    with pytest.raises(InputError, match="cannot be written"):
        save_standard({"": path}, path)
    missing = {**LOADS, "panels": [{"label": "a", "unit": "m", "channels": ["chassis.rol"]}]}
    with pytest.raises(InputError, match="did you mean 'chassis"):
        save_standard({"": make_result(plots=[missing])}, tmp_path)
    wrong = {**LOADS, "panels": [{"label": "a", "unit": "m", "channels": ["chassis.roll"]}]}
    with pytest.raises(InputError, match="cannot be shown in m"):
        save_standard({"": make_result(plots=[wrong])}, tmp_path)
    empty = make_result(time=np.empty(0), values={"a": ("m", np.empty(0))}, plots=())
    with pytest.raises(InputError, match="nothing to draw"):
        save_standard({"": empty}, tmp_path)


def test_units_and_labels():
    assert unit_factor("rad/s^2", "deg/s^2") == pytest.approx(180.0 / np.pi)
    assert unit_factor("m", "mm") == pytest.approx(1000.0)
    assert axis_label("Acceleration", "m/s^2") == "Acceleration [m/s²]"
    assert axis_label("Inertia", "kg m^2") == "Inertia [kg m²]"
    assert axis_label("Slip", "1") == "Slip [–]"


def test_rounding_errors_do_not_fill_a_panel(make_result):
    time, values = slalom_values()
    values["chassis.roll"] = ("rad", 1e-15 * np.sin(time))
    _, roll = drawn(make_result(values=values), "loads").axes
    assert roll.get_ylim() == pytest.approx((-1.0, 1.0))
