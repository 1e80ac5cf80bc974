"""Channels of contacts that carry no load, and that pictures leave them out."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.analyses.preparation.prepare import prepare
from vehicledyn.results.plots.absent_contacts import load_of

ROOT = Path(__file__).parents[3]
FORCES = ("_force", "_moment", "wear_number", ".X", ".Y", ".Q")


def lifted(name, coordinate):
    """Return the channels of a model whose wheels are 20 mm above what they run on."""
    model = vd.load(name)
    made = prepare(model, backend="interpreted", progress=lambda *_: None, varies_states=True)
    e, kernel = made.equations, made.kernel
    state = made.subject.start_state(e, 10.0)
    state[made.index(coordinate)] += 0.02
    unknowns = kernel.solve_unknowns(0.0, state, np.array([u.start for u in e.unknowns]))
    values = kernel.outputs(0.0, state, unknowns)
    return dict(zip((c.name for c in e.channels), values.tolist(), strict=True))


@pytest.mark.long
@pytest.mark.parametrize(
    ("model", "coordinate"),
    [("rail_wheelset", "wheelset.vertical"), ("small_car", "chassis.z")],
)
def test_lifted_wheels_have_no_force_and_finite_places(model, coordinate):
    """Forces, moments and wear are zero, all else is that of the place which touches first."""
    seen = lifted(model, coordinate)
    of_contact = {n: v for n, v in seen.items() if ".contact_" in n or ".tyre." in n}
    assert len(of_contact) > 20
    forces = {n: v for n, v in of_contact.items() if n.endswith(FORCES)}
    assert set(forces.values()) == {0.0}
    assert np.isfinite(list(of_contact.values())).all()
    gaps = [v for n, v in of_contact.items() if n.endswith(("approach", "deflection"))]
    assert gaps and all(gap <= 0.0 for gap in gaps)


def test_figures_leave_out_geometry_of_contacts_without_load():
    """On rails and roads; forces, approach and deflection are drawn."""
    known = {"a.left.contact_2.normal_force", "wheel_fl.tyre.normal_force"}
    rail, road = sorted(known)
    for word in ("place", "lateral_place", "angle", "rolling_radius", "spin_creepage"):
        assert load_of(f"a.left.contact_2.{word}", known) == rail
    for word in ("contact_x", "contact_z", "tyre.slip_angle", "tyre.longitudinal_slip"):
        assert load_of(f"wheel_fl.{word}", known) == road
    drawn = ("a.left.contact_2.lateral_force", "wheel_fl.tyre.deflection", "wheel_rr.contact_x")
    assert [load_of(name, known) for name in drawn] == [None] * 3
