"""OpenCRG roads: reading, borders, the way to the world and back, and bad files."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from crg_files import crg
from scipy.interpolate import RegularGridInterpolator

from vehicledyn.base.errors import InputError
from vehicledyn.road.opencrg.ground import CrgGround
from vehicledyn.road.opencrg.modifiers import AT_REFERENCE_LINE
from vehicledyn.road.opencrg.road import Border, Borders, CrgRoad
from vehicledyn.symbolic import ops

REFERENCE = Path(__file__).parents[4] / "shared" / "reference" / "road" / "roads"
HEIGHTS = np.round(0.05 * np.sin(np.arange(84.0) ** 1.3), 6).reshape(12, 7)
PHI = 0.02 * np.arange(12.0)
BANK = np.round(0.01 * np.arange(12.0), 4)
SLOPE = np.full(12, 0.03)


def written(tmp_path, content, name="road.crg"):
    path = tmp_path / name
    path.write_bytes(content)
    return path


def road(tmp_path, heights=HEIGHTS, *, modifiers=None, **given):
    return CrgRoad.read(written(tmp_path, crg(heights, **given)), modifiers=modifiers or {})


@pytest.mark.parametrize("code", ["LRFI", "LDFI", "KRBI", "KDBI"])
@pytest.mark.parametrize("ending", ["\n", "\r\n"])
def test_heights_are_bilinear_in_every_format(tmp_path, code, ending):
    got = road(tmp_path, code=code, ending=ending)
    exact = RegularGridInterpolator(
        (np.arange(12.0), -1.5 + 0.5 * np.arange(7)), HEIGHTS.astype(np.float32).astype(float)
    )
    places = np.random.default_rng(3).uniform((0.0, -1.5), (11.0, 1.5), (50, 2))
    tolerance = 1e-12 if code != "LRFI" else 1e-7
    assert got.height(*places.T) == pytest.approx(exact(places), abs=tolerance)


def test_the_mark_of_an_editor_at_the_begin_has_no_effect(tmp_path):
    content = crg(HEIGHTS, code="LRFI")
    plain, marked = (
        CrgRoad.read(written(tmp_path, mark + content), modifiers={})
        for mark in (b"", b"\xef\xbb\xbf")
    )
    assert marked.height(3.3, 0.2) == plain.height(3.3, 0.2)


def test_slope_and_bank_lift_the_grid(tmp_path):
    got = road(tmp_path, np.zeros((12, 7)), slope=SLOPE, bank=BANK)
    u, v = np.array([0.0, 2.5, 7.25]), np.array([1.0, -1.2, 0.5])
    assert got.height(u, v) == pytest.approx(0.03 * u + 0.01 * u * v, abs=1e-12)


def test_places_in_the_world_lead_back(tmp_path):
    got = road(tmp_path, phi=PHI)
    u, v = np.random.default_rng(5).uniform((-3.0, -1.5), (14.0, 1.5), (200, 2)).T
    back = got.road_place(*got.place(u, v))
    assert np.array(back) == pytest.approx(np.array([u, v]), abs=1e-12)


def test_a_circle_has_its_heading_and_curvature(tmp_path):
    count, radius = 201, 25.0
    phi = (np.arange(count) - 0.5) * 0.1 / radius
    got = road(tmp_path, np.zeros((count, 7)), phi=phi, step=0.1)
    heading, curvature = got.heading_and_curvature(np.array([10.0, 10.0]), np.array([0.0, 2.0]))
    assert heading == pytest.approx(phi[100], abs=1e-12)
    assert 1.0 / curvature == pytest.approx([radius, radius - 2.0], rel=2e-4)


def test_a_road_shorter_than_the_pieces_of_its_curvature_is_straight(tmp_path):
    got = road(tmp_path, phi=PHI, step=0.005)
    heading, curvature = got.heading_and_curvature(np.array([0.0, 0.03, 0.05]), np.zeros(3))
    assert curvature.tolist() == [0.0] * 3
    assert np.isfinite(heading).all()


@pytest.mark.parametrize(
    ("border", "u", "v", "as_at"),
    [
        ("KEEP", 13.0, 0.3, (11.0, 0.3)),
        ("KEEP", 4.0, -9.0, (4.0, -1.5)),
        ("REPEAT", 13.0, 0.3, (2.0, 0.3)),
        ("REPEAT", -1.0, 2.0, (10.0, -1.0)),
        ("REFLECT", 13.0, 0.3, (9.0, 0.3)),
        ("REFLECT", -1.0, 2.0, (1.0, 1.0)),
    ],
)
def test_borders_go_on_as_they_say(tmp_path, border, u, v, as_at):
    got = road(tmp_path)
    beyond = replace(got, borders=Borders(Border[border], Border[border]))
    assert beyond.height(u, v) == pytest.approx(got.height(*as_at), abs=1e-12)


def test_a_border_may_be_zero_or_nothing(tmp_path):
    got = road(tmp_path, slope=SLOPE)
    zero = replace(got, borders=Borders(Border.ZERO, Border.ZERO, 0.25, 0.5))
    assert zero.height([20.0, 3.0, 20.0], [0.0, 5.0, 5.0]) == pytest.approx([0.25, 0.5, 0.75])
    nothing = replace(got, borders=Borders(Border.NONE, Border.NONE))
    assert np.isnan(nothing.height([20.0, 3.0], [0.0, 5.0])).all()


def test_gaps_are_filled_from_the_middle(tmp_path):
    heights = HEIGHTS.copy()
    heights[3, :2] = heights[3, 5:] = np.nan
    got = road(tmp_path, heights, modifiers={"grid_nan_mode": 2.0})
    assert got.height(3.0, -1.5) == pytest.approx(got.height(3.0, -0.5))
    assert got.height(3.0, 1.5) == pytest.approx(got.height(3.0, 0.5))
    assert np.isnan(road(tmp_path, heights).height(3.0, -1.5))


def test_modifiers_scale_and_move(tmp_path):
    modifiers = {"scale_z_grid": 2.0, "scale_length": 0.5, "scale_width": 2.0}
    plain, got = road(tmp_path), road(tmp_path, modifiers=modifiers)
    assert got.height(2.0, 1.0) == pytest.approx(2.0 * plain.height(4.0, 0.5), abs=1e-7)
    at = {"refpoint_u": 4.0, "refpoint_v": 0.5, "refpoint_x": 7.0, "refpoint_z": 1.0}
    moved = road(tmp_path, phi=PHI, modifiers={**at, "refpoint_phi": 0.3})
    assert np.array(moved.place(4.0, 0.5)) == pytest.approx([7.0, 0.0], abs=1e-12)
    assert moved.height(4.0, 0.5) == pytest.approx(1.0, abs=1e-12)
    assert moved.heading_and_curvature(4.0, 0.5)[0] == pytest.approx(0.3, abs=1e-12)


@pytest.mark.parametrize("smooth", [True, False])
@pytest.mark.parametrize("places", [None, np.array([-1.5, -1.25, -1.0, 0.0, 0.3, 1.0, 1.5])])
def test_ground_of_expressions_is_that_of_the_road(tmp_path, smooth, places):
    """A fine line, so that its smoothing is below the tolerance; heights at cross sections."""
    phi = 0.002 * np.arange(12.0)
    got = road(tmp_path, phi=phi, bank=BANK, slope=SLOPE, places=places, step=0.1)
    ground, (x, y) = CrgGround(got, smooth), (ops.symbol("x"), ops.symbol("y"))
    expression = ops.column([ground.height(x, y)])
    value = ops.numeric([x, y], expression)
    slope = ops.numeric([x, y], ops.column(list(ground.gradient(x, y))))
    change = ops.numeric([x, y], ops.jacobian(expression, ops.column([x, y])).T)
    for row, side in ((1, -1.1), (4, 0.2), (9, 1.3)):
        at = [float(p) for p in got.place(0.1 * row, side)]
        assert value(*at)[0, 0] == pytest.approx(float(got.height_at(*at)), abs=2e-5)
        assert value(*at)[0, 0] == pytest.approx(float(ground.height(*at)), abs=1e-14)
        beside = [at[0] + 0.03, at[1]]
        assert slope(*beside) == pytest.approx(change(*beside), abs=1e-12)


def test_the_world_begins_at_the_reference_line(tmp_path):
    path = written(tmp_path, crg(HEIGHTS, phi=PHI + 0.7, slope=SLOPE))
    got = CrgRoad.read(path, move=AT_REFERENCE_LINE)
    assert np.array(got.place(0.0, 0.0)) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert float(got.height(0.0, 0.0)) == pytest.approx(0.0, abs=1e-9)


BAD = {
    "no text": (b"\x00\x01\x02" * 100, ":1:1: this is no text"),
    "no header": (b"hello\n", "no channels are defined"),
    "zero increment": (crg(HEIGHTS, step=1.0).replace(b"= 1.0 !", b"= 0.0 !"), "must be at least"),
    "doubled": (crg(HEIGHTS, extra="long_section_v_left = 2\n"), "set before, in line 10"),
    "unknown": (crg(HEIGHTS, extra="reference_lime_end_x = 2\n"), ":12:1: reference_lime_end_x"),
    "no number": (crg(HEIGHTS, extra="reference_line_end_z = two\n"), "'two' is no number"),
    "cut short": (crg(HEIGHTS, code="KDBI")[:-400], "12 cross sections are announced"),
    "cut line": (crg(HEIGHTS, slope=SLOPE, bank=BANK)[:-11], "the last cross section has 1"),
    "letters": (crg(HEIGHTS).replace(b"0.042074", b"0.04x074"), "is no number"),
    "no heading": (crg(HEIGHTS, phi=[*PHI[:5], np.nan, *PHI[6:]]), "no number in cross section 6"),
    "format": (crg(HEIGHTS).replace(b"LRFI", b"LXXI"), "unknown data format"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_files_are_refused_with_line(tmp_path, case):
    content, words = BAD[case]
    path = written(tmp_path, content)
    with pytest.raises(InputError, match=words) as found:
        CrgRoad.read(path)
    assert "road.crg" in str(found.value)


@pytest.mark.skipif(not REFERENCE.is_dir(), reason="the reference data are not there")
@pytest.mark.parametrize(
    ("table", "modifiers"), [("no_modifiers", {}), ("default_modifiers", None)]
)
def test_numbers_are_those_of_the_reference_library(table, modifiers):
    with (REFERENCE / f"opencrg_c_api_{table}.csv").open() as file:
        rows = list(csv.DictReader(file))
    roads = {r["file"]: CrgRoad.read(REFERENCE / r["file"], modifiers=modifiers) for r in rows}
    for row in rows:
        got = replace(roads[row["file"]], borders=_borders(row["mode"]))
        u, v, x, y = (float(row[name]) for name in ("u", "v", "x", "y"))
        assert np.array(got.place(u, v)) == pytest.approx([x, y], abs=1e-9)
        back = [float(row["u_back"]), float(row["v_back"])]
        assert np.array(got.road_place(x, y)) == pytest.approx(back, abs=1e-9)
        z = float(row["z_uv"]) if row["ok_uv2z"] == "1" else float("nan")
        assert float(got.height(u, v)) == pytest.approx(z, abs=1e-9, nan_ok=True)
        turn = [float(row["phi"]), float(row["curvature"])]
        found = [float(n) for n in got.heading_and_curvature(u, v)]
        assert found == pytest.approx(turn, abs=1e-9)


def _borders(mode):
    if mode.startswith("border_"):
        border = Border[mode.removeprefix("border_").upper()]
        return Borders(border, border)
    if mode.startswith("smooth"):
        zone = float(mode.rpartition("_")[2])
        return Borders(smooth_start=zone, smooth_end=zone)
    return Borders(offset_u=0.05, offset_v=-0.02) if mode.startswith("keep") else Borders()


def test_missing_heights_may_be_signalling_nan(tmp_path):
    """A NaN without its quiet bit, as other makers' arithmetic leaves them."""
    heights = HEIGHTS.copy()
    heights[3, 2] = np.nan
    content = crg(heights, code="KRBI")
    quiet, signalling = (bytes.fromhex(text) for text in ("7fc00000", "7f800001"))
    assert quiet in content
    path = written(tmp_path, content.replace(quiet, signalling))
    assert np.isnan(CrgRoad.read(path, modifiers={}).height(3.0, -0.5))


def test_places_beside_the_grid_are_known(tmp_path):
    found = road(tmp_path)
    inside, stop, left = found.line.start + 0.5, found.line.stop, found.edges[1]
    u = np.array([inside, stop + 0.1, found.line.start - 0.1, inside])
    x, y = found.place(u, np.array([0.0, 0.0, 0.0, left + 0.1]))
    assert found.covers(x, y).tolist() == [True, False, False, False]
