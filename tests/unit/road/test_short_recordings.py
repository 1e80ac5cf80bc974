"""Key figures of manoeuvres from a few samples, as windows of the accuracy watch have them."""

import numpy as np
import pytest
from manoeuvre_examples import MANOEUVRES, written

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.files.scenario import load_scenario
from vehicledyn.road.manoeuvres.channel_recorder import Recording


class Zeros(dict):
    """Channels that are zero for so many samples."""

    def __init__(self, count):
        super().__init__()
        self.count = count

    def __missing__(self, name):
        return np.zeros(self.count)


@pytest.mark.parametrize("kind", MANOEUVRES)
def test_few_samples_give_figures_or_none(tmp_path, kind):
    path = tmp_path / "run.yaml"
    path.write_text(written(MANOEUVRE=MANOEUVRES[kind]))
    subject = build_subject(load_scenario(path, ()))
    for count in (1, 2, 3):
        recording = Recording(0.01 * np.arange(count), Zeros(count))
        for entry in subject.manoeuvre.summarise(recording, subject.vehicle):
            assert entry.name and entry.description
