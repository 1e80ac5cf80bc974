"""The verb that exports, from the command line to the files."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from vehicledyn.cli import main

pytestmark = pytest.mark.long
ROOT = Path(__file__).parents[3]
RAMP = ROOT / "scenarios" / "iltis_ramp_steer.yaml"


@pytest.fixture
def call(monkeypatch, capsys, tmp_path):
    """Run the command line in this process and in an empty folder; return code, output, error."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["vehicledyn", *map(str, arguments)])
        with pytest.raises(SystemExit) as end:
            main()
        captured = capsys.readouterr()
        return end.value.code, captured.out, captured.err

    return run


def test_scenario_as_python(call, tmp_path):
    """Parameters, overrides and the start of the scenario stand in the file, which runs alone."""
    code, out, _ = call("export", RAMP, "--to", "python", "--set", "parameters.chassis.mass=1.5 t")
    assert (code, out) == (0, "iltis_ramp_steer.py\n")
    ask = """
import sys
sys.modules["casadi"] = sys.modules["vehicledyn"] = None
sys.path.insert(0, ".")
import iltis_ramp_steer as m
import numpy as np
p = m.Parameters()
z = m.solve_loops(0.0, m.x_start, m.z_start, p)
print(p.chassis_mass, np.abs(z - m.z_start).max(), m.x_start.max())
print(*np.abs(m.rates(0.0, m.x_start, z, p))[6:10])
"""
    done = subprocess.run(
        [sys.executable, "-I", "-c", ask], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    mass, off, speed, *rates = map(float, done.stdout.split())
    assert mass == 1500.0
    assert off < 1e-9
    assert speed > 10.0
    assert max(rates) < 1e-6


def test_files_and_folders(call, tmp_path):
    code, out, _ = call(
        "export", "iltis", "--to", "c", "-o", tmp_path / "there" / "car.c", "--json"
    )
    assert code == 0
    assert json.loads(out)["files"] == [str(tmp_path / "there" / f"car.{k}") for k in "ch"]
    assert "void car_mass_matrix(" in (tmp_path / "there" / "car.h").read_text(encoding="utf-8")
    code, out, _ = call("export", "iltis", "--to", "matlab", "-o", "folder")
    assert (code, out) == (0, str(Path("folder", "iltis.m")) + "\n")


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["iltis", "--to", "fortran"], "fortran"),
        (["iltis", "--to", "c", "-o", "a-b.c"], "'a_b' is"),
        (["itlis", "--to", "c"], "did you mean 'iltis'?"),
        (["iltis", "--to", "fmu", "-o", "/dev/null/x.fmu"], "cannot be written"),
    ],
)
def test_bad_input(call, arguments, told):
    code, out, err = call("export", *arguments)
    assert (code, out) == (2, "")
    assert told in err
