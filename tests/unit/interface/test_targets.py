"""How often what an analysis is asked about is read."""

from collections import Counter

from vehicledyn.base import yaml
from vehicledyn.interface.targets import read_scenario


def test_a_changed_scenario_reads_the_parts_of_its_model_once(monkeypatch):
    read, found = yaml._read_bytes, Counter()

    def counted(path, *rest):
        found[path.name] += 1
        return read(path, *rest)

    monkeypatch.setattr(yaml, "_read_bytes", counted)
    changed = read_scenario("assembled_car", ["duration=1 s", "parameters.body.mass=1.3 t"])
    assert changed.scenario.duration == 1.0
    parts = {name: count for name, count in found.items() if name != "assembled_car.yaml"}
    assert parts == dict.fromkeys(parts, 1)
    assert len(parts) == 4
