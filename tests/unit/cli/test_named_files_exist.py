"""``validate`` opens the files that scenarios, systems, studies and tracks name."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.simulation.mended_profiles import mended_profiles
from vehicledyn.base.errors import InputError
from vehicledyn.cli.commands.files import read_file
from vehicledyn.files.scenario import load_scenario
from vehicledyn.rail.profiles.named_profiles import named_profile

ROOT = Path(__file__).parents[3]
SYSTEM = ROOT / "systems" / "rail_wheelset.yaml"
TRAM = ROOT / "scenarios" / "tram2000_curve.yaml"


def problems(folder, text, name="file.yaml"):
    path = folder / name
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_file(path, [])
    return str(caught.value).replace(f"{folder}/", "")


def tram(old, new):
    text = TRAM.read_text().replace("../systems/", f"{ROOT / 'systems'}/")
    assert old in text
    return text.replace(old, new)


def test_rails_that_are_not_there(tmp_path):
    told = problems(tmp_path, tram("rail: 60E1", "rail: nosuch.csv"))
    assert "track: rail: nosuch.csv: there is no such file" in told
    told = problems(tmp_path, tram("rail: 60E1", "rail: S1002"))
    assert "track: rail: 'S1002' is the profile of a wheel, a rail's is needed here" in told


def test_wheels_that_are_not_there(tmp_path):
    text = SYSTEM.read_text().replace("profile: S1002", "profile: nosuch.whl")
    told = problems(tmp_path, text, "system.yaml")
    assert "rail_wheels.wheels: profile: nosuch.whl: there is no such file" in told
    scenario = (ROOT / "scenarios" / "systems" / "rail_wheelset.yaml").read_text()
    told = problems(tmp_path, scenario.replace("../../systems/rail_wheelset", "system"))
    assert "rail_wheels.wheels: profile: nosuch.whl: there is no such file" in told


def test_a_track_of_its_own_file(tmp_path):
    track = "kind: straight\ngauge: 1435 mm\ninclination: 1/40\nrail: nosuch.ban\n"
    assert "nosuch.ban: there is no such file" in problems(tmp_path, track, "line.yaml")


@pytest.mark.parametrize(
    ("road", "words"),
    [
        ("{kind: profile, file: nosuch.csv}", "road: nosuch.csv: there is no such file"),
        ("{kind: flat}\nmotion: nosuch.csv", "motion: nosuch.csv: there is no such file"),
    ],
)
def test_roads_and_motions(tmp_path, road, words):
    text = (ROOT / "scenarios" / "iltis_slalom.yaml").read_text()
    assert words in problems(tmp_path, text.replace("road:\n  kind: flat", f"road: {road}"))


def test_studies_pass_on_what_their_scenario_lacks(tmp_path):
    (tmp_path / "ride.yaml").write_text(tram("rail: 60E1", "rail: nosuch.csv"))
    study = "title: Speeds\nscenario: ride.yaml\ncases: {kind: grid, vary: {speed: [5, 6]}}\n"
    assert "nosuch.csv: there is no such file" in problems(tmp_path, study)


def test_measured_wheels_in_a_system(tmp_path):
    """Defects are refused where the file is named, and mended where that is asked for."""
    profile = named_profile("S1002", "wheel")
    y = np.arange(-0.068, 0.058, 2.5e-4)
    z = profile.height(y)
    z[300] += 5e-4
    rows = "".join(f"{1e3 * a:.4f} {1e3 * b:.4f}\n" for a, b in zip(y, z, strict=True))
    (tmp_path / "worn.txt").write_text(rows)
    worn = SYSTEM.read_text().replace("profile: S1002", "profile: worn.txt")
    told = problems(tmp_path, worn)
    assert "rail_wheels.wheels: profile: worn.txt:301:1: an outlier in line 301" in told
    reading = "profile: worn.txt, profile_reading: {smoothing: 4 mm, defects: mend}"
    (tmp_path / "mended.yaml").write_text(worn.replace("profile: worn.txt", reading))
    read_file(tmp_path / "mended.yaml", [])
    scenario = (ROOT / "scenarios" / "systems" / "rail_wheelset.yaml").read_text()
    (tmp_path / "run.yaml").write_text(scenario.replace("../../systems/rail_wheelset", "mended"))
    (told,) = mended_profiles(load_scenario(tmp_path / "run.yaml"))
    assert told.startswith(f"{tmp_path / 'worn.txt'}: left out: an outlier in line 301")
    wrong = worn.replace("profile: worn.txt", "profile: worn.txt, profile_reading: {defects: men}")
    assert "profile_reading.defects" in problems(tmp_path, wrong)


def test_the_verb_ends_with_the_code_of_wrong_input(tmp_path):
    (tmp_path / "ride.yaml").write_text(tram("rail: 60E1", "rail: nosuch.csv"))
    done = subprocess.run(
        [sys.executable, "-m", "vehicledyn", "validate", "ride.yaml"],
        cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.startswith("ride.yaml:")
