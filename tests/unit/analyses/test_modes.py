"""The verb "eig": shapes in dependent coordinates, zeros, cases, and what is not steady."""

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import find_modes
from vehicledyn.analyses.linear.frequency_grid import FrequencyGrid
from vehicledyn.base.errors import InputError
from vehicledyn.cli.commands.linear import cases_of
from vehicledyn.cli.options import speeds_in_si
from vehicledyn.files.scenario import load_model, load_scenario
from vehicledyn.results.labelled.requested import save_standard
from vehicledyn.results.tables.mode_table import read_modes, write_modes


def quiet(text, fraction):
    pass


def modes_of(target, **options):
    return find_modes(target, speeds=[], backend="interpreted", progress=quiet, **options)


@pytest.fixture
def system(tmp_path):
    def write(text, *changes):
        path = tmp_path / "system.yaml"
        path.write_text(text, encoding="utf-8")
        return load_model(str(path), changes)

    return write


CHAIN = """
title: Masses in a row on springs
parameters: {mass: 2 kg, stiffness: 700 N/m}
gravity: [0, 0, 0]
repeat:
  - for: {i: {from: 1, to: 6}}
    bodies:
      "body_{i}": {at: ["{i} * 1 m", 0, 0], joints: [T1 x], mass: mass}
  - for: {i: {from: FIRST, to: LAST}}
    links:
      "spring_{i}":
        a: {body: "body_{i}"}
        b: {body: "body_{i + 1}"}
        law: {kind: spring_damper, stiffness: stiffness, free_length: 1 m}
"""
WALLS = """links:
  first: {a: ground, b: body_1, law: {kind: spring_damper, stiffness: stiffness, free_length: 1 m}}
  last:
    a: body_6
    b: {body: ground, point: [7 m, 0, 0]}
    law: {kind: spring_damper, stiffness: stiffness, free_length: 1 m}
"""


def test_chain_between_walls(system):
    """ω_k = 2 √(k/m) sin(k π/(2 (N + 1))) to 1e-10, shapes sin(j k π/(N + 1))."""
    report = modes_of(system(CHAIN.replace("FIRST", "1").replace("LAST", "5") + WALLS))
    table, (case,) = report.table, report.table.cases
    assert table.coordinates == tuple(f"body_{i}.x" for i in range(1, 7))
    k = np.arange(1, 7)
    exact = 2.0 * np.sqrt(350.0) * np.sin(k * np.pi / 14.0)
    assert case.eigenvalue.imag == pytest.approx(exact, rel=1e-10)
    assert np.abs(case.eigenvalue.real).max() < 1e-10
    for number, row in zip(k, case.channel_shape[:, table.columns(table.coordinates)], strict=True):
        shape = np.sin(k * number * np.pi / 7.0)
        leading = int(np.argmax(np.abs(row)))
        assert row == pytest.approx(shape / shape[leading] * row[leading], abs=1e-9)
        assert abs(row[leading]) == pytest.approx(1.0, rel=1e-6)


def test_free_chain_is_told_as_free_and_drifting(system):
    report = modes_of(system(CHAIN.replace("FIRST", "1").replace("LAST", "5")))
    (case,) = report.table.cases
    assert case.kind == ("free", "drift", *("oscillation",) * 5)
    columns = report.table.columns([f"body_{i}.x" for i in range(1, 7)])
    assert case.channel_shape[0, columns] == pytest.approx(np.ones(6), abs=1e-12)
    exact = 2.0 * np.sqrt(350.0) * np.sin(np.arange(1, 6) * np.pi / 12.0)
    assert case.eigenvalue[2:].imag == pytest.approx(exact, rel=1e-10)
    text = report.as_text().splitlines()
    assert "2 zeros, 5 undamped" in text[0]
    assert text[2].split() == ["0", "(free)", "body_1.x"]
    assert text[3].split()[:2] == ["0", "(drift)"]


LINKAGE = """
title: A crank drives a slider against a spring
parameters: {radius: 0.1 m, rod: 0.3 m, stiffness: 500 N/m}
gravity: [0, 0, 0]
bodies:
  crank:
    joints: [{kind: R2, name: angle, role: independent, start: -90 deg}]
    mass: 1 kg
    inertia: [0.01 kg*m^2, 0.01 kg*m^2, 0.01 kg*m^2]
  coupler: {parent: crank, at: [radius, 0, 0], joints: [{kind: R2, name: angle, start: 110 deg}]}
  slider: {joints: [{kind: T1, name: x, start: 0.28 m}], mass: 2 kg}
cuts:
  pin: {kind: ball, a: {body: coupler, point: [rod, 0, 0]}, b: slider}
springs:
  hold: {coordinate: slider.x, law: {kind: spring_damper, stiffness: stiffness, free_length: FREE}}
"""


def test_dependent_coordinates_and_forces_move_along(system):
    """Crank upright: x = r cos φ + √(l² - r² sin²φ), dx/dφ = -r sin φ there, r for φ = -90°."""
    free = float(np.sqrt(0.3**2 - 0.1**2))
    report = modes_of(system(LINKAGE.replace("FREE", f"{free!r} m")))
    table, (case,) = report.table, report.table.cases
    crank, slider, force = case.channel_shape[
        0, table.columns(["crank.angle", "slider.x", "hold.force"])
    ]
    assert crank == pytest.approx(1.0, rel=1e-12)
    assert slider == pytest.approx(0.1, rel=1e-9)
    assert force == pytest.approx(-500.0 * slider, rel=1e-9)
    exact = np.sqrt(500.0 * 0.1**2 / (0.01 + 2.0 * 0.1**2))
    assert case.eigenvalue[0].imag == pytest.approx(exact, rel=1e-9)
    (line,) = [row for row in report.as_text().splitlines() if "Hz" in row]
    assert "crank.angle 1" in line and "slider.x 0.1" in line


@pytest.mark.long
def test_several_variants_are_cases(system, tmp_path):
    text = CHAIN.replace("FIRST", "1").replace("LAST", "5") + WALLS
    variants = [(f"mass={m} kg", system(text, f"mass={m} kg")) for m in (2, 8)]
    write_modes(tmp_path / "modes.h5", modes_of(variants).table)
    save_standard({"": tmp_path / "modes.h5"}, tmp_path / "figures")
    modes = read_modes(tmp_path / "modes.h5")
    assert [case.label for case in modes.cases] == ["mass=2 kg", "mass=8 kg"]
    ratio = modes.cases[0].frequency / modes.cases[1].frequency
    assert ratio == pytest.approx(2.0 * np.ones(6), rel=1e-9)
    assert (tmp_path / "figures" / "root_locus.svg").is_file()


def test_a_start_that_is_not_steady_says_so(tmp_path, system):
    system(CHAIN.replace("FIRST", "1").replace("LAST", "5") + WALLS)
    scenario = tmp_path / "run.yaml"
    scenario.write_text(
        "title: Pulled\nmodel: system.yaml\nstart: nominal\ninitial: {body_2.x: 0.1 m}\n"
        "duration: 1 s\nsolver: {kind: rk4, step: 1 ms}\noutput: {interval: 10 ms}\n"
    )
    text = modes_of(load_scenario(scenario)).as_text()
    assert "the reference motion is not steady: body_2.x_rate changes by -70 m/s^2" in text


def test_keys_given_several_times_make_cases():
    assert cases_of([]) == [("", [])]
    assert cases_of(["a=1", "b=2"]) == [("", ["a=1", "b=2"])]
    assert cases_of(["a=1", "b=2", "a=3"]) == [("a=1", ["a=1", "b=2"]), ("a=3", ["a=3", "b=2"])]
    with pytest.raises(InputError, match="a 2, b 3"):
        cases_of(["a=1", "a=2", "b=1", "b=2", "b=3"])


def test_ranges_of_speeds_and_frequencies():
    assert speeds_in_si("36 km/h") == pytest.approx([10.0])
    assert speeds_in_si("2 m/s:36 km/h:3") == pytest.approx([2.0, 6.0, 10.0])
    for text in ("1:2", "1:2:1", "1:2:x", "1:2:100000"):
        with pytest.raises(InputError, match="write FROM:TO:COUNT"):
            speeds_in_si(text)
    assert FrequencyGrid(1.0, 4.0, 3).frequencies() == pytest.approx([1.0, 2.0, 4.0])
    assert FrequencyGrid(1.0, 4.0, 4, "linear").frequencies() == pytest.approx([1, 2, 3, 4])
    for first, last, points in ((2.0, 1.0, 9), (1.0, 1.0, 9), (1.0, 2.0, 1)):
        with pytest.raises(InputError, match=r"^(first|points)="):
            FrequencyGrid(first, last, points)
