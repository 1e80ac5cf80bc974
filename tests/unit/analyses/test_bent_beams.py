"""Runs warn of beams of assumed modes that bend farther than these hold for."""

from contextlib import nullcontext

import pytest

import vehicledyn as vd
from vehicledyn.base.errors import AccuracyWarning

RUN = """title: A strip is let go
model: strip.yaml
duration: 1 s
solver: {kind: rosenbrock, relative_tolerance: 1e-5, absolute_tolerance: 1e-6}
output: {interval: 10 ms}
"""
STRIP = """title: A strip with a load at its end
parameters: {length: 2.2 m}
bodies:
  load: {parent: strip.tip, mass: 2 kg}
elements:
  strip:
    kind: beam
    body: ground
    length: length
    section: {shape: rectangle, width: 20 mm, height: 10 mm}
    material: {density: 7850 kg/m^3, young: 210 GPa}
    modes: {z: 2}
    model: MODEL
"""


@pytest.mark.parametrize(
    ("model", "length", "warned"),
    [("modes", "2.2 m", True), ("modes", "1.5 m", False), ("exact", "2.2 m", False)],
)
def test_only_small_deflections_suit_modes(tmp_path, model, length, warned):
    """The end falls twice as far as it hangs at rest, by 0.29 of the length, or 0.12."""
    (tmp_path / "strip.yaml").write_text(STRIP.replace("MODEL", model))
    (tmp_path / "run.yaml").write_text(RUN)
    warning = (
        pytest.warns(AccuracyWarning, match="beam 'strip': its end moves aside by 0.2. of its")
        if warned
        else nullcontext()
    )
    with warning:
        run = vd.simulate(
            vd.load(tmp_path / "run.yaml"), backend="interpreted", parameters={"length": length}
        )
    share = abs(run["strip.tip_z"].values).max() / float(length.split()[0])
    assert share == pytest.approx(0.29 if length == "2.2 m" else 0.12, rel=0.03)
