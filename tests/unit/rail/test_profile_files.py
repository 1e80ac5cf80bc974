"""Profiles from files: formats, directions, units, smoothing, and what is refused."""

import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.rail.profiles.named_profiles import named_profile
from vehicledyn.rail.profiles.open_profile import open_profile, read_profile
from vehicledyn.rail.profiles.smoothing import smoothed

WHEEL, RAIL = named_profile("S1002", "wheel"), named_profile("60E1", "rail")
PLACES = np.arange(-0.068, 0.0581, 2.5e-4)
TREAD = np.linspace(-0.037, 0.05, 400)


def points(factor=1e3, flip_y=False, flip_z=False, reverse=False, shift=0.0):
    y, z = PLACES * factor, WHEEL.height(PLACES) * factor + shift
    pairs = [(-a if flip_y else a, -b if flip_z else b) for a, b in zip(y, z, strict=True)]
    return pairs[::-1] if reverse else pairs


def written(tmp_path, text, name="wheel.txt"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def lines(pairs, separator=" "):
    return "".join(f"{y!r}{separator}{z!r}\n" for y, z in ((float(a), float(b)) for a, b in pairs))


def is_s1002(profile):
    assert profile.height(TREAD) == pytest.approx(WHEEL.height(TREAD), abs=1e-6)
    return profile.notes


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({}, "lengths in mm, assumed"),
        ({"flip_y": True}, "y turned"),
        ({"flip_z": True}, "z turned"),
        ({"reverse": True}, "direction of falling y"),
        ({"flip_y": True, "flip_z": True, "reverse": True, "shift": 3.0}, "z shifted by"),
    ],
)
def test_direction_is_found_and_told(tmp_path, changes, told):
    notes = is_s1002(read_profile(written(tmp_path, lines(points(**changes))), "wheel"))
    assert any(told in note for note in notes), notes


@pytest.mark.parametrize(
    ("head", "factor", "separator", "unit"),
    [
        ("y_mm,z_mm\n", 1e3, ",", "mm"),
        ("y [m];z [m]\n", 1.0, ";", "m"),
        ("# measured in 2020\n# unit: cm\n", 1e2, "\t", "cm"),
        ("# numbers in metres are not meant\n", 1e3, " ", "mm, assumed"),
        ("y_inch,z_inch\n", 1.0 / 0.0254, ",", "inch"),
    ],
)
def test_columns_with_units(tmp_path, head, factor, separator, unit):
    text = head + lines(points(factor), separator)
    notes = is_s1002(read_profile(written(tmp_path, text, "wheel.csv"), "wheel"))
    assert f"lengths in {unit}" in notes


def with_commas(pairs, separator):
    return lines(pairs).replace(" ", separator).replace(".", ",")


@pytest.mark.parametrize("separator", [";", "; ", "\t", "  "])
def test_commas_mark_decimals(tmp_path, separator):
    """Where something else parts the columns; a number may be whole, one begin with the comma."""
    text = "y [mm]; z [mm]\n" + with_commas(points(), separator).replace(
        ",0" + separator, separator
    )
    assert f"\n-68{separator}" in text
    notes = is_s1002(read_profile(written(tmp_path, text, "wheel.csv"), "wheel"))
    assert "commas mark decimals" in notes


@pytest.mark.parametrize(
    "text",
    [
        "".join(f"{y:.3f}, {z:.3f}, 3\n" for y, z in points()),
        "p = [\n" + "".join(f"{y:.4f}, {z:.4f};\n" for y, z in points()) + "];\n",
        "y_um,z_um,n\n" + "".join(f"{1e3 * y:.0f},{1e3 * z:.0f},1\n" for y, z in points()),
    ],
)
def test_commas_part_columns(tmp_path, text):
    profile = read_profile(written(tmp_path, text), "wheel")
    assert profile.height(TREAD) == pytest.approx(WHEEL.height(TREAD), abs=1e-6)
    assert "commas mark decimals" not in profile.notes


@pytest.mark.parametrize(
    ("text", "told", "line"),
    [
        (with_commas(points(), ","), "commas may part columns or mark decimals here", 1),
        (with_commas(points(), ", "), "commas may part columns or mark decimals here", 1),
        (
            lines(points()) + with_commas(points(), ";"),
            "commas and points both mark decimals",
            len(PLACES) + 1,
        ),
        ("-1.068,25;18,35\n" + with_commas(points(), ";"), "commas and points both mark", 1),
    ],
)
def test_commas_that_mean_two_things(tmp_path, text, told, line):
    assert refused(tmp_path, text, told) == line


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_encodings(tmp_path, encoding):
    """No point is lost to a byte order mark, no unit to the letters of Windows."""
    path = tmp_path / "wheel.csv"
    head = "" if encoding == "utf-8-sig" else "y_µm;z_µm\n"
    path.write_bytes((head + lines(points(1e6 if head else 1e3), ";")).encode(encoding))
    profile = read_profile(path, "wheel")
    assert profile.height(TREAD) == pytest.approx(WHEEL.height(TREAD), abs=1e-6)
    assert profile.begin == pytest.approx(-0.068, abs=1e-9)


def test_exchanged_columns(tmp_path):
    pairs = [(z, y) for y, z in points()]
    told = "are the columns exchanged? y comes first, then z"
    assert refused(tmp_path, lines(pairs), told) == 1


def test_exchanged_wheel_and_rail(tmp_path):
    y = np.arange(-0.0355, 0.03551, 2.5e-4)
    rail = lines(1e3 * np.column_stack([y, RAIL.height(y)]))
    assert refused(tmp_path, rail, "a wheel's profile is needed") == 1
    assert refused(tmp_path, lines(points()), "as the flange of a wheel", kind="rail") == 1
    text = simpack(points())
    told = "here a wheel's is needed; are wheel and rail exch"
    line = refused(tmp_path, text, told, "wheel.prr")
    assert text.splitlines()[line - 1].startswith("-68.0 ")


@pytest.mark.parametrize("ahead", [20.0, 40.0, 60.0])
@pytest.mark.parametrize("flip", [{}, {"flip_y": True}, {"flip_z": True}])
def test_wheel_in_the_place_of_a_rail_wherever_its_zero_is(tmp_path, ahead, flip):
    """Its rim may lie in the middle, where a rail is highest."""
    side = -1.0 if "flip_y" in flip else 1.0
    pairs = [(y + side * ahead, z) for y, z in points(**flip)]
    told = "as the flange of a wheel; a rail's profile"
    assert refused(tmp_path, lines(pairs), told, kind="rail") == 1


@pytest.mark.parametrize("deep", [9e-3, 0.02, 0.03])
def test_rails_with_sides_of_any_depth_have_no_flange(tmp_path, deep):
    """Measured rails reach down the gauge side further than down the other."""
    y = np.arange(-0.0355, 0.03551, 2.5e-4)
    head = np.column_stack([y, RAIL.height(y)])
    side = head[0] - np.outer(np.arange(1e-3, deep, 1e-3), [0.05, 1.0])
    rail = np.vstack([side[::-1], head[y < 0.025]])
    profile = read_profile(written(tmp_path, lines(1e3 * rail), "rail.txt"), "rail")
    assert profile.height(np.array(0.0)) == pytest.approx(0.0, abs=2e-5)


def simpack(pairs, **settings):
    head = "".join(
        f"  {key.replace('_', '.')} = {value} ! told\n" for key, value in settings.items()
    )
    return (
        "header.begin\n version = 1\n type = 1\nheader.end\nspline.begin\n"
        f" comment = 'a wheel'\n{head} point.begin\n ! y z weight\n"
        + "".join(f"{y!r} {z!r} 1.0\n" for y, z in ((float(a), float(b)) for a, b in pairs))
        + " point.end\nspline.end\n"
    )


@pytest.mark.parametrize(
    ("factor", "settings", "shift"),
    [
        (1e3, {}, 0.0),
        (1.0, {"units_len_f": "1.0"}, 0.0),
        (1e3, {"units_len_f": "1000.", "shift_z": "-2.5"}, 2.5),
        (1e3, {"mirror_y": 1, "mirror_z": 1}, 0.0),
    ],
)
def test_simpack(tmp_path, factor, settings, shift):
    pairs = points(factor, shift=shift)
    path = written(tmp_path, simpack(pairs, **settings), "wheel.prw")
    notes = is_s1002(read_profile(path, "wheel"))
    assert notes[0] == "Simpack profile"
    assert not any("z shifted" in note for note in notes)


def test_simpack_mirrors(tmp_path):
    """A file that says how it is mirrored needs no guess."""
    path = written(
        tmp_path, simpack(points(flip_y=True, flip_z=True), mirror_y=1, mirror_z=1), "wheel.prw"
    )
    notes = is_s1002(read_profile(path, "wheel"))
    assert not any("turned" in note for note in notes), notes
    assert "y mirrored, as the file says" in notes


def test_simpack_bounds(tmp_path):
    """In order they cut; Simpack writes them out of order where there are none."""
    text = simpack(points(), bound_y_min=-60, bound_y_max=55.1, bound_z_min=1, bound_z_max=0)
    profile = read_profile(written(tmp_path, text, "wheel.prw"), "wheel")
    assert (profile.begin, profile.end) == pytest.approx((-0.06, 0.055), abs=1e-9)
    assert "44 points beyond the file's bounds of y left out" in profile.notes
    text = simpack(points(), bound_z_min=-5, bound_z_max=20)
    line = refused(tmp_path, text, "bound.z: this point lies beyond", "wheel.prw")
    assert text.splitlines()[line - 1].startswith("-67.0 20.196")


def test_miniprof_offsets(tmp_path):
    rows = "".join(f"{y + 3.0} {z - 2.0}\n" for y, z in points())
    text = "ColumnDef=X,Y\nXOffset=-3\nYOffset=2.0\n\n" + rows
    notes = is_s1002(read_profile(written(tmp_path, text, "w.whl"), "wheel"))
    assert "XOffset and YOffset of the file added" in notes
    assert not any("z shifted" in note for note in notes)
    refused(tmp_path, text.replace("=-3", "=a"), "xoffset: 'a' is not a number", "w.whl")


def test_miniprof(tmp_path):
    head = 'FileName=x.whl\n"Date=01-01-2020"\nColumnDef=N,X,Y,A\nXYPOINTS=505\n\n'
    rows = "".join(
        f"{k} {y!r} {z!r} 0.0\n" for k, (y, z) in enumerate(map(tuple, np.array(points()).tolist()))
    )
    notes = is_s1002(read_profile(written(tmp_path, head + rows, "w.whl"), "wheel"))
    assert notes[0] == "MiniProf profile"


def test_under_the_head_of_a_rail_is_cut_off(tmp_path):
    y = np.arange(-0.0365, 0.03651, 2.5e-4)
    head = np.column_stack([y, RAIL.height(y)])
    under = head[-1] + np.column_stack(
        [-np.linspace(0.5e-3, 0.01, 20), -np.linspace(1e-3, 5e-3, 20)]
    )
    path = written(tmp_path, lines(1e3 * np.vstack([head, under])), "rail.txt")
    profile = read_profile(path, "rail")
    assert any(note.startswith("20 points cut off") for note in profile.notes)
    crown = np.linspace(-0.035, 0.035, 301)
    assert profile.height(crown) == pytest.approx(RAIL.height(crown), abs=2e-6)


def test_upright_back_of_a_flange_is_cut_off(tmp_path):
    pairs = points()
    y, z = pairs[0]
    back = [(y, z - height) for height in (15.0, 10.0, 5.0)]
    notes = is_s1002(read_profile(written(tmp_path, lines([*back, *pairs])), "wheel"))
    assert any(note.startswith("3 points cut off") for note in notes)


def test_curvature_through_exact_points():
    """The error of interpolated curvature falls with the spacing."""
    y = np.linspace(-0.009, 0.009, 37)
    curve = smoothed(y, RAIL.height(y), 0.0)
    inner = np.linspace(-0.005, 0.005, 101)
    _, slope, bend = curve.table.values(inner)
    assert bend / (1.0 + slope**2) ** 1.5 == pytest.approx(-1.0 / 0.3, rel=2e-3)
    assert curve.largest < 1e-12


def test_smoothing_removes_noise_and_reports_what_it_moved():
    """Noise of 5 µm each 0.25 mm leaves the curvature that the docstring says, times three."""
    noise, spacing, wavelength = 5e-6, 2.5e-4, 12e-3
    y = np.arange(-0.026, 0.0261, spacing)
    z = 0.08 * (np.sqrt(1.0 - (y / 0.08) ** 2) - 1.0)
    rough = z + np.random.default_rng(1).normal(0.0, noise, len(y))
    curve = smoothed(y, rough, wavelength)
    inner = np.linspace(-0.012, 0.012, 301)
    _, slope, bend = curve.table.values(inner)
    bound = 3.0 * noise * np.sqrt(spacing / wavelength) * (2.0 * np.pi / wavelength) ** 2
    assert np.abs(bend / (1.0 + slope**2) ** 1.5 + 12.5).max() < bound < 1.0
    raw = smoothed(y, rough, 0.0).table.values(inner)[2]
    assert np.abs(raw + 12.5).max() > 100.0


def test_deviation_is_the_noise(tmp_path):
    y = np.arange(-0.05, 0.05, 2.5e-4)
    rough = 0.3 * y + np.random.default_rng(2).normal(0.0, 5e-6, len(y))
    curve = smoothed(y, rough, 12e-3)
    across = 5e-6 / np.hypot(1.0, 0.3)
    assert curve.rms == pytest.approx(across, rel=0.15)
    assert 2.0 * across < curve.largest < 5.0 * across


def test_half_of_a_wave_is_left():
    y = np.linspace(-0.05, 0.05, 2001)
    curve = smoothed(y, 1e-6 * np.cos(2.0 * np.pi * y / 5e-3), 5e-3)
    assert curve.table.height(np.array(0.0)) == pytest.approx(0.5e-6, rel=1e-3)


def refused(tmp_path, text, told, name="bad.csv", kind="wheel"):
    path = written(tmp_path, text, name)
    with pytest.raises(InputError) as caught:
        open_profile(str(path), kind)
    message = str(caught.value)
    assert message.startswith(f"{path}:"), message
    assert told in message, message
    return int(message.split(":")[1])


def test_metres_for_millimetres(tmp_path):
    told = "are the lengths in m? Then say so: '# unit: m'"
    assert refused(tmp_path, lines(points(1.0)), told) == 1
    path = written(tmp_path, "# unit: m\n" + lines(points(1.0)))
    assert "lengths in m" in is_s1002(read_profile(path, "wheel"))


def test_millimetres_for_metres(tmp_path):
    text = "y_m z_m\n" + lines(points())
    assert refused(tmp_path, text, "read in m; are the lengths in mm?") == 2


def test_too_few_points(tmp_path):
    few = points()[::80]
    assert refused(tmp_path, lines(few), f"{len(few)} points are too few") == len(few)


def test_too_many_points(tmp_path):
    places = np.linspace(-50.0, 50.0, 20_001)
    line = refused(tmp_path, lines(zip(places, 0.0 * places, strict=True)), "points are too many")
    assert line == 20_001


def test_doubled_point(tmp_path):
    pairs = points()
    line = refused(tmp_path, lines([*pairs[:100], *pairs[99:]]), "same as that of line 100")
    assert line == 101


def test_unsorted_points(tmp_path):
    pairs = points()
    pairs[300], pairs[301] = pairs[301], pairs[300]
    line = refused(tmp_path, lines(pairs), "unsorted: y goes back")
    assert line == 302


def test_unsorted_points_among_noise(tmp_path):
    """The longest step back is named, not one that noise makes."""
    pairs = points()
    pairs[300], pairs[301] = pairs[301], pairs[300]
    pairs[261] = (pairs[260][0] - 0.01, pairs[261][1])
    assert refused(tmp_path, lines(pairs), "unsorted: y goes back") == 302


def test_loop(tmp_path):
    pairs = points()
    y, z = pairs[300]
    loop = [(y + 1.5, z), (y + 1.5, z + 3.0), (y + 0.5, z + 3.0), (y + 0.5, z - 2.0)]
    text = lines([*pairs[:300], *loop, *pairs[310:]])
    assert refused(tmp_path, text, "an outlier in line") in range(301, 305)
    angles = np.linspace(0.1, 2.0 * np.pi - 0.1, 90)
    loop = [(y + 3.0 * np.sin(a), z + 3.0 * (1.0 - np.cos(a))) for a in angles]
    refused(tmp_path, lines([*pairs[:301], *loop, *pairs[302:]]), "crosses itself: a loop")


@pytest.mark.parametrize(
    ("text", "told", "line"),
    [
        ("1 2\n3 x\n", "'x' is not a number", 2),
        ("1 2\n3\n", "needs two numbers", 2),
        ("1 2\n3 nan\n", "no usable length", 2),
        ("# nothing\n", "no points found", 1),
        ("", "no points found", 1),
    ],
)
def test_wrong_lines(tmp_path, text, told, line):
    assert refused(tmp_path, text, told) == line


def test_tape_circle_outside(tmp_path):
    pairs = [(y + 200.0, z) for y, z in points()]
    told = "y runs from 132 to 258 mm; y = 0 must be the tape circle"
    assert refused(tmp_path, lines(pairs), told) == 1


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({"rotate": "0.1"}, "rotate"),
        ({"units_len_f": "0"}, "units.len.f"),
        ({"shift_y": "a"}, "shift.y"),
    ],
)
def test_wrong_simpack(tmp_path, settings, told):
    assert refused(tmp_path, simpack(points(), **settings), told, "wheel.prw") == 1


def test_simpack_without_points(tmp_path):
    told = "between point.begin and point.end"
    assert refused(tmp_path, lines(points()), told, "wheel.prw") == len(PLACES)


def test_missing_and_binary_files(tmp_path):
    with pytest.raises(InputError, match="there is no such file"):
        open_profile(str(tmp_path / "none.csv"), "rail")
    (tmp_path / "b.csv").write_bytes(b"1 2\0\n")
    with pytest.raises(InputError, match="not a text file"):
        open_profile(str(tmp_path / "b.csv"), "rail")
