"""Ground from files that is too steep for one point of contact is reported with its place."""

import numpy as np
import pytest
from manoeuvre_examples import written

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.simulation.steep_roads import steep_roads
from vehicledyn.files.scenario import load_scenario
from vehicledyn.road.surfaces.heightfield import Heightfield
from vehicledyn.road.surfaces.profile import ProfileRoad


def said(tmp_path, points, **changes):
    rows = "\n".join(f"{x},{z}" for x, z in points)
    (tmp_path / "road.csv").write_text(f"x [m], z [mm]\n{rows}\n")
    road = "{kind: profile, file: road.csv, start: 3 m}"
    (tmp_path / "run.yaml").write_text(written(ROAD=road, **changes))
    return steep_roads(load_scenario(tmp_path / "run.yaml", ()))


def test_a_kerb_is_reported_with_its_place(tmp_path):
    (line,) = said(tmp_path, [(0, 0), (10, 0), (10.01, 80), (200, 80)])
    assert "at x = 13.0" in line
    assert "kind: obstacles" in line


def test_a_climb_of_sixty_percent_is_not(tmp_path):
    assert said(tmp_path, [(k, 600 * k) for k in range(10)]) == []


def test_roads_without_a_file_are_not(tmp_path):
    (tmp_path / "run.yaml").write_text(written())
    assert steep_roads(load_scenario(tmp_path / "run.yaml", ())) == []


def test_the_steepest_place_of_a_cosine(tmp_path):
    x = np.linspace(0.0, 4.0 * np.pi, 401)
    rows = "\n".join(f"{a:.9f},{np.cos(a):.9f}" for a in x)
    (tmp_path / "wave.csv").write_text(f"x [m], z [m]\n{rows}\n")
    place = ProfileRoad(file=str(tmp_path / "wave.csv")).steepest()
    assert place.slope == pytest.approx(1.0, rel=1e-4)
    assert abs(np.sin(place.x)) == pytest.approx(1.0, abs=1e-3)


def test_the_steepest_place_of_a_heightfield(tmp_path):
    """A step of 3 m between the second and the third node of the third line along y."""
    head = "ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 2\n"
    (tmp_path / "a.asc").write_text(f"{head}0 0 0 0\n0 0 0 0\n0 0 3 3\n")
    place = Heightfield(file=str(tmp_path / "a.asc"), scale=0.5, x=100.0).steepest()
    assert place.slope == pytest.approx(0.75)
    assert place.x == pytest.approx(100.0 + 1.5 * 2.0, abs=1.01)
