"""Rigid contacts that touch where the run starts have no gap there."""

from __future__ import annotations

import pytest

import vehicledyn as vd

DROP = """
title: A tappet above a round cam
gravity: [0, 0, -9.81 m/s^2]
bodies:
  tappet: {{joints: [{{kind: T3, name: height}}], mass: 0.5 kg}}
elements:
  contact:
    kind: cam_impact
    cam_body: ground
    follower_body: tappet
    cam:
      motion: [{{kind: dwell, over: 360 deg}}]
      base_radius: 40 mm
      follower: {{kind: flat}}
    normal: [0, 0, 1]
    touching: {touching}
initial: {{tappet.height: {height}{more}}}
"""
SOLVER = {"kind": "dop853", "relative_tolerance": 1e-11, "absolute_tolerance": 1e-12}


def run(folder, height, touching, more=""):
    path = folder / "model.yaml"
    path.write_text(DROP.format(height=height, touching=touching, more=more))
    return vd.simulate(path, duration="0.1 s", solver=SOLVER, backend="interpreted")


@pytest.mark.parametrize(
    ("height", "touching", "told"),
    [
        ("60 mm", "true", r"model\.yaml:7:3: .*'contact' are 20 mm apart at the start.*touching"),
        ("39 mm", "true", "1 mm into each other at the start, where it touches"),
        ("39 mm", "false", "1 mm into each other at the start, where it does not touch"),
    ],
)
def test_bodies_apart_in_contact_are_refused(tmp_path, height, touching, told):
    """They were drawn together without an impact, or fell through each other."""
    with pytest.raises(vd.InputError, match=told):
        run(tmp_path, height, touching)


def test_a_gap_that_closes_while_the_bodies_touch_is_told(tmp_path):
    with pytest.warns(vd.AccuracyWarning, match=r"'contact' touches.*closes at 0\.3 m/s"):
        run(tmp_path, "40 mm", "true", ", tappet.height_rate: -0.3 m/s")


def test_a_flight_ends_with_an_impact(tmp_path):
    hits = [e.time for e in run(tmp_path, "60 mm", "false").events if e.name == "contact.hits"]
    assert hits[0] == pytest.approx((2.0 * 0.02 / 9.81) ** 0.5, rel=1e-9)


def stiff_drop(folder, solver, stiffness, dissipation):
    law = f"stiffness: {stiffness} N/m\n    exponent: 1.5\n    dissipation: {dissipation} s/m"
    text = DROP.replace("kind: cam_impact", f"kind: cam_contact\n    {law}")
    path = folder / "model.yaml"
    path.write_text(text.replace("    touching: {touching}\n", "").format(height="60 mm", more=""))
    each = {"interval": "0.1 ms"}
    vd.simulate(path, duration="0.1 s", solver=solver, output=each, backend="interpreted")


RK4 = {"kind": "rk4", "step": "0.1 ms"}


@pytest.mark.parametrize(
    ("solver", "told"),
    [
        (
            SOLVER,
            "last 100 steps.*make an impact an event, soften the contact, or take an implicit",
        ),
        (RK4, "diverges with a step of 0.1 ms; take a shorter step"),
    ],
)
def test_an_impact_that_no_step_resolves_is_told_with_a_remedy(tmp_path, solver, told):
    """The step that rk4 is stable with at the start is the run's own."""
    with pytest.warns(vd.UnfinishedWarning, match=told):
        stiff_drop(tmp_path, solver, "1e18", "1e6")


def test_an_impact_that_makes_energy_is_told_of_runs_too_long_to_be_repeated(tmp_path):
    """Interpreted ones are: the tappet flew away at 100 km/s with a clean bill."""
    with pytest.warns(vd.AccuracyWarning, match="energy comes from nowhere"):
        stiff_drop(tmp_path, RK4, "1e16", "0")
