"""What changes the equations of cases is no quantity of a study."""

from dataclasses import replace

import pytest
from small_study import PENDULUM, swept, written

from vehicledyn.base.errors import InputError
from vehicledyn.studies import load_study, model
from vehicledyn.symbolic.tables import CurveTable

WHEELSET = PENDULUM.with_name("rail_wheelset.yaml")


def test_numbers_of_a_track_are_choices(tmp_path):
    """They are in the equations: each value needs its own."""
    text = (
        f"title: Gauges\nscenario: {WHEELSET}\n"
        "set:\n  track: {kind: straight, gauge: 1435 mm, inclination: 1/40, rail: 60E1}\n"
        "cases:\n  kind: grid\n  vary:\n    track.gauge: [1435 mm, 1432 mm]\n"
    )
    design = load_study(written(tmp_path, text)).design
    assert design.axes[0].is_choice


def test_quantities_that_move_a_curve_are_refused(tmp_path, monkeypatch):
    """A parameter that a table is made from would leave all cases with the table of the first."""
    equations_at, prepare = model._equations_at, model.prepare

    def curve(length):
        return CurveTable("curve", 0.0, length, [[0.0, 1.0]])

    def prepared(loaded, **options):
        found = prepare(loaded, **options)
        return replace(found, equations=replace(found.equations, tables=(curve(1.0),)))

    def moved(recipe, place):
        return replace(equations_at(recipe, place), tables=(curve(place[0]),))

    monkeypatch.setattr(model, "prepare", prepared)
    monkeypatch.setattr(model, "_equations_at", moved)
    with pytest.raises(InputError, match=r"'parameters.length': changes the equations"):
        swept(written(tmp_path), tmp_path / "out.h5")
