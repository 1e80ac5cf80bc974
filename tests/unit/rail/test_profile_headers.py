"""What the header of a profile's file says of its points: units, counts, names of columns."""

import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.rail.profiles.named_profiles import named_profile
from vehicledyn.rail.profiles.open_profile import read_profile

WHEEL = named_profile("S1002", "wheel")
PLACES = np.arange(-0.068, 0.0581, 2.5e-4)
POINTS = 1e3 * np.column_stack([PLACES, WHEEL.height(PLACES)])
TREAD = np.linspace(-0.037, 0.05, 400)
INCH = 25.4


def read(tmp_path, header, points, form="{:.6f} {:.6f}\n", name="w.whl"):
    path = tmp_path / name
    path.write_text(header + "".join(form.format(*pair) for pair in points), encoding="utf-8")
    return read_profile(path, "wheel")


def is_s1002(profile):
    assert profile.height(TREAD) == pytest.approx(WHEEL.height(TREAD), abs=2e-6)
    assert profile.begin == pytest.approx(-0.068, abs=1e-8)


@pytest.mark.parametrize("tape_circle", ["2.7559055", "70 mm"])
@pytest.mark.parametrize("offset", ["0.1", "2.54 mm"])
def test_lengths_of_the_header_are_in_the_unit_of_the_points(tmp_path, tape_circle, offset):
    """The tape circle of a file in inches was 2.8 mm beside the back, wheels 8 mm too large."""
    header = (
        f"WheelDiameterTaperline={tape_circle}\nXOffset={offset}\nUnits=inch\nColumnDef=X,Y\n\n"
    )
    profile = read(tmp_path, header, np.add(POINTS, (70.0 - 2.54, 0.0)) / INCH)
    is_s1002(profile)
    assert any("the tape circle at 70 mm" in note for note in profile.notes)


@pytest.mark.parametrize("distance", ["2.7559", "700", "-70"])
def test_tape_circle_that_no_wheel_has(tmp_path, distance):
    header = f"ColumnDef=X,Y\nWheelDiameterTaperline={distance}\n\n"
    with pytest.raises(InputError, match=rf"w\.whl:2:1: .*'{distance}' is no distance of a tape"):
        read(tmp_path, header, np.add(POINTS, (70.0, 0.0)))


def test_points_that_are_missing_are_reported(tmp_path):
    """A file that was cut off looked like a narrow wheel."""
    header = f"XYPoints={len(POINTS)}\nColumnDef=X,Y\n\n"
    notes = read(tmp_path, header, POINTS[:400]).notes
    assert f"cut off? the file holds 400 of the {len(POINTS)} points that XYPoints counts" in notes
    assert not any("cut off" in note for note in read(tmp_path, header, POINTS).notes)


@pytest.mark.parametrize(
    ("header", "form"),
    [
        ("No,Y,Z\n", "7,{0:.6f},{1:.6f}\n"),
        ("z_mm;y_mm\n", "{1:.6f};{0:.6f}\n"),
        ("X [mm]\tY [mm]\tZ [mm]\n", "120.0\t{0:.6f}\t{1:.6f}\n"),
        ('"N","X","angle","Z"\n', "1,{0:.6f},0.5,{1:.6f}\n"),
        ("angle,X,Y\n", "0.5,{0:.6f},{1:.6f}\n"),
    ],
)
def test_columns_are_found_by_their_names(tmp_path, header, form):
    profile = read(tmp_path, header, POINTS, form, "w.csv")
    is_s1002(profile)
    assert any("by the header" in note for note in profile.notes)


def test_named_column_that_a_line_lacks(tmp_path):
    with pytest.raises(InputError, match=r"w\.csv:2:1: a point needs two numbers"):
        read(tmp_path, "No,Y,Z\n", POINTS, "1,{:.6f}\n", "w.csv")
