"""A body without forces goes straight on, whatever track it is described relative to."""

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.simulation.simulation import run_scenario
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.store.reader import open_result

SYSTEM = """\
title: A free body described relative to a frame on a track
parameters: {speed: 20 m/s, mass: 10 t, ahead: 0 m}
gravity: [0, 0, 0]
bodies:
  runner: {joints: [{kind: track_frame, position: speed * time + 5 m - ahead}]}
  body:
    parent: runner
    at: [ahead, 0, 1.5 m]
    joints: [free]
    mass: mass
    inertia: [10 t*m^2, 150 t*m^2, 140 t*m^2]
sensors:
  middle: {kind: point, body: body, shows: [position, velocity]}
  turned: {kind: angles, body: body}
"""
SCENARIO = """\
title: It goes straight on
model: free.yaml
track:
  kind: layout
  gauge: 1435 mm
  inclination: 1/40
  rail: 60E1
"""
SOLVER = """\
duration: 8 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 20 ms}
"""
RAMPED = """\
  segments:
    - {kind: straight, length: 30 m}
    - {kind: KIND, length: 35 m}
    - {kind: arc, length: 30 m, radius: 600 m, cant: 100 mm}
    - {kind: KIND, length: 35 m}
    - {kind: straight, length: 50 m}
"""
ABRUPT = """\
  segments:
    - {kind: straight, length: 25.3 m}
    - {kind: ramp, length: 10 m}
    - {kind: arc, length: 60 m, radius: -600 m, cant: -60 mm}
    - {kind: ramp, length: 12 m}
    - {kind: straight, length: 50 m}
"""
GRADED = """\
  segments: [{kind: straight, length: 200 m}]
  gradients: [{at: 40 m, slope: 20 permilRADIUS}, {at: 100 m, slope: -10 permilRADIUS}]
"""
LOW_RAIL = "  cant_about: low_rail\n"
TRACKS = {
    **{kind: RAMPED.replace("KIND", kind) for kind in ("clothoid", "bloss", "cosine", "klein")},
    "cubic_parabola": RAMPED.replace("KIND", "cubic_parabola"),
    "low_rail": LOW_RAIL + RAMPED.replace("KIND", "clothoid"),
    "abrupt": ABRUPT,
    "abrupt_low_rail": LOW_RAIL + ABRUPT,
    "rounded_gradient": GRADED.replace("RADIUS", ", radius: 2000 m"),
    "gradient": GRADED.replace("RADIUS", ""),
}


@pytest.fixture
def run(tmp_path):
    def run_text(track, kind="layout", **parameters):
        (tmp_path / "free.yaml").write_text(SYSTEM)
        path, output = tmp_path / "goes.yaml", tmp_path / "goes.h5"
        path.write_text(SCENARIO.replace("layout", kind) + track + SOLVER)
        loaded = load_scenario(path, [f"{name}={value}" for name, value in parameters.items()])
        output.unlink(missing_ok=True)
        run_scenario(loaded, output=output, backend="auto", progress=lambda *_: None)
        with open_result(output) as result:
            return result.as_frame().reset_index()

    return run_text


@pytest.mark.parametrize("name", TRACKS)
def test_a_free_body_goes_straight_on(name, run):
    """The kinks of the design turned it by 3.8 degrees and gave it 2.9 kJ."""
    found = run(TRACKS[name], ahead="10.8 m")
    assert np.abs(found.filter(regex=r"^turned\.").to_numpy()).max() < 1e-8
    assert found["middle.y"].abs().max() < 1e-7
    assert found["middle.z"].to_numpy() == pytest.approx(1.5, abs=1e-7)
    assert found["energy.kinetic"].to_numpy() == pytest.approx(0.5 * 1e4 * 20.0**2, rel=1e-9)


def test_a_surveyed_track_with_a_kink_at_every_line_does_not_turn_it(run, tmp_path):
    lines = [
        f"{5 * k}, {max(k - 8, 0) * np.sin(0.7 * k) / 20:.4f}, "
        f"{40 * np.sin(0.5 * k) * (k > 8):.3f}, {4 * np.sin(k) * (k > 8):.3f}"
        for k in range(40)
    ]
    head = "s [m], curvature [1/km], cant [mm], gradient [permil]"
    (tmp_path / "surveyed.csv").write_text("\n".join([head, *lines]))
    found = run("  file: surveyed.csv\n", kind="measured")
    assert np.abs(found.filter(regex=r"^turned\.").to_numpy()).max() < 1e-7
    assert found["energy.kinetic"].to_numpy() == pytest.approx(0.5 * 1e4 * 20.0**2, rel=1e-9)
