"""Roads from files: the height of the file, level beyond it, and what is no road."""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.memory.run_cache import key_of_run
from vehicledyn.analyses.preparation.prepare import prepare, start_point
from vehicledyn.base.errors import InputError
from vehicledyn.base.numbers.shape_preserving import excess, level_slopes
from vehicledyn.codegen.toolchain.fingerprint import fingerprint
from vehicledyn.files.scenario import load_scenario
from vehicledyn.road.surfaces.profile import ProfileRoad
from vehicledyn.road.surfaces.sine import Sine

ROOT = Path(__file__).resolve().parents[3]


def written(folder, x, z, head="x [m], z [mm]", scale=1e3):
    path = folder / "road.csv"
    lines = [f"{a!r}, {scale * b!r}" for a, b in zip(x.tolist(), z.tolist(), strict=True)]
    path.write_text("\n".join([head, *lines]))
    return path


@pytest.mark.parametrize("even", [True, False])
def test_sine_from_a_file_is_that_of_the_formula(tmp_path, even):
    """Between crests, where the wave is as level as the ends of the file are."""
    wave = Sine(amplitude_x=0.04, wavelength_x=2.0, amplitude_y=0.0, wavelength_y=1.0)
    x = np.linspace(0.5, 10.5, 501)
    if not even:
        x[1:-1] += np.random.default_rng(2).uniform(-0.006, 0.006, x.size - 2)
    z = 0.04 * np.sin(math.pi * x)
    road = ProfileRoad(file=str(written(tmp_path, x, z)), start=3.0)
    for place in np.random.default_rng(3).uniform(0.5, 10.5, 50):
        assert road.height(place + 3.0, 7.0) == pytest.approx(wave.height(place, 0.0), abs=2e-7)
        assert road.gradient(place + 3.0, 7.0)[0] == pytest.approx(
            wave.gradient(place, 0.0)[0], abs=2e-4
        )
    for place, height in ((3.4, 0.04), (-90.0, 0.04), (13.6, 0.04), (99.0, 0.04)):
        assert road.height(place, 0.0) == pytest.approx(height, abs=1e-12)
        assert road.gradient(place, 0.0)[0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "the file is empty"),
        ("x [m], z\n0, 0\n", "say the unit of the column"),
        ("x [m], z [s]\n0, 0\n", "does not measure a quantity in m"),
        ("x [m], y [m]\n0, 0\n", "no column named 'y'"),
        ("x [m], z [m]\n0, 0\n", "2 points at least"),
        ("x [m], z [m]\n0, 0\n1, 0\n1, 0\n2, 0\n", "road.csv:4:1: x: the place is there twice"),
        ("x [m], z [m]\n0, 0\n2, 0\n1, 0\n3, 0\n", "road.csv:4:1: x: the places do not grow"),
        ("x [m], z [m]\n0, 0\n1, zero\n2, 0\n3, 0\n", "road.csv:3:4: z: 'zero' is no number"),
        ("x [m], z [m]\n0, 0\n1, 80\n2, 0\n3, 0\n", "road.csv:3:4: z: more than 10 m away"),
    ],
)
def test_files_that_are_no_road_are_refused_when_the_scenario_is_read(tmp_path, text, words):
    (tmp_path / "road.csv").write_text(text)
    scenario = tmp_path / "scenario.yaml"
    scenario.write_text(text_of_scenario())
    with pytest.raises(InputError, match="road") as told:
        load_scenario(scenario)
    assert words in str(told.value).replace(f"{tmp_path}/", "")


def test_missing_file_and_uneven_points_are_told(tmp_path):
    scenario = tmp_path / "scenario.yaml"
    scenario.write_text(text_of_scenario())
    with pytest.raises(InputError, match=r"road.csv: there is no such file"):
        load_scenario(scenario)
    x = np.array([0.0, 1e-6, 1.0, 2.0, 3.0, 9.0])
    road = ProfileRoad(file=str(written(tmp_path, x, np.array([0.0, 0.1, 0.0, 0.1, 0.0, 0.1]))))
    with pytest.raises(InputError, match="too uneven"):
        road.height(0.0, 0.0)


KERBS = {
    "four points": ([0.0, 10.0, 10.05, 20.0], [0.0, 0.0, 0.08, 0.08]),
    "a millimetre wide": ([0.0, 10.0, 10.001, 20.0], [0.0, 0.0, 0.08, 0.08]),
    "two points": ([0.0, 0.05], [0.0, 0.08]),
    "even": (np.arange(60) * 0.1, np.where(np.arange(60) < 30, 0.0, 0.08)),
    "down from the second of three points": ([0.0, 0.3, 0.42], [0.08, 0.08, 0.0]),
    "up to the second of three points": ([0.0, 0.46, 1.67], [-0.05, 0.0, 0.0]),
    "a plateau of four points": ([0.0, 2.3, 6.7, 8.4], [-0.05, 0.08, 0.08, 0.0]),
    "up and down": ([0.0, 3.0, 3.02, 5.0, 5.02, 30.0], [0.0, 0.0, 0.08, 0.08, -0.02, -0.02]),
}


@pytest.mark.parametrize("name", KERBS)
def test_no_road_leaves_the_heights_of_its_points(tmp_path, name):
    """A cubic spline through the first swings from -2.4 to 2.4 m, the second to 119 m."""
    x, z = map(np.asarray, KERBS[name])
    road = ProfileRoad(file=str(written(tmp_path, x, z)))
    fine = [np.linspace(a, b, 400) for a, b in pairwise([-1.0, *x, x[-1] + 1.0])]
    places = np.unique(np.concatenate(fine))
    heights = np.array(road.height(places, 0.0))
    assert heights.min() >= z.min() - 1e-9
    assert heights.max() <= z.max() + 1e-9
    assert np.interp(x, places, heights) == pytest.approx(z, abs=1e-6)
    # The slope is continuous, as the search for the contact point needs it.
    slopes = np.array(road.gradient(places, 0.0)[0])
    risen = np.cumsum(0.5 * (slopes[1:] + slopes[:-1]) * np.diff(places)) + heights[0]
    assert risen == pytest.approx(heights[1:], abs=1e-4)
    step = min(np.diff(x)) * 1e-6
    for place in x:
        before, after = (float(road.gradient(place + s, 0.0)[0]) for s in (-step, step))
        assert before == pytest.approx(after, abs=1e-4 * np.abs(slopes).max())


def test_few_points_resolve_no_hill_between_them():
    """Two to five points reached half of their range beyond them."""
    for seed in range(200):
        rng = np.random.default_rng(seed)
        count = int(rng.integers(2, 6))
        x = np.cumsum(rng.uniform(1.0, 2.9, count))
        z = rng.choice([0.0, 0.08, -0.05, 0.3], count)
        assert excess(x, z, level_slopes(x, z)).max() <= 1e-12


def test_random_heights_keep_their_extremes_where_steps_are(tmp_path):
    """Whatever the heights: no interval leaves its points farther than their bend explains."""
    for seed in range(20):
        rng = np.random.default_rng(seed)
        x = np.cumsum(rng.choice([0.01, 0.1, 1.0, 5.0], 30))
        z = np.repeat(rng.choice([0.0, 0.08, -0.05], 15), 2)
        slopes = level_slopes(x, z)
        inside = excess(x, z, slopes)
        assert inside.max() <= 1e-12
        steep = 3.0 * np.maximum(*(np.abs(np.pad(np.diff(z) / np.diff(x), side))
                                   for side in ((1, 0), (0, 1))))  # fmt: skip
        assert (np.abs(slopes) <= steep + 1e-12).all()


def text_of_scenario():
    return f"""\
title: A small car on a road from a file
model: {ROOT / "systems" / "small_car.yaml"}
tyres: {{kind: magic_formula_1987}}
road: {{kind: profile, file: road.csv}}
wheel_spin: free
speed: 50 km/h
manoeuvre: {{kind: straight}}
duration: 1 s
solver: {{kind: rk4, step: 1 ms}}
output: {{interval: 20 ms}}
"""


def test_wheels_run_over_it_and_its_content_counts(tmp_path):
    """Wheels are carried at the height of the file; another content is another run, one code."""
    scenario = tmp_path / "scenario.yaml"
    scenario.write_text(text_of_scenario())
    x = np.linspace(-5.0, 5.0, 101)
    keys, texts, heights = [], [], []
    for size in (0.0, 0.01):
        written(tmp_path, x, np.full(x.size, size))
        loaded = load_scenario(scenario)
        prepared = prepare(loaded, backend="interpreted", progress=lambda *_: None)
        keys.append(key_of_run(loaded))
        texts.append(fingerprint(prepared.equations))
        point = start_point(prepared, 0.0, "static")
        found = prepared.kernel.outputs(0.0, point.state, point.unknowns)
        names = [c.name for c in prepared.equations.channels]
        heights.append(found[names.index("chassis.z")])
        assert [table.name for table in prepared.equations.tables] == ["road profile"]
    assert keys[0] is None or keys[0] != keys[1]
    assert texts[0] == texts[1]
    assert heights[1] - heights[0] == pytest.approx(0.01, abs=1e-9)
