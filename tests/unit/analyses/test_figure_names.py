"""Names of key figures are checked by no more of a run than they need."""

import pytest

import vehicledyn as vd
from vehicledyn.analyses.sensitivity import figure_names


def checked(monkeypatch, *names):
    """Return the times to which runs are simulated to check names."""
    simulate, stops = figure_names.simulate_monitored, []

    def noted(*given, stop, **more):
        stops.append(stop)
        return simulate(*given, stop=min(stop, 1.0), **more)

    monkeypatch.setattr(figure_names, "simulate_monitored", noted)
    changes = {"solver": {"kind": "rk4", "step": "1 ms"}, "output.interval": "2 ms"}
    loaded = vd.load("double_pendulum").changed(changes, duration="10000 s")
    wrong = figure_names.wrong_figures(loaded, names, lambda *_: None)
    return stops, next(iter(wrong.values()), "")


def test_the_first_part_of_a_long_run_shows_most_figures(monkeypatch):
    assert checked(monkeypatch, "energy_drift") == ([pytest.approx(1.0)], "")


def test_a_figure_that_is_not_there_yet_is_looked_for_in_the_whole_run(monkeypatch):
    stops, words = checked(monkeypatch, "energy_drifts")
    assert stops == [pytest.approx(1.0), 1e4]
    assert "did you mean 'energy_drift'?" in words


def test_what_can_be_no_name_needs_no_run(monkeypatch):
    stops, words = checked(monkeypatch, "energy_drift", "20 ms")
    assert stops == []
    assert "'20 ms' is neither a key figure nor a channel" in words
