"""Measured profiles: MiniProf files as its programs write them, noise, outliers and gaps.

Files are made from S1002 and 60E1 in the layouts of measured ones, so that the truth is known.
"""

import numpy as np
import pytest

from vehicledyn.analyses.contact.contact_geometry import ContactRequest, find_contact_geometry
from vehicledyn.base.errors import InputError
from vehicledyn.rail.profiles.named_profiles import named_profile
from vehicledyn.rail.profiles.open_profile import read_profile
from vehicledyn.rail.profiles.profile_defects import find_defects
from vehicledyn.rail.profiles.profile_reading import ProfileReading
from vehicledyn.rail.profiles.smoothing import proposed_wavelength, slope_noise, smoothed
from vehicledyn.results.plots.measured_figure import draw_measured
from vehicledyn.results.tables.contact_table import MeasuredProfile

WHEEL, RAIL = named_profile("S1002", "wheel"), named_profile("60E1", "rail")
TREAD = np.linspace(-0.037, 0.05, 400)
MEND = ProfileReading(defects="mend")


def along(profile, spacing):
    """Points of a profile at equal distances along it, as a measuring head gives them [m]."""
    y = np.linspace(profile.begin, profile.end, 20_001)
    z = profile.height(y)
    y, z = y[np.isfinite(z)], z[np.isfinite(z)]
    length = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(y), np.diff(z)))])
    places = np.arange(0.0, length[-1], spacing)
    return np.column_stack([np.interp(places, length, y), np.interp(places, length, z)])


POINTS = {spacing: along(WHEEL, spacing) for spacing in (1e-4, 2.5e-4, 1e-3)}
POINTS_OF_RAIL = {spacing: along(RAIL, spacing) for spacing in (1e-4, 2.5e-4, 1e-3)}


def noisy(points, size, seed=3):
    return points + np.random.default_rng(seed).normal(0.0, size, points.shape)


def rows(points, form="{:.4f} {:.4f}"):
    return "".join(form.format(*(1e3 * p)) + "\n" for p in points)


def written(folder, text, name="wheel.txt"):
    path = folder / name
    path.write_text(text)
    return path


FROM_BACK = POINTS[2.5e-4] + (0.07, 0.0)
HEADER = (
    "ProgramName=MiniProf for Windows\nProgramVer=2.43.73\nDate=08/07/2015\nStock=%Talent\nCarNo=\n"
    'Xoffset={}\nYoffset={}\nTilt=\nRefPoint1=0.0000, 0.0000\n"RefPoint2="\n"ColumnDef=Z,Q"\n'
    "ColumnDef={}\nXYPoints=520\nTemperature=25.0000\nWheelDiameterTaperline={}\nSd=36.1416\n\n"
)


@pytest.mark.parametrize(
    ("columns", "form"),
    [
        ("X,Y", " {:.4f} {:.4f} "),
        ("X,Y,A,C,N", "{:.4f} {:.4f} 0.1"),  # more columns named than there are
        ("X,Y,*", "{:.4f}, {:.4f}, 1, 2, 3"),
    ],
)
@pytest.mark.parametrize("reverse", [False, True])
def test_wheel_counted_from_the_back_of_its_flange(tmp_path, columns, form, reverse):
    """Empty fields say nothing, quoted lines are comments, the header knows the tape circle."""
    points = FROM_BACK[::-1] if reverse else FROM_BACK
    text = HEADER.format("0.0000", "", columns, "70.0000") + rows(points, form)
    profile = read_profile(written(tmp_path, text, "left.whl"), "wheel")
    assert profile.height(TREAD) == pytest.approx(WHEEL.height(TREAD), abs=2e-6)
    assert any("tape circle at 70 mm" in note for note in profile.notes)


@pytest.mark.parametrize("form", ["{:.4f} {:.4f}", "{:.4f}\t{:.4f}\t0.1", "{:.4f}; {:.4f};"])
def test_decimal_commas(tmp_path, form):
    """Windows of some countries writes them, in the header too."""
    text = HEADER.format("0.5", "", "X,Y,A", "70.0 mm") + rows(FROM_BACK - (5e-4, 0.0), form)
    path = written(tmp_path, text.replace(".", ","), "w.whl")
    profile = read_profile(path, "wheel")
    assert profile.height(TREAD) == pytest.approx(WHEEL.height(TREAD), abs=2e-6)
    assert "commas mark decimals" in profile.notes


def test_points_of_a_head_that_stands_still(tmp_path):
    repeated = np.repeat(FROM_BACK, [3, *[1] * 300, 2, *[1] * (len(FROM_BACK) - 302)], axis=0)
    text = HEADER.format("", "", "X,Y", "70") + rows(repeated)
    profile = read_profile(written(tmp_path, text, "w.whl"), "wheel")
    assert profile.height(TREAD) == pytest.approx(WHEEL.height(TREAD), abs=2e-6)
    assert "3 points left out that repeat the one before" in profile.notes


def test_columns_that_are_not_there(tmp_path):
    text = HEADER.format("", "", "A,C,X,Y", "70") + rows(FROM_BACK)
    with pytest.raises(InputError, match=r"w\.whl:18:1: 2 numbers, Y is number 4 of a,c,x,y"):
        read_profile(written(tmp_path, text, "w.whl"), "wheel")


def test_offsets_of_the_header_move_the_points(tmp_path):
    text = HEADER.format("-2.5", "1.0", "X,Y", "70") + rows(np.add(FROM_BACK, (0.0025, -0.001)))
    profile = read_profile(written(tmp_path, text, "w.whl"), "wheel")
    assert profile.height(TREAD) == pytest.approx(WHEEL.height(TREAD), abs=2e-6)


def test_tape_circle_that_no_one_knows(tmp_path):
    """In silence y = 0 would be the back of the flange."""
    path = written(tmp_path, HEADER.format("", "", "X,Y", "") + rows(FROM_BACK), "w.whl")
    with pytest.raises(InputError, match="does not say where the tape circle is"):
        read_profile(path, "wheel")
    profile = read_profile(path, "wheel", ProfileReading(tape_circle=0.07))
    assert profile.height(TREAD) == pytest.approx(WHEEL.height(TREAD), abs=2e-6)


def test_older_layout_with_a_text_as_header(tmp_path):
    head = (
        "#MINIWHEELPROF\nCar1.whl\nMINIPROF 2020\nStock.......:\nWheel ID....:\n"
        '" 32.58 37.11 14.71\n(Sd/Sh/qR)\n\n'
    )
    path = written(tmp_path, head + rows(FROM_BACK, "{:.7f}    {:.7f}"), "w.whl")
    profile = read_profile(path, "wheel", ProfileReading(tape_circle=0.07))
    assert profile.height(TREAD) == pytest.approx(WHEEL.height(TREAD), abs=2e-6)


def test_sections_of_several_parts(tmp_path):
    points = POINTS_OF_RAIL[2.5e-4]
    half = len(points) // 2
    text = (
        "[FileInfo]\nProgramName=MiniProf for Windows\n\n[Profile1Info]\nMPD1=L 27.1 -43.5 27.3\n"
        f"ColumnDef=X,Y\n\n[Profile1Points]\n{rows(points[:half])}\n[Profile2Info]\nDate=\n\n"
        f"[Profile2Points]\n{rows(points[half:])}"
    )
    profile = read_profile(written(tmp_path, text, "r.mpt"), "rail")
    crown = np.linspace(-0.03, 0.03, 301)
    assert profile.height(crown) == pytest.approx(RAIL.height(crown), abs=2e-6)
    assert "2 sections of points joined in their order" in profile.notes


@pytest.mark.parametrize("spacing", [1e-4, 2.5e-4])
def test_noise_that_takes_y_back(tmp_path, spacing):
    """Upright sides go to and fro within some micrometres."""
    side = np.column_stack([np.full(40, -0.07), np.linspace(-0.0, 0.0095, 40)])
    points = noisy(np.vstack([side, POINTS[spacing]]), 1e-5)
    assert (np.diff(points[:, 0]) < 0.0).sum() > 10
    path = written(tmp_path, rows(points))
    profile = read_profile(path, "wheel", ProfileReading(smoothing=4e-3))
    assert profile.height(TREAD) == pytest.approx(WHEEL.height(TREAD), abs=2e-5)
    assert any("y goes back" in note for note in profile.notes)


@pytest.mark.parametrize("kind", ["wheel", "rail"])
@pytest.mark.parametrize("across", [0.0, 1.0])
@pytest.mark.parametrize(("spacing", "size"), [(1e-4, 5e-5), (2.5e-4, 1e-4), (1e-3, 1e-4)])
def test_noise_along_y_is_averaged(tmp_path, kind, across, spacing, size):
    """0.05 mm and more was refused as unsorted, and as outliers where the profile is steep."""
    truth, clean = {"wheel": (WHEEL, POINTS), "rail": (RAIL, POINTS_OF_RAIL)}[kind]
    noise = np.random.default_rng(11).normal(0.0, size, clean[spacing].shape) * (1.0, across)
    path = written(tmp_path, rows(clean[spacing] + noise), f"{kind}.txt")
    profile = read_profile(path, kind, ProfileReading(smoothing=8e-3))
    (note,) = [text for text in profile.notes if "averaged to" in text]
    assert int(note.split()[0]) == len(profile.measured.averaged)
    places = TREAD if kind == "wheel" else np.linspace(-0.03, 0.03, 301)
    assert np.std(profile.height(places) - truth.height(places)) < 0.6 * size
    assert np.diff(profile.measured.points[:, 0]).min() > 0.0


def test_what_noise_leaves_no_curve_of_is_refused_with_a_smoothing_that_does(tmp_path):
    path = written(tmp_path, rows(noisy(POINTS[1e-4], 1e-4)))
    with pytest.raises(InputError, match="or smooth them: smoothing") as refused:
        read_profile(path, "wheel")
    proposed = float(str(refused.value).partition('smoothing "')[2].partition(" mm")[0])
    profile = read_profile(path, "wheel", ProfileReading(smoothing=1e-3 * proposed))
    assert np.std(profile.height(TREAD) - WHEEL.height(TREAD)) < 5e-5


def test_points_that_are_averaged_are_drawn(tmp_path):
    path = written(tmp_path, rows(noisy(POINTS[2.5e-4], 1e-4)))
    made = read_profile(path, "wheel", ProfileReading(smoothing=8e-3)).measured
    parts = (made.points, made.distance, made.outliers, made.bridges, made.averaged)
    figure = draw_measured("Noise", {"left_wheel": MeasuredProfile(*parts)})
    labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert labels == ["points averaged", "points used"]


def test_unsmoothed_noise_is_reported(tmp_path):
    path = written(tmp_path, rows(noisy(POINTS[2.5e-4], 5e-6)))
    notes = read_profile(path, "wheel").notes
    assert any("not smoothed: slopes and curvatures hold the noise" in note for note in notes)
    clean = read_profile(written(tmp_path, rows(POINTS[2.5e-4])), "wheel").notes
    assert not any("not smoothed" in note for note in clean)


@pytest.mark.parametrize("scatter", [2e-5, 5e-5, 1e-4])
def test_noise_has_a_smoothing_proposed_and_its_slopes_reported(tmp_path, scatter):
    """0.02 to 0.1 mm of noise: unsmoothed or smoothed too little, the notes say what would do."""
    points = POINTS[2.5e-4].copy()
    points[:, 1] += np.random.default_rng(4).normal(scale=scatter, size=len(points))
    path = written(tmp_path, rows(points))
    wanted = 1e3 * proposed_wavelength(scatter, 2.5e-4)
    for smoothing, words in ((0.0, "conicities are those of the noise"), (3e-3, "keep noise of")):
        notes = read_profile(path, "wheel", ProfileReading(smoothing=smoothing)).notes
        (note,) = [text for text in notes if words in text]
        proposed = float(note.partition('smoothing "')[2].partition(" mm")[0])
        assert proposed == pytest.approx(wanted, rel=0.3)
    enough = read_profile(path, "wheel", ProfileReading(smoothing=1.1e-3 * wanted)).notes
    assert not any("noise" in text for text in enough)


@pytest.mark.parametrize("wavelength", [4e-3, 1e-2])
def test_noise_of_slopes_is_that_of_the_formula(wavelength):
    """Of a flat profile with white noise, far from its ends."""
    y = np.arange(-0.2, 0.2, 2.5e-4)
    z = np.random.default_rng(2).normal(scale=2e-5, size=len(y))
    curve = smoothed(y, z, wavelength).table
    places = np.arange(-0.18, 0.18, 1e-4)
    step = 1e-6
    slopes = (curve.height(places + step) - curve.height(places - step)) / (2.0 * step)
    assert np.std(slopes) == pytest.approx(slope_noise(2e-5, 2.5e-4, wavelength), rel=0.15)


@pytest.mark.parametrize("profile", [POINTS, POINTS_OF_RAIL], ids=["S1002", "60E1"])
@pytest.mark.parametrize("spacing", [2.5e-4, 1e-3])
@pytest.mark.parametrize("size", [0.0, 5e-6, 2e-5])
def test_good_profiles_have_no_defects(profile, spacing, size):
    """Neither noise nor jumps of curvature, nor numbers of two decimals, are outliers."""
    for seed in range(3):
        points = noisy(profile[spacing], size, seed)
        for given in (points, np.round(points, 5)):
            found = find_defects(given)
            assert not found.outliers
            assert not found.gaps
            assert not found.steps


@pytest.mark.parametrize("profile", [WHEEL, RAIL], ids=["S1002", "60E1"])
@pytest.mark.parametrize("spacing", [5e-4, 1e-3, 2e-3, 2.5e-3])
def test_points_evenly_spaced_in_y_have_no_gaps(profile, spacing):
    """On the sides of a rail's head they are twenty times as far apart as on its crown."""
    for shift in np.linspace(0.0, spacing, 20, endpoint=False):
        y = np.arange(profile.begin + shift, profile.end, spacing)
        points = np.column_stack([y, profile.height(y)])
        found = find_defects(points[np.isfinite(points[:, 1])])
        assert not found.outliers
        assert not found.gaps
        assert not found.steps


@pytest.mark.parametrize("radius", [1e-4, 5e-4, 2e-3])
@pytest.mark.parametrize("slope", [0.1, 0.5, 1.7])
def test_rounded_corners_are_no_steps(radius, slope):
    for shift in (0.0, 1e-4, 2e-4):
        x = np.arange(shift, 0.04, 2.5e-4) - 0.02
        points = np.column_stack([x, 0.5 * slope * (x + np.hypot(x, radius))])
        found = find_defects(points)
        assert not found.steps
        assert not found.outliers


@pytest.mark.parametrize("profile", [POINTS, POINTS_OF_RAIL], ids=["S1002", "60E1"])
@pytest.mark.parametrize("size", [1.5e-4, -5e-4])
@pytest.mark.parametrize("rise", [0, 1])
def test_patches_are_found_and_nothing_else(profile, size, rise):
    """50 points that lie beside the rest turned a conicity of 0.17 into 0.03 in silence."""
    for seed, begin in enumerate((-0.027, -0.01, 0.0, 0.01)):
        points = noisy(profile[2.5e-4], 5e-6, seed)
        first = int(np.argmin(np.abs(points[:, 0] - begin)))
        points[first : first + 50, 1] += size
        for k in range(rise):
            points[[first + k, first + 49 - k], 1] -= 0.5 * size
        patch = set(range(first + rise, first + 50 - rise))
        found = find_defects(points)
        assert not found.steps
        assert patch <= set(found.outliers) <= set(range(first - 4, first + 54))
        assert found.in_patches <= set(found.outliers)


def test_patch_is_refused_by_line_and_bridged_on_request(tmp_path):
    points = POINTS_OF_RAIL[2.5e-4].copy()
    first = int(np.argmin(np.abs(points[:, 0])))
    points[first : first + 50, 1] += 1.5e-4
    path = written(tmp_path, rows(points), "rail.txt")
    with pytest.raises(InputError) as caught:
        read_profile(path, "rail")
    lines = str(caught.value).splitlines()
    assert lines[0].startswith(f"{path}:{first + 1}:1: 50 outliers, the first in line {first + 1}")
    assert f"the last in line {first + 50}, 0.15 mm beside the curve" in lines[0]
    assert lines[-1] == f"2 problems in {path}"
    profile = read_profile(path, "rail", MEND)
    crown = np.linspace(-0.02, 0.02, 201)
    assert profile.height(crown) == pytest.approx(RAIL.height(crown), abs=3e-5)
    assert len(profile.measured.outliers) == 50
    assert len(profile.measured.bridges) == 1


@pytest.mark.parametrize("defects", ["refuse", "mend"])
def test_single_step_is_refused(tmp_path, defects):
    """Two sweeps that do not fit: no one knows which of them is right."""
    points = POINTS[2.5e-4].copy()
    first = int(np.argmin(np.abs(points[:, 0])))
    points[first:, 1] += 1.5e-4
    path = written(tmp_path, rows(points))
    with pytest.raises(InputError, match=rf"{first}:1: a step of 0.15 mm after line {first}, betw"):
        read_profile(path, "wheel", ProfileReading(defects=defects))
    read_profile(path, "wheel", ProfileReading(defects="keep"))


def test_corners_are_no_outliers():
    """A chamfer or the edge of a plate does not belong to a smooth curve, but to the profile."""
    x = np.arange(0.0, 0.04, 2.5e-4)
    for slope in (0.3, 1.0, 5.0):
        for shift in (0.0, 1e-4):
            points = np.column_stack([x, slope * np.maximum(x - 0.02 - shift, 0.0)])
            found = find_defects(points)
            assert not found.outliers
            assert not found.steps


@pytest.mark.parametrize("profile", [POINTS, POINTS_OF_RAIL], ids=["S1002", "60E1"])
@pytest.mark.parametrize("size", [2e-4, 5e-4, 1e-3, 2e-3, 1e-2])
@pytest.mark.parametrize("length", [1, 2, 4])
def test_outliers_are_found_and_nothing_else(profile, size, length):
    rng = np.random.default_rng(int(1e5 * size) + length)
    for _ in range(5):
        points = noisy(profile[2.5e-4], 5e-6, int(rng.integers(1e6)))
        k = int(rng.integers(10, len(points) - 15))
        along_run = points[k + length] - points[k - 1]
        across = np.array([-along_run[1], along_run[0]]) / np.hypot(*along_run)
        points[k : k + length] += rng.choice([-1.0, 1.0]) * size * across
        found = find_defects(points)
        assert set(found.outliers) == set(range(k, k + length))
        distances = list(found.outliers.values())
        assert distances == pytest.approx([size] * length, rel=0.1, abs=3e-5)


@pytest.mark.parametrize("profile", [POINTS, POINTS_OF_RAIL], ids=["S1002", "60E1"])
@pytest.mark.parametrize("apart", [(0, 2), (0, 3), (0, 2, 4), (0, 2, 3)])
def test_outliers_with_good_points_between_are_found(profile, apart):
    rng = np.random.default_rng(sum(apart))
    for _ in range(3):
        points = noisy(profile[2.5e-4], 3e-6, int(rng.integers(1e6)))
        places = int(rng.integers(30, len(points) - 30)) + np.array(apart)
        across = np.array([[0.0, -1.0], [1.0, 0.0]]) @ (
            points[places[0] + 6] - points[places[0] - 6]
        )
        signs = rng.choice([-1.0, 1.0], len(apart))
        points[places] += np.outer(5e-4 * signs, across / np.hypot(*across))
        assert set(find_defects(points).outliers) == set(places.tolist())


def with_defects(size=5e-4):
    """A single outlier, a run of three, and a gap of 12 mm on the field side."""
    points = noisy(POINTS[2.5e-4], 5e-6)
    single = int(np.argmin(np.abs(points[:, 0] - 0.002)))
    points[single, 1] += size
    run = int(np.argmin(np.abs(points[:, 0] + 0.012)))
    points[run : run + 3, 1] -= size
    kept = (points[:, 0] < 0.04) | (points[:, 0] > 0.052)
    return points[kept], single, run


def test_defects_are_refused_by_line_and_place(tmp_path):
    points, single, run = with_defects()
    path = written(tmp_path, rows(points))
    with pytest.raises(InputError) as caught:
        read_profile(path, "wheel")
    told = str(caught.value).splitlines()
    assert told[0].startswith(f"{path}:{run + 1}:1: 3 outliers, the first in line {run + 1} at (-1")
    assert f"the last in line {run + 3}, 0.5" in told[0]
    assert told[1].startswith(f"{path}:{single + 1}:1: an outlier in line {single + 1} at (")
    assert "a gap of 12" in told[2]
    assert "y = 39." in told[2]
    assert "mend leaves outliers out and bridges gaps, keep" in told[3]
    assert told[4] == f"4 problems in {path}"


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("mirror", [1.0, -1.0])
def test_mended_profiles_follow_the_truth_and_say_what_was_done(tmp_path, reverse, mirror):
    points, _, _ = with_defects()
    given = (points[::-1] if reverse else points) * (mirror, 1.0)
    path = written(tmp_path, rows(given))
    profile = read_profile(path, "wheel", ProfileReading(smoothing=4e-3, defects="mend"))
    truth = WHEEL.height(TREAD)
    assert profile.height(TREAD) == pytest.approx(truth - np.interp(0.0, TREAD, truth), abs=2e-5)
    assert sum(note.startswith("left out: ") for note in profile.notes) == 2
    assert sum(note.startswith("bridged: ") for note in profile.notes) == 1
    assert len(profile.measured.outliers) == 4
    assert profile.measured.outliers[:, 0].max() < 0.003
    assert sorted(profile.measured.bridges[0]) == pytest.approx([0.04, 0.052], abs=3e-4)
    assert np.abs(profile.measured.distance).max() < 4e-5


def test_most_points_as_outliers_are_no_profile(tmp_path):
    points = POINTS[2.5e-4].copy()
    points[20::9, 1] += 3e-3
    with pytest.raises(InputError, match="points are outliers: this is no profile"):
        read_profile(written(tmp_path, rows(points)), "wheel", MEND)


def test_two_sweeps_that_do_not_meet_at_the_tip_of_the_flange(tmp_path):
    """Older instruments measure both sides of the flange on their own: the seam is outliers."""
    points = FROM_BACK.copy()
    tip = int(np.argmax(points[:, 1]))
    seam = np.array([[-0.3, -0.25], [-0.1, -0.35], [0.1, -0.3], [0.3, -0.4], [0.45, -0.3]])
    points[tip : tip + 5] = points[tip] + 1e-3 * seam
    path = written(tmp_path, "#MINIWHEELPROF\nx\n\n" + rows(noisy(points, 3e-6)), "w.whl")
    with pytest.raises(InputError, match="outliers, the first in line"):
        read_profile(path, "wheel", ProfileReading(tape_circle=0.07))
    reading = ProfileReading(tape_circle=0.07, smoothing=4e-3, defects="mend")
    profile = read_profile(path, "wheel", reading)
    assert profile.height(TREAD) == pytest.approx(WHEEL.height(TREAD), abs=2e-5)
    crest = np.linspace(-0.06, -0.05, 50)
    assert profile.height(crest) == pytest.approx(WHEEL.height(crest), abs=5e-5)


@pytest.mark.parametrize(
    "extra",
    [
        [(60.0, -3.0), (60.0, -3.2), (60.0, -3.0), (61.0, -3.0)],  # back to the same place
        [(100.0, -3.0)],  # one point beyond a gap at the end
    ],
)
def test_odd_ends_are_no_errors_of_the_program(tmp_path, extra):
    text = rows(POINTS[1e-3]) + "".join(f"{y} {z}\n" for y, z in extra)
    for defects in ("refuse", "mend", "keep"):
        try:
            read_profile(written(tmp_path, text), "wheel", ProfileReading(defects=defects))
        except InputError as error:
            assert "wheel.txt" in str(error)


@pytest.mark.parametrize("size", [5e-4, 2e-3, 5e-3])
def test_kept_outliers_end_in_a_curve_or_a_message(tmp_path, size):
    """Steep spikes left no usable part: a ValueError without a word."""
    keep = ProfileReading(defects="keep")
    for k in (60, 200, 330, 450):
        points = POINTS[2.5e-4].copy()
        points[k] += (0.3 * size, size)
        try:
            profile = read_profile(written(tmp_path, rows(points)), "wheel", keep)
        except InputError:
            continue
        assert profile.end - profile.begin > 0.02
        profile.sampled(1e-3)


def conicity(wheel, rail="60E1", **reading):
    wish = ContactRequest(
        (str(wheel),) * 2,
        (str(rail),) * 2,
        inclination=np.arctan(1 / 40),
        shifts=(0.0, 0.004),
        amplitudes=(0.003, 0.005),
        reading=ProfileReading(**reading),
    )
    return find_contact_geometry(wish, progress=lambda *_: None).table


@pytest.mark.long
def test_conicity_recovers_from_noise_outliers_and_gaps(tmp_path):
    """Within 6 % at 3 mm and 4 % at 5 mm: noise of 5 µm alone moves it as far.

    Unmended outliers of 0.5 mm turn 0.174 into 0.0001.
    """
    truth = conicity("S1002").conicity
    points, _, _ = with_defects()
    wheel = written(tmp_path, rows(points))
    rail_points = noisy(POINTS_OF_RAIL[2.5e-4], 2e-6)
    rail_points[150] += (0.0, 4e-4)
    rail = written(tmp_path, rows(rail_points), "rail.txt")
    table = conicity(wheel, rail, smoothing=4e-3, defects="mend")
    assert table.conicity[0] == pytest.approx(truth[0], rel=0.06)
    assert table.conicity[1] == pytest.approx(truth[1], rel=0.04)
    assert set(table.measured) == {"left_wheel", "left_rail"}
    kept = conicity(wheel, rail, smoothing=4e-3, defects="keep").conicity
    assert abs(kept[0] - truth[0]) > 0.1 * truth[0]


@pytest.mark.long
def test_contact_on_a_bridged_gap_is_reported(tmp_path):
    points = POINTS[2.5e-4]
    points = points[(points[:, 0] < -0.02) | (points[:, 0] > 0.01)]
    table = conicity(written(tmp_path, rows(points)), defects="mend")
    (told,) = [note for note in table.notes if "left wheel lie on a bridged gap" in note]
    assert "nothing was measured there" in told
