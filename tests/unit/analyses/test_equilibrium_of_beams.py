"""What an equilibrium keeps of a beam: deflections, angles and stresses beside forces."""

import json

import h5py
import pytest
from programs import call

import vehicledyn as vd
from vehicledyn.results.tables.equilibrium_table import read_equilibrium

LENGTH, WIDTH, HEIGHT, YOUNG, DENSITY, LOAD = 1.5, 0.02, 0.01, 210e9, 7850.0, 2.0
CANTILEVER = f"""title: A strip with a load at its end
bodies:
  load: {{parent: strip.tip, mass: {LOAD} kg}}
elements:
  strip:
    kind: beam
    body: ground
    length: {LENGTH} m
    section: {{shape: rectangle, width: {WIDTH} m, height: {HEIGHT} m}}
    material: {{density: {DENSITY} kg/m^3, young: {YOUNG} Pa}}
    modes: {{z: 5}}
    stiffening: none
sensors: {{end: {{kind: point, body: strip.tip, shows: [position]}}}}
"""


def closed_form():
    """Deflection [m] and stress [Pa] of a heavy cantilever with a weight at its end."""
    line, load = DENSITY * WIDTH * HEIGHT * 9.81, LOAD * 9.81
    bending = YOUNG * WIDTH * HEIGHT**3 / 12.0
    sag = line * LENGTH**4 / (8.0 * bending) + load * LENGTH**3 / (3.0 * bending)
    moment = line * LENGTH**2 / 2.0 + load * LENGTH
    return -sag, moment * HEIGHT / 2.0 * YOUNG / bending


def test_deflections_and_stresses_are_kept_and_printed(tmp_path):
    file = tmp_path / "strip.yaml"
    file.write_text(CANTILEVER)
    words = ["vehicledyn", "equilibrium", file, "--backend", "interpreted"]
    done = call([*words, "-o", tmp_path / "strip.h5"], tmp_path)
    assert done.returncode == 0, done.stderr
    sag, stress = closed_form()
    (line,) = (text for text in done.stdout.splitlines() if "strip.tip_z" in text)
    assert float(line.split()[3]) == pytest.approx(1e3 * sag, rel=1e-5)
    assert line.split()[-1] == "mm"
    (line,) = (text for text in done.stdout.splitlines() if "strip.start.stress" in text)
    assert line.split()[-1] == "MPa"
    found = vd.open_result(tmp_path / "strip.h5")
    assert float(found["strip.tip_z"].values) == pytest.approx(sag, rel=1e-9)
    assert float(found["end.z"].values) == pytest.approx(sag, rel=1e-9)
    assert float(found["strip.start.stress"].values) == pytest.approx(stress, rel=1e-9)
    assert found["strip.start.stress"].unit == "Pa"
    done = call([*words, "--json"], tmp_path)
    shown = json.loads(done.stdout)["channels"]["strip.tip_z"]
    assert shown == {"unit": "m", "nominal": 0.0, "equilibrium": pytest.approx(sag, rel=1e-9)}


def test_files_without_other_channels_still_open(tmp_path):
    file = tmp_path / "strip.yaml"
    file.write_text(CANTILEVER)
    path = vd.equilibrium(file, backend="interpreted", save_to=tmp_path / "new.h5").path
    with h5py.File(path, "r") as whole, h5py.File(tmp_path / "old.h5", "w") as old:
        old.attrs.update(dict(whole.attrs))
        for name in whole:
            if not name.startswith("channel"):
                whole.copy(name, old)
    read = read_equilibrium(tmp_path / "old.h5")
    assert read.channels == ()
    assert len(read.coordinates) == 5
