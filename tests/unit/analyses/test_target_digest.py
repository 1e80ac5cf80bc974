"""Digests of targets differ where their results may: in values, files and code of one's own."""

from pathlib import Path

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.target_digest import target_digest
from vehicledyn.files.scenario import load_model, load_scenario

SYSTEMS = Path(__file__).parents[3] / "systems"


def test_values_of_models_count():
    path = str(SYSTEMS / "simple_wheelset.yaml")
    model = load_model(path)
    other = load_model(path, ["parameters.speed=31 m/s"])
    assert target_digest(model) == target_digest(load_model(path))
    assert target_digest(model) != target_digest(other)
    assert target_digest(load_model("iltis")) != target_digest(
        load_model("iltis", ["parameters.chassis.mass=999 kg"])
    )


def test_values_and_files_of_scenarios_count(tmp_path):
    text = (SYSTEMS / "double_pendulum.yaml").read_text(encoding="utf-8")
    (tmp_path / "double_pendulum.yaml").write_text(text, encoding="utf-8")
    run = tmp_path / "run.yaml"
    run.write_text("title: A\nmodel: double_pendulum.yaml\nduration: 1 s\n"
                   "solver: {kind: rk4, step: 1 ms}\noutput: {interval: 10 ms}\n")  # fmt: skip
    known = target_digest(load_scenario(run))
    assert known == target_digest(load_scenario(run))
    assert known != target_digest(load_scenario(run, ["duration=2 s"]))
    (tmp_path / "double_pendulum.yaml").write_text(f"{text}# more\n", encoding="utf-8")
    assert known != target_digest(load_scenario(run))
