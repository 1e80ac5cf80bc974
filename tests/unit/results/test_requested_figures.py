"""Figures by name: any channels, over each other, of several results, and what is refused."""

import numpy as np
import pytest
from result_files import slalom_values

from vehicledyn.base.errors import InputError
from vehicledyn.results.labelled.data import open_result
from vehicledyn.results.labelled.requested import save_requested
from vehicledyn.results.plots.overlay import overlaid
from vehicledyn.results.plots.standard import figure_sets


@pytest.fixture
def pair(make_result):
    """Two runs by label, the second with 100 N more on one wheel and half as long."""
    time, values = slalom_values()
    values["wheel_fl.tyre.normal_force"][1][:] += 100.0
    half = {name: (unit, column[:111]) for name, (unit, column) in values.items()}
    return {"light": make_result(), "heavy": make_result("b.h5", time=time[:111], values=half)}


def opened(pair):
    return {label: open_result(path) for label, path in pair.items()}


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_channels_of_two_results_share_panels(pair):
    light, heavy = opened(pair).values()
    figure = light.plot("wheel_*", "chassis.roll", others={"heavy": heavy})
    loads, roll = figure.axes
    assert (len(loads.lines), len(roll.lines)) == (4, 2)
    first, second = loads.lines[0], loads.lines[2]
    assert first.get_color() == second.get_color()
    assert first.get_linestyle() != second.get_linestyle()
    assert second.get_ydata() == pytest.approx(first.get_ydata()[:111] + 100.0)
    assert legend(figure)[1] == "heavy"


def test_channels_over_another_channel(pair):
    light, heavy = opened(pair).values()
    axes = light.plot("chassis.roll", against="chassis.x", others={"heavy": heavy}).axes[0]
    assert axes.lines[1].get_xdata() == pytest.approx(heavy["chassis.x"].values)
    assert axes.lines[1].get_ydata() == pytest.approx(np.degrees(heavy["chassis.roll"].values))


def test_standard_figures_lie_over_each_other_on_one_scale(pair):
    (_, path), (_, loads) = figure_sets(pair)
    together = overlaid(loads)
    normal, roll = together.axes
    assert (len(normal.lines), len(roll.lines)) == (4, 2)
    assert normal.lines[2].get_ydata() == pytest.approx(normal.lines[0].get_ydata()[:111] + 0.1)
    assert normal.get_xlim() == (0.0, 22.0)
    assert legend(together) == ["light", "heavy"]
    together = overlaid(path)
    assert [len(axes.lines) for axes in together.axes] == [3] + [2] * (len(together.axes) - 1)
    colours = [line.get_color() for line in together.axes[1].lines]
    assert colours[0] != colours[1]


def test_figures_of_other_panels_stay_apart(make_result):
    time, values = slalom_values()
    other = make_result("b.h5", time=time, values=values, plots=[])
    sets = dict(figure_sets({"a": other, "b": make_result()}))
    assert all(overlaid(figures) is not None for figures in sets.values())
    (first, *_), (_, second) = sets.values(), list(sets.values())[:2]
    mixed = {"a": next(iter(first.values())), "b": next(iter(second.values()))}
    assert overlaid(mixed) is None


def test_files_are_named_after_figures_and_patterns(pair, tmp_path):
    data = opened({"light": pair["light"]})
    files = save_requested(data, tmp_path, patterns=["loads", "wheel_*.force"[:7]], formats=["png"])
    assert [file.name for file in files] == ["loads.png", "wheel_all.png"]
    files = save_requested(
        opened(pair), tmp_path, patterns=["chassis.y"], against="chassis.x", formats=["svg"]
    )
    assert [file.name for file in files] == ["chassis.y_against_chassis.x.svg"]


def test_a_picture_file_takes_the_only_figure(pair, tmp_path):
    target = tmp_path / "new" / "yaw.PNG"
    assert save_requested(opened(pair), target, patterns=["chassis.y"]) == [target]
    assert target.read_bytes().startswith(b"\x89PNG")
    assert [file.name for file in target.parent.iterdir()] == ["yaw.PNG"]
    (tmp_path / "a.png").mkdir()
    files = save_requested(opened(pair), tmp_path / "a.png", patterns=["chassis.y"])
    assert [file.name for file in files] == ["chassis.y.png", "chassis.y.svg"]


@pytest.mark.parametrize(
    ("name", "patterns", "formats", "message"),
    [
        ("yaw.png", ["loads", "chassis.y"], ("png", "svg"), r"2 figures .*\(loads, chassis\.y\)"),
        ("yaw.jpg", ["chassis.y"], ("png", "svg"), "written as png, svg, pdf"),
        ("yaw.png", ["chassis.y"], ("svg",), "is to be written as svg"),
    ],
)
def test_other_picture_files_are_refused(pair, tmp_path, name, patterns, formats, message):
    with pytest.raises(InputError, match=message):
        save_requested(opened(pair), tmp_path / name, patterns=patterns, formats=formats)
    assert not any(file.name.startswith("yaw") for file in tmp_path.iterdir())


def test_all_channels_leave_out_their_time(pair, tmp_path):
    files = save_requested(opened(pair), tmp_path, patterns=["*"], formats=["svg"])
    assert [file.name for file in files] == ["all.svg"]


@pytest.mark.parametrize(
    ("patterns", "against", "message"),
    [
        (["chassis.rol"], None, r"did you mean 'chassis\.roll'"),
        (["chassis.y"], "chassis.xx", r"did you mean 'chassis\.x'"),
        ([], "chassis.x", "name the channels to draw"),
    ],
)
def test_unknown_names_are_answered_with_near_ones(pair, tmp_path, patterns, against, message):
    with pytest.raises(InputError, match=message):
        save_requested(opened(pair), tmp_path, patterns=patterns, against=against)
    assert not list(tmp_path.glob("*.png"))


def test_a_result_of_many_channels_names_only_near_ones(make_result):
    time, _ = slalom_values()
    values = {f"part_{k}.tyre.normal_force": ("N", time) for k in range(40)}
    result = open_result(make_result(time=time, values=values, plots=[], scene={}))
    with pytest.raises(InputError) as caught:
        result.plot("normal_force")
    assert ".tyre.normal_force" in str(caught.value)
    assert len(str(caught.value)) < 700


def test_contacts_without_load_are_not_drawn(make_result):
    """Where nothing touches, the place on the profile means nothing; the force is zero there."""
    time, _ = slalom_values()
    load = np.where(time < 5.0, 0.0, 1000.0)
    head = "wheels.left.contact_1"
    values = {f"{head}.place": ("m", time), f"{head}.normal_force": ("N", load)}
    panels = [{"label": n, "unit": u, "channels": [f"{head}.{n}"]}
              for n, u in (("place", "m"), ("normal_force", "N"))]  # fmt: skip
    plots = [{"name": "contact", "kind": "time", "title": "Contact", "panels": panels}]
    path = make_result(time=time, values=values, plots=plots, scene={})
    ((_, figures),) = figure_sets({"run": path})
    standard = [axes.lines[0].get_ydata() for axes in figures["run"].axes]
    own = open_result(path).plot(f"{head}.place").axes[0].lines[0].get_ydata()
    for place in (standard[0], own):
        assert np.array_equal(np.isnan(place), time < 5.0)
    assert np.isfinite(standard[1]).all()
