"""The verb ``profiles``: options, JSON, refusals, light start."""

import json
import subprocess
import sys
from dataclasses import replace

import h5py
import numpy as np
import pytest
from programs import call

from vehicledyn.analyses.contact.contact_geometry import ContactRequest, find_contact_geometry
from vehicledyn.base.errors import InputError
from vehicledyn.rail.profiles.named_profiles import named_profile
from vehicledyn.results.plots.contact_figures import contact_figures
from vehicledyn.results.tables.contact_table import read_contacts, write_contacts

pytestmark = pytest.mark.long


def quiet(*_):
    """Show no progress."""


def command(*arguments, folder=None):
    return call(["vehicledyn", "profiles", *arguments], folder or ".")


def test_options_reach_the_geometry(tmp_path):
    """Units, unequal wheels, yaw, curve; JSON and file say the same."""
    done = command(
        "S1002", "60E1", "--gauge", "1.436 m", "--inclination", "1/20",
        "--right-wheel", "cone:1/40", "--radius", "458", "--right-radius", "459 mm",
        "--yaw", "3 mrad", "--curve-radius", "300 m",
        "--back-to-back", "1361", "--shift", "-1:2:3", "--amplitude", "0", "-o", "r.h5", "--json",
        folder=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    told, table = json.loads(done.stdout), read_contacts(tmp_path / "r.h5")
    expected = {
        "gauge": 1.436, "inclination": np.arctan(0.05), "back_to_back": 1.361, "yaw": 3e-3,
        "curvature": 1 / 300, "radius_left": 0.458, "radius_right": 0.459,
    }  # fmt: skip
    for name, value in expected.items():
        assert told["settings"][name] == pytest.approx(value, rel=1e-12)
        assert table.settings[name] == pytest.approx(value, rel=1e-12)
    assert table.lean == "1/20"  # as it was written
    assert told["shift"] == pytest.approx([-1e-3, 0.0, 1e-3, 2e-3], abs=1e-15)
    assert table.wheel == "S1002 / cone of slope 0.025"
    assert told["radius_difference"] == pytest.approx(table.radius_difference.tolist(), abs=0.0)
    right = np.array(told["contacts"]["right"]["radius"], dtype=float)[:, 0]
    place = np.array(told["contacts"]["right"]["place"], dtype=float)[:, 0]
    assert right == pytest.approx(0.459 - 0.025 * place, abs=1e-12)
    left = np.array(told["contacts"]["left"]["radius"], dtype=float)[:, 0]
    assert told["radius_difference"] == pytest.approx(left - right, abs=1e-12)
    assert told["amplitude"] == []


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("S1003", "60E1"), "did you mean 'S1002'?"),
        (("60E1", "60E1"), "a wheel's is needed"),
        (("S1002", "none.prr"), "none.prr: there is no such file"),
        (("S1002", "60E1", "--gauge", "1400"), "gauge 1400 mm does not fit the wheelset"),
        (("S1002", "60E1", "--gauge", "1668"), "--back-to-back 1360 and --flange-back 70 are"),
        (("S1002", "60E1", "--gauge", "-5"), "--gauge -5 mm: must be above zero"),
        (("S1002", "60E1", "--gauge", "3 s"), "--gauge 3 s: '3 s' has the wrong unit"),
        (("S1002", "60E1", "--inclination", "40"), "--inclination 40: write a slope"),
        (("S1002", "60E1", "--yaw", "1"), "--yaw 1: 1 has no unit; write '1 rad' or '1 deg'"),
        (("S1002", "60E1", "--radius", "0"), "--radius 0 mm: must be above zero"),
        (("S1002", "60E1", "--shift", "3:1:2"), "--shift 3:1:2: must rise"),
        (("S1002", "60E1", "--curve-radius", "300"), "--curve-radius 300 mm: must be 5 m or more"),
        (("S1002", "60E1", "--smoothing", "-1"), "--smoothing -1 mm: must not be negative"),
        (("S1002", "60E1", "--smoothing", "200"), "--smoothing 200 mm: must be 100 mm or less"),
        (
            ("S1002", "60E1", "--defects", "men"),
            "--defects: expected 'refuse', 'mend' or 'keep', found 'men'",
        ),
        (("S1002", "60E1", "--tape-circle", "7"), "--tape-circle 7 mm: must be between 20 and 150"),
    ],
)
def test_refusals(arguments, told, tmp_path):
    done = command(*arguments, "-o", "r.h5", folder=tmp_path)
    assert done.returncode == 2
    assert told in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "r.h5").exists()


@pytest.mark.long
def test_what_was_mended_is_drawn_and_kept_in_the_file(tmp_path):
    """The result file holds the points, so that the picture can be drawn again."""
    profile = named_profile("S1002", "wheel")
    y = np.arange(-0.068, 0.058, 2.5e-4)
    y = y[(y < 0.03) | (y > 0.045)]
    z = profile.height(y)
    z[300] += 5e-4
    text = "".join(f"{1e3 * a:.4f} {1e3 * b:.4f}\n" for a, b in zip(y, z, strict=True))
    (tmp_path / "worn.txt").write_text(text)
    asked = ("worn.txt", "60E1", "--shift", "0", "--amplitude", "3", "-o", "r.h5", "--plots", "p")
    refused = command(*asked, folder=tmp_path)
    assert refused.returncode == 2
    assert "worn.txt:301:1: an outlier in line 301 at (" in refused.stderr
    assert "a gap of 15" in refused.stderr
    assert not (tmp_path / "r.h5").exists()
    done = command(*asked, "--defects", "mend", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "left out: an outlier in line 301" in done.stdout
    assert (tmp_path / "p" / "measured.png").stat().st_size > 10_000
    (measured,) = read_contacts(tmp_path / "r.h5").measured.values()
    assert measured.outliers == pytest.approx(np.array([[y[300], z[300]]]), abs=2e-6)
    assert sorted(measured.bridges[0]) == pytest.approx([0.03, 0.045], abs=3e-4)
    assert measured.distance.shape == measured.points.shape[:1]


def test_shifts_beyond_the_rail_are_told():
    """What is found stays; the shift at which a wheel is beside its rail is named."""
    wish = ContactRequest(("S1002",) * 2, ("60E1",) * 2, shifts=(0.0, 0.2), amplitudes=())
    report = find_contact_geometry(wish, progress=quiet)
    assert report.table.shift.tolist() == [0.0]
    assert (
        "at a lateral shift of 200.000 mm the left wheel is not above its rail" in report.as_text()
    )
    with pytest.raises(InputError, match="not above its rail"):
        find_contact_geometry(
            ContactRequest(("S1002",) * 2, ("60E1",) * 2, shifts=(0.2,)), progress=quiet
        )


def test_conicity_of_a_cone_and_its_roll():
    wish = ContactRequest(
        ("cone:1/20",) * 2, ("arc:300",) * 2, shifts=(0.0,), amplitudes=(0.001, 0.004)
    )
    table = find_contact_geometry(wish, progress=quiet).table
    for name in ("conicity", "conicity_harmonic", "conicity_regression"):
        assert getattr(table, name) == pytest.approx(0.05, rel=2e-4)
    half = table.contacts.y[0, 0, 0]
    expected = 0.05 * (half + 0.3 * 0.05) / (half - table.contacts.radius[0, 0, 0] * 0.05)
    assert table.conicity_with_roll == pytest.approx(expected, rel=2e-3)


def test_conicity_of_unequal_wheels():
    """Cones of γ and radii apart by d run about y = -d/(2γ) here, far beside the amplitude."""
    wish = ContactRequest(
        ("cone:1/20",) * 2, ("arc:300",) * 2, radii=(0.4602, 0.46), shifts=(0.0,),
        amplitudes=(0.001,),
    )  # fmt: skip
    table = find_contact_geometry(wish, progress=quiet).table
    assert table.conicity == pytest.approx(0.05, rel=1e-3)
    assert table.conicity_harmonic == pytest.approx(0.05, rel=1e-3)
    equal = find_contact_geometry(replace(wish, radii=(0.46, 0.46)), progress=quiet).table
    assert table.conicity_with_roll == pytest.approx(equal.conicity_with_roll, rel=2e-3)


def test_jumps_do_not_depend_on_the_shifts_asked():
    """Few shifts: jumps are where both points touch at once, and curves have a gap there only."""
    wish = ContactRequest(("S1002",) * 2, ("60E1",) * 2, inclination=np.arctan(1 / 40),
                       shifts=(-0.008, 0.008), amplitudes=(0.001, 0.003))  # fmt: skip
    table = find_contact_geometry(wish, progress=quiet).table
    assert [side for _, side, *_ in table.jumps] == ["right"] * 3 + ["left"] * 3
    at_jumps = replace(wish, shifts=tuple(jump[0] for jump in table.jumps), amplitudes=())
    gaps = find_contact_geometry(at_jumps, progress=quiet).table.contacts
    for n, (at, side, *places) in enumerate(table.jumps):
        k = ("left", "right").index(side)
        if abs(at) > 5e-3:  # radii of 13 mm on each other: contact sweeps over the wheel's
            assert sorted(places) == pytest.approx([-38.43e-3, -35e-3], abs=0.6e-3)
            continue
        assert gaps.gap[n, k, 1] < 1e-7
        assert sorted(gaps.place[n, k, :2]) == pytest.approx(sorted(places), abs=2e-4)
    assert table.curves.conicity[[0, -1]] == pytest.approx(table.conicity, rel=1e-12)
    (_, _), (_, geometry) = contact_figures(table)
    places, angles, difference, _ = geometry.axes
    for axes, line, gaps_wanted in ((places, 0, 3), (angles, 0, 3), (difference, 0, 6)):
        values = axes.lines[line].get_ydata()
        assert np.isnan(values).sum() == gaps_wanted
        drawn = np.abs(np.diff(values))
        assert np.nanmax(drawn) < 2.0
    left, shift = places.lines[0].get_ydata(), places.lines[0].get_xdata()
    for gap in np.flatnonzero(np.isnan(left)):
        assert abs(left[gap + 1] - left[gap - 1]) > 3.0
        assert 0.0 < shift[gap + 1] - shift[gap - 1] < 3e-3


def test_files_without_curves_are_drawn_from_their_table(tmp_path):
    wish = ContactRequest(("cone:1/20",) * 2, ("arc:300",) * 2, shifts=(0.0, 1e-3, 2e-3))
    write_contacts(tmp_path / "r.h5", find_contact_geometry(wish, progress=quiet).table)
    assert len(read_contacts(tmp_path / "r.h5").curves.shift) == 21
    with h5py.File(tmp_path / "r.h5", "a") as file:
        del file["curves"]
    table = read_contacts(tmp_path / "r.h5")
    assert table.curves.place[:, 1] == pytest.approx(table.contacts.place[:, 1, 0], abs=0.0)
    assert len(list(contact_figures(table))) == 2


def test_help_is_light():
    code = (
        "import sys\nsys.argv = ['vehicledyn', 'profiles', '--help']\n"
        "from vehicledyn.cli import main\ntry:\n    main()\nexcept SystemExit:\n    pass\n"
        "heavy = {'numpy', 'casadi', 'h5py', 'matplotlib', 'scipy', 'pandas'} & set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "Compute contact points" in done.stdout


@pytest.mark.long
def test_flanges_over_the_rail_are_told():
    """The tip of S1002 is 55 mm inside the tape circle: 5 mm over a gauge face at 27.5 mm."""
    shifts = (0.0, -0.027, 0.028)
    wish = ContactRequest(("S1002",) * 2, ("60E1",) * 2, shifts=shifts, amplitudes=(0.03,))
    report = find_contact_geometry(wish, progress=quiet)
    (told,) = [note for note in report.table.notes if "derails" in note]
    assert told.startswith("at a lateral shift of 28.000 mm the left flange has climbed its rail")
    assert len(report.table.shift) == 3
    assert np.isnan(report.table.conicity).all()
