"""Hunting studies that cannot be are refused before a model is derived."""

from pathlib import Path

import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.hunting.hunt import find_limit_cycles
from vehicledyn.analyses.hunting.start import HuntSettings
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_scenario
from vehicledyn.multibody.equations import derivation

CURVE = Path(__file__).parents[3] / "scenarios" / "systems" / "curving_wheelset.yaml"


@pytest.fixture(autouse=True)
def _no_derivation(monkeypatch):
    def derived(*_, **__):
        raise AssertionError("derived before it was refused")

    monkeypatch.setattr(derivation, "solve_motion", derived)


@pytest.mark.parametrize(
    ("parameter", "last", "told"),
    [
        ("sped", "30 m/s", "parameter='sped': .* did you mean 'speed'"),
        ("speed", "30 kg", "last='30 kg': .* wrong unit"),
        ("speed", "5 m/s", "the first must be below the last"),
        ("speed", "30 m/s", "the track of 'frame.track_frame' changes on the way"),
    ],
)
def test_it_is_refused_at_once(parameter, last, told):
    settings = HuntSettings(parameter=parameter, first="10 m/s", last=last)
    with pytest.raises(InputError, match=told):
        find_limit_cycles(
            load_scenario(CURVE), settings, backend="interpreted", progress=lambda *_: None
        )
