"""What every model of wheel and rail in contact must do."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.prepare import prepare, reference_point
from vehicledyn.base.registry import kinds
from vehicledyn.files.scenario import load_model

WHEELSET = Path(__file__).parents[3] / "systems" / "rail_wheelset.yaml"
WRITTEN = {
    "elastic": "{kind: elastic, youngs_modulus: 210 GPa, poissons_ratio: 0.28, damping: 2 s/m}",
    "rigid": "{kind: rigid, youngs_modulus: 210 GPa, poissons_ratio: 0.28}",
}


@pytest.mark.parametrize("kind", kinds("rail_contact"))
def test_wheelset_runs_in_the_middle_and_its_wheels_carry_the_load(kind, tmp_path):
    """From floating over the rails, off the middle; the spin is that of rolling."""
    text = WHEELSET.read_text(encoding="utf-8")
    assert WRITTEN["elastic"] in text
    text = text.replace(WRITTEN["elastic"], WRITTEN[kind])
    path = tmp_path / "wheelset.yaml"
    path.write_text(text, encoding="utf-8")
    model = load_model(str(path), ["initial.wheelset.vertical=0.3 mm"])
    prepared = prepare(model, backend="interpreted", progress=lambda text, part: None)
    point = reference_point(prepared, 0.0, None)
    names = [channel.name for channel in prepared.equations.channels]
    found = dict(
        zip(names, np.array(prepared.kernel.outputs(0.0, point.state, point.unknowns)), strict=True)
    )
    assert found["wheels.lateral_shift"] == pytest.approx(0.0, abs=1e-9)
    assert found["wheels.left.Q"] == pytest.approx(50e3, rel=1e-6)
    assert found["wheels.right.Q"] == pytest.approx(50e3, rel=1e-6)
    assert found["wheels.left.Y"] == pytest.approx(-found["wheels.right.Y"], rel=1e-6)
    assert found["wheelset.spin_rate"] == pytest.approx(20.0 / 0.46, rel=1e-3)
    rates = prepared.kernel.rates(0.0, point.state, point.unknowns)
    assert np.abs(rates[list(prepared.equations.velocities)]).max() < 1e-8
