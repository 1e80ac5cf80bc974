"""Grounds on a square grid: exact for quadratics, smooth, and read from files of two kinds."""

import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.road.ground.ascii_grid import read_ascii_grid
from vehicledyn.road.ground.mesh_grid import grid_of_mesh
from vehicledyn.road.surfaces.heightfield import Heightfield
from vehicledyn.symbolic.grids.bicubic_grid import BicubicGrid

HEAD = "ncols 3\nnrows 2\nxllcorner 1\nyllcorner 2\ncellsize 2\n"


def quadratic(x, y):
    return 0.3 - 0.1 * x + 0.02 * y + 0.05 * x * x - 0.03 * x * y + 0.01 * y * y


def test_quadratics_come_out_exactly():
    x, y = 2.0 + 0.5 * np.arange(9), -1.0 + 0.5 * np.arange(7)
    grid = BicubicGrid("bowl", x[0], y[0], 0.5, quadratic(x[:, None], y[None, :]))
    for place in ((3.1, 0.4), (4.0, 0.25), (2.6, -0.4), (5.3, 1.2)):
        assert grid.value(*place) == pytest.approx(quadratic(*place), abs=1e-13)
        along, across = grid.slopes(*place)
        assert along == pytest.approx(-0.1 + 0.1 * place[0] - 0.03 * place[1], abs=1e-13)
        assert across == pytest.approx(0.02 - 0.03 * place[0] + 0.02 * place[1], abs=1e-13)


def test_slopes_are_continuous_across_nodes_and_the_edge_goes_on():
    heights = np.random.default_rng(4).normal(size=(5, 6))
    grid = BicubicGrid("rough", 0.0, 0.0, 1.0, heights)
    for node in ((2.0, 3.0), (1.0, 4.0), (3.0, 1.0)):
        assert grid.value(*node) == pytest.approx(heights[int(node[0]), int(node[1])], abs=1e-14)
        sides = [
            grid.slopes(node[0] + dx, node[1] + dy)
            for dx, dy in ((1e-9, 1e-9), (-1e-9, 1e-9), (1e-9, -1e-9))
        ]
        assert np.ptp(np.array(sides, dtype=float), axis=0).max() < 1e-7
    assert grid.value(-3.0, 2.0) == pytest.approx(heights[0, 2])
    assert grid.value(9.0, 9.0) == pytest.approx(heights[-1, -1])
    assert tuple(map(float, grid.slopes(-3.0, 9.0))) == (0.0, 0.0)


def test_rows_of_an_ascii_grid_run_from_north_to_south(tmp_path):
    file = tmp_path / "g.asc"
    file.write_text(HEAD + "NODATA_value -1\n1 2 3\n\n4 5 6\n")
    x, y, step, heights = read_ascii_grid(file)
    assert (x, y, step) == (2.0, 3.0, 2.0)
    assert heights.tolist() == [[4.0, 1.0], [5.0, 2.0], [6.0, 3.0]]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1 2 3\n4 5 6\n", "lacks ncols, nrows, cellsize"),
        (HEAD + "1 2 3\n", "1 rows of heights, nrows says 2"),
        (HEAD + "1 2 3\n4 5\n", r"g.asc:7: 2 heights, ncols says 3"),
        (HEAD + "1 2 3\n4 5 x\n", r"g.asc:7: 'x' is not a number"),
        (HEAD + "1 2 3\n4 nan 6\n", r"g.asc:7: no height in column 2"),
        (HEAD + "1 2 3\n4 -1e30 6\n", r"g.asc:7: -1e\+30 m; no road is higher than 1e\+06 m"),
        (HEAD + "nodata_value -9\n1 2 3\n-9 5 6\n", r"g.asc:8: no height in column 1"),
        (HEAD + "1 2 3\n4 5 6\n7 8 9\n", r"g.asc:8: more rows"),
        (HEAD + "ncols 4\n1 2 3\n4 5 6\n", r"g.asc:6: ncols is there twice"),
        (HEAD.replace("cellsize 2", "cellsize 0") + "1 2 3\n4 5 6\n", "cellsize must be positive"),
        (HEAD.replace("nrows 2", "nrows 2e9") + "1 2 3\n4 5 6\n", "nrows must be a whole number"),
        (HEAD.replace("nrows 2", "nrows inf") + "1 2 3\n4 5 6\n", "'inf' is not a finite number"),
        ("\0\0\0", "not a text file"),
    ],
)
def test_wrong_ascii_grids_are_refused_by_line(tmp_path, text, words):
    file = tmp_path / "g.asc"
    file.write_text(text)
    with pytest.raises(InputError, match=words):
        read_ascii_grid(file)


PLATE = "v 0 0 0\nv 4 0 0.4\nv 4 2 0.4\nv 0 2 0\n"


def test_nodes_of_a_mesh_take_the_highest_triangle(tmp_path):
    file = tmp_path / "m.obj"
    file.write_text(PLATE + "v 1 0 1\nv 2 0 1\nv 1 1 1\nf 1/1/1 2/2/1 3 4\nf -3 -2 -1\n")
    x, y, step, heights = grid_of_mesh(file, 1.0)
    assert (x, y, step) == (0.0, 0.0, 1.0)
    ramp = np.outer(0.1 * np.arange(5), np.ones(3))
    ramp[1, 0] = ramp[2, 0] = ramp[1, 1] = 1.0
    assert heights == pytest.approx(ramp, abs=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("v 0 0 0\n", "has no faces"),
        (PLATE + "f 1 2 5\n", r"m.obj:5: there is no vertex 5 yet"),
        (PLATE + "f 1 2\n", r"m.obj:5: a face needs three corners"),
        (PLATE + "f 1 2 b\n", r"m.obj:5: 'b' is no corner"),
        ("v 0 0\n", r"m.obj:1: a vertex needs three numbers"),
        ("v 0 0 nan\n", r"m.obj:1: 'nan' is not a finite number"),
        ("v 0 0 1e30\n", r"m.obj:1: 1e\+30 m; no road is higher"),
        (PLATE + "f 1 2 3\n", "no triangle lies above or below x = 0 m, y = 1 m"),
        (PLATE.replace("v 4", "v 4e9") + "f 1 2 3 4\n", "needs another cell than 1 m"),
    ],
)
def test_wrong_meshes_are_refused(tmp_path, text, words):
    file = tmp_path / "m.obj"
    file.write_text(text)
    with pytest.raises(InputError, match=words):
        grid_of_mesh(file, 1.0)


def test_places_beside_the_data_are_known(tmp_path):
    file = tmp_path / "g.asc"
    file.write_text(HEAD + "1 2 3\n4 5 6\n", encoding="utf-8")
    road = Heightfield(file=str(file), x=10.0)
    x, y, step, heights = read_ascii_grid(file)
    far = 10.0 + x + step * (heights.shape[0] - 1)
    places = np.array([10.0 + x, far, far + 0.01, 10.0 + x - 0.01])
    assert road.covers(places, np.full(4, y)).tolist() == [True, True, False, False]
    assert not road.covers(places, np.full(4, y - 0.01)).any()
