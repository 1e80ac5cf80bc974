"""Figures of studies: what is drawn of few and of many cases, and with what labels."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.results.plots.standard import standard_figures

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def studies(tmp_path_factory):
    """A study of one varied quantity in four cases, and one of two in twelve."""
    folder = tmp_path_factory.mktemp("studies")
    usual = {"duration": "0.3 s", "workers": 1}
    one = {"parameters.body.mass": ["200 kg", "300 kg", "350 kg", "400 kg"]}
    two = {**one, "parameters.body.stiffness": ["10 kN/m", "15 kN/m", "20 kN/m"]}
    channels = [f"{part}.height" for part in ("road", "wheel", "body")] + ["tyre.length"]
    found = {}
    for name, vary in (("one", one), ("two", two)):
        study = vd.sweep("quarter_car", vary=vary, channels=channels, **usual)
        found[name] = dict(standard_figures(Path(study.save(folder / f"{name}.h5"))))
    return found


def test_one_quantity_gives_curves_over_it(studies):
    figures = studies["one"]
    assert list(figures) == ["dependence", "channels"]
    axes = figures["dependence"].axes[0]
    assert axes.lines[0].get_xdata() == pytest.approx([200.0, 300.0, 350.0, 400.0])
    assert len(figures["channels"].axes[0].lines) == 4


def test_many_cases_give_bars_and_effects_but_none_of_the_accuracy(studies):
    figures = studies["two"]
    assert list(figures) == ["distributions", "effects", "channels"]
    labels = [axes.get_xlabel() for axes in figures["distributions"].axes if axes.get_visible()]
    assert labels and not any("error" in text or "drift" in text for text in labels)


def test_every_column_has_its_time(studies):
    """Four channels in three columns: the second and third end in the first row."""
    for figures in studies.values():
        panels = [axes for axes in figures["channels"].axes if axes.get_visible()]
        lowest = panels[-3:]
        assert all(axes.get_xlabel() == "Time [s]" for axes in lowest)
        figures["channels"].draw_without_rendering()
        for axes in lowest:
            assert any(tick.get_text() for tick in axes.get_xticklabels() if tick.get_visible())
        assert np.isfinite(panels[0].lines[0].get_ydata()).all()
