"""Equilibria with a coordinate that nothing holds are neutral, however the others decay."""

import vehicledyn as vd

SYSTEM = """\
title: A mass that one spring holds
bodies:
  mass: {joints: [{kind: T1, name: x}, {kind: T2, name: y}], mass: 1 kg}
forces:
  spring: {coordinate: mass.x, force: -40 N/m * position - 1 N*s/m * rate}
"""


def test_a_free_coordinate_makes_an_equilibrium_neutral_and_is_named(tmp_path):
    path = tmp_path / "mass.yaml"
    path.write_text(SYSTEM, encoding="utf-8")
    found = vd.equilibrium(path)
    assert found.attributes["stability"] == "neutral"
    assert "neither grow nor decay in mass.y" in found.report.as_text()
