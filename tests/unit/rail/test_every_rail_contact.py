"""What every model of wheel and rail in contact must do."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.prepare import prepare, reference_point
from vehicledyn.base.registry import kinds
from vehicledyn.files.scenario import load_model

pytestmark = pytest.mark.long

WHEELSET = Path(__file__).parents[3] / "systems" / "rail_wheelset.yaml"
WRITTEN = {
    "elastic": "{kind: elastic, youngs_modulus: 210 GPa, poissons_ratio: 0.28, damping: 2 s/m}",
    "rigid": "{kind: rigid, youngs_modulus: 210 GPa, poissons_ratio: 0.28}",
}


class Standing:
    """The wheelset in the middle of the track with a model of contact, from off the rails."""

    def __init__(self, kind, path):
        text = WHEELSET.read_text(encoding="utf-8")
        assert WRITTEN["elastic"] in text
        path.write_text(text.replace(WRITTEN["elastic"], WRITTEN[kind]), encoding="utf-8")
        model = load_model(str(path), ["initial.wheelset.vertical=0.3 mm"])
        self.prepared = prepare(model, backend="interpreted", progress=lambda text, part: None)
        self.point = reference_point(self.prepared, 0.0, None)
        self.channels = {item.name: item for item in self.prepared.equations.channels}

    def found(self, **changed):
        """Return the channels, of a state with some other numbers."""
        state = self.point.state.copy()
        names = [variable.name for variable in self.prepared.equations.states]
        for name, value in changed.items():
            state[names.index(f"wheelset.{name}")] = value
        values = self.prepared.kernel.outputs(0.0, state, self.point.unknowns)
        return dict(zip(self.channels, values, strict=True))

    def of_wheels(self):
        """Return unit, description and frame of what its wheels and their body report."""
        return {
            name: (channel.unit, channel.description, channel.frame)
            for name, channel in self.channels.items()
            if name.startswith("wheels.") and ".contact_2." not in name
        }


@pytest.fixture(scope="module")
def standing(tmp_path_factory):
    folder = tmp_path_factory.mktemp("contacts")
    return {kind: Standing(kind, folder / f"{kind}.yaml") for kind in kinds("rail_contact")}


@pytest.mark.parametrize("kind", kinds("rail_contact"))
def test_wheelset_runs_in_the_middle_and_its_wheels_carry_the_load(kind, standing):
    """From floating over the rails, off the middle; the spin is that of rolling."""
    found = standing[kind].found()
    assert found["wheels.lateral_shift"] == pytest.approx(0.0, abs=1e-9)
    assert found["wheels.left.Q"] == pytest.approx(50e3, rel=1e-6)
    assert found["wheels.right.Q"] == pytest.approx(50e3, rel=1e-6)
    assert found["wheels.left.Y"] == pytest.approx(-found["wheels.right.Y"], rel=1e-6)
    assert found["wheelset.spin_rate"] == pytest.approx(20.0 / 0.46, rel=1e-3)
    prepared, point = standing[kind].prepared, standing[kind].point
    rates = prepared.kernel.rates(0.0, point.state, point.unknowns)
    assert np.abs(rates[list(prepared.equations.velocities)]).max() < 1e-8


def test_channels_of_all_models_are_named_alike(standing):
    """Elastic contact alone has an approach, rigid contact alone coordinates of its contacts."""
    elastic, rigid = (standing[kind].of_wheels() for kind in ("elastic", "rigid"))
    sides = ("wheels.left", "wheels.right")
    assert set(elastic) - set(rigid) == {f"{side}.contact_1.approach" for side in sides}
    contacts = {name for name in rigid if ".contact_1." in name}
    assert len(contacts) == 2 * 11
    assert contacts <= set(elastic)
    assert {name: rigid[name] for name in set(elastic) & set(rigid)} == {
        name: elastic[name] for name in set(elastic) & set(rigid)
    }


@pytest.mark.parametrize("kind", kinds("rail_contact"))
@pytest.mark.parametrize("slip", [0.2, -0.1])
def test_creepages_refer_to_the_speed_of_travel(kind, slip, standing):
    """Of a wheelset that is braked or driven; its friction works what the wear number says."""
    found = standing[kind].found(spin_rate=(1.0 - slip) * 20.0 / 0.46)
    for side in ("left", "right"):
        at = {
            name.rpartition(".")[2]: value
            for name, value in found.items()
            if name.startswith(f"wheels.{side}.contact_1.")
        }
        speed = found["wheels.track_speed"]
        rolling = found["wheelset.spin_rate"] * at["rolling_radius"]
        assert at["longitudinal_creepage"] == pytest.approx((speed - rolling) / speed, rel=1e-6)
        pairs = ("longitudinal_force", "longitudinal_creepage"), ("lateral_force",
            "lateral_creepage"), ("spin_moment", "spin_creepage")  # fmt: skip
        work = sum(abs(at[force] * at[creep]) for force, creep in pairs)
        assert found[f"wheels.{side}.wear_number"] == pytest.approx(work, rel=1e-9)


@pytest.mark.parametrize("kind", kinds("rail_contact"))
def test_places_of_a_contact_on_wheel_and_rail_belong_together(kind, standing):
    """Of a level axle in the middle: the tape circle is 750 mm from there, 460 mm its radius."""
    found = standing[kind].found()
    for side, sign in (("left", 1.0), ("right", -1.0)):
        head = f"wheels.{side}.contact_1."
        across = 0.75 + found[f"{head}place"]
        assert sign * found[f"{head}lateral_place"] == pytest.approx(across, abs=1e-6)
        slope = (found[f"{head}rolling_radius"] - 0.46) / found[f"{head}place"]
        assert slope == pytest.approx(-np.tan(found[f"{head}angle"]), abs=0.02)
