"""Inputs that the program once answered with a bug, a hang or a lack of memory."""

import io
import json
import re
import tempfile
import time
from pathlib import Path
from types import SimpleNamespace

import mechanism_cases
import numpy as np
import pytest
import result_cases
import road_file_cases
import table_cases
import yaml_cases
from harness import Case, run

from vehicledyn.analyses.sensitivity.steps import check_size
from vehicledyn.base.errors import InputError
from vehicledyn.base.files.column_files import ColumnKind, read_columns
from vehicledyn.base.slope_text import slope_of
from vehicledyn.base.units import parse_unit, to_si
from vehicledyn.files.expressions.algebra import ExpressionError
from vehicledyn.files.expressions.expressions import read_expression
from vehicledyn.results.animation.film import draw_film
from vehicledyn.results.assessment.even_samples import even_samples
from vehicledyn.results.assessment.signal import signal_of
from vehicledyn.results.assessment.sliding import sliding_mean
from vehicledyn.results.plots.figures import new_figure
from vehicledyn.results.plots.scales import leave_room

pytestmark = pytest.mark.xdist_group("hostile")  # warmed up once

MEASURED = "s [m], curvature [1/km], cant [mm]\n"
RECORD = "s [m], level [mm], cross_level [mm]\n"
ROAD = "x [m], z [mm]\n"
ECCENTRIC = mechanism_cases.ECCENTRIC


def refused(case, words):
    outcome = run(case)
    assert (outcome.code, outcome.faults) == (2, []), outcome
    assert words in outcome.text


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ("0,0,0\n1e301,0,0\n", "s.csv:3:1: s: 1e+301 m is farther than a track begins or ends"),
        ("-1e308,0,0\n1e308,1,0\n", "s.csv:2:1: s: "),
        ("0,0,0\n1e9,0,0\n", "s.csv:3:1: s: "),
        ("0,0,0\n1e6,1,0\n2e6,0,0\n", "a track of 2e+06 m is too long, 200000 m at most"),
    ],
)
def test_tracks_beyond_all_bounds(rows, words):
    track = f"kind: measured\nfile: s.csv\n{table_cases.HEAD}"
    files = {"t.yaml": track.encode(), "s.csv": (MEASURED + rows).encode()}
    refused(Case("track", files, ["track", "t.yaml"]), words)


@pytest.mark.parametrize("rows", ["0,0,0\n1e-12,1,0\n1000,0,0\n", "0,0,0\n1e-5,1,0\n100000,0,0\n"])
def test_records_that_no_even_grid_holds(rows):
    track = table_cases.OF_TABLES["rough.csv"].replace("fade: 2 m", "fade: 0 m")
    files = {"t.yaml": track.encode(), "rough.csv": (RECORD + rows).encode()}
    refused(Case("record", files, ["track", "t.yaml"]), "are too uneven; give values at equal")


@pytest.mark.parametrize("rows", ["0,0\n1e301,1\n", "-1e301,0\n1e301,1\n"])
def test_roads_beyond_all_bounds(rows):
    flat = yaml_cases.scenario_texts()["scenarios/iltis_ramp_steer.yaml"]
    text = flat.replace("kind: flat", "kind: profile\n  file: r.csv")
    files = {"a.yaml": text.encode(), "r.csv": (ROAD + rows).encode()}
    refused(Case("road", files, ["run", "a.yaml"]), "x: farther than 1e+06 m")


def test_motions_that_no_smooth_curve_joins():
    table = f"{table_cases.MOTION}1e+301, 40\n"
    files = yaml_cases.around({"motion.csv": table.encode()})
    command = ["inverse", "scenarios/systems/slider_crank.yaml", "--motion", "motion.csv"]
    refused(Case("motion", files, command), "motion.csv: no smooth curve goes through points")


@pytest.mark.parametrize("factor", [20.0, 1e3, 1e6])
@pytest.mark.parametrize("name", ["s1002.csv", "60e1.csv"])
def test_profiles_a_thousand_times_too_high(name, factor):
    lines = table_cases.profiles()[name].splitlines()[1:]
    pairs = [line.split(",") for line in lines]
    text = "# unit: mm\n" + "".join(f"{y}, {float(z) * factor!r}\n" for y, z in pairs)
    pair = [name, "60E1"] if name == "s1002.csv" else ["S1002", name]
    refused(Case("profile", {name: text.encode()}, ["profiles", *pair]), "mm high, read in mm")


def changed(name, change):
    """Return a whole result without checksums that a function has changed."""
    import h5py

    box = io.BytesIO(result_cases._unsealed(result_cases.seeds()[name]))
    with h5py.File(box, "r+") as file:
        change(file)
    return box.getvalue()


def facts_that_are_lists(file):
    file["solver"].attrs["method"] = [1, 2, 3]


def plot_named(name, panels=None):
    def change(file):
        channel = file.attrs["channels"][0]
        usual = [{"label": "a", "unit": "rad", "channels": [channel]}]
        plot = {"name": name, "kind": "time", "title": "x", "panels": panels or usual}
        del file["plots/descriptions"]
        file["plots"].create_dataset("descriptions", data=json.dumps([plot]))

    return change


@pytest.mark.parametrize(
    ("change", "verb", "words"),
    [
        (facts_that_are_lists, "info", "its fact 'method' is neither number nor text"),
        (plot_named("a\0b"), "plot", r"run.h5: a plot is named 'a\x00b'"),
        (plot_named("a" * 5000), "plot", "give it a name that a file can have"),
        (plot_named("../a"), "plot", "give it a name that a file can have"),
        (plot_named("a", [3]), "plot", "plot 'a': a panel is no mapping"),
        (plot_named("a", [3]), "report", "run.h5: plot 'a': a panel is no mapping"),
        (plot_named("a", 3), "animate", "plot 'a': a list is needed"),
        (plot_named("a", [{"label": "a", "unit": "1", "channels": 5}]), "plot", "a list is needed"),
    ],
)
def test_runs_that_say_what_none_says(change, verb, words):
    refused(Case(verb, {"run.h5": changed("run.h5", change)}, [verb, "run.h5"]), words)


def set_value(place, value, row=...):
    def change(file):
        item = file[place][()]
        item[row] = value
        file[place][...] = item

    return change


def cut(place):
    def change(file):
        old = file[place][()]
        del file[place]
        file.create_dataset(place, data=old[: len(old) // 2])

    return change


def giant(place):
    def change(file):
        del file[place]
        file.create_dataset(place, (10**12,), "f8", chunks=(1000,))

    return change


def nothing(place):
    def change(file):
        del file[place]
        file.create_dataset(place, data=[], dtype=float)

    return change


def no_columns(place):
    def change(file):
        old = file[place][()]
        del file[place]
        file.create_dataset(place, data=old[:, :0])

    return change


def complex_numbers(place):
    def change(file):
        old = file[place][()]
        del file[place]
        file.create_dataset(place, data=old + 1j)

    return change


def stated(status):
    def change(file):
        file.attrs["status"] = status

    return change


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (giant("figures/units"), "figures/units has the shape"),
        (giant("channels/name"), "name is not in the file"),
        (cut("cases/status"), "cases/status has the shape (3,), not (6,)"),
        (lambda file: file.pop("figures"), "study.h5: is damaged"),
    ],
)
def test_studies_that_do_not_fit_together(change, words):
    study = {"study.yaml": yaml_cases.STUDY.encode(), "study.h5": changed("study.h5", change)}
    resume = ["sweep", "study.yaml", "-o", "study.h5", "--resume", "--workers", "1"]
    refused(Case("study", yaml_cases.around(study), resume), words)


@pytest.mark.parametrize(
    ("name", "change", "words"),
    [
        ("modes.h5", giant("case_1/state_shape_real"), "state_shape_real is not in the file"),
        ("contact.h5", giant("contact/y"), "contact/y is not in the file"),
        ("modes.h5", set_value("coordinates", b"nobody", 0), "'nobody' is unknown"),
        ("modes.h5", set_value("case_1/state_shape_real", float("inf")), "no finite numbers"),
        ("modes.h5", set_value("case_1/channel_shape_imag", 1e308), "no finite numbers"),
        ("modes.h5", set_value("case_1/eigenvalue_real", float("nan")), "no finite numbers"),
        ("modes.h5", set_value("case_1/kind", b"strange", 0), "'strange' is unknown"),
        ("modes.h5", cut("case_1/participation"), "participation has 1 modes, not 2"),
        ("response.h5", cut("frequency"), "response has 20 frequencies, not 10"),
        ("contact.h5", cut("shift"), "has 3 shifts, not 1"),
        ("contact.h5", cut("curves/place"), "place has "),
        ("hunt.h5", cut("cycle_period"), "period has "),
        ("hunt.h5", cut("equilibrium_parameter"), "eigenvalue has "),
        ("hunt.h5", nothing("equilibrium_parameter"), "eigenvalue has "),
        ("hunt.h5", no_columns("cycle_direction"), "direction has 0 components, not 3"),
        ("hunt.h5", complex_numbers("eigenvalue_imag"), "eigenvalue holds no real numbers"),
        ("response.h5", complex_numbers("response_imag"), "response holds no real numbers"),
        ("hunt.h5", stated("$x^2_{$"), "status: '$x^2_{$' is unknown"),
    ],
)
@pytest.mark.parametrize("verb", ["info", "plot", "report"])
def test_tables_that_do_not_fit_together(name, change, words, verb):
    outcome = run(Case(name, {name: changed(name, change)}, [verb, name]))
    assert (outcome.code, outcome.faults) == (2, []), outcome
    assert f"{name}: is damaged" in outcome.text
    assert words in outcome.text


FORMULA = "$x^2_{$"


def test_dollars_in_pictures_begin_no_formula():
    def named(file):
        file.attrs["title"] = file["case_1"].attrs["setting"] = FORMULA

    whole = {"modes.h5": changed("modes.h5", named)}
    for verb in ("plot", "report"):
        outcome = run(Case("modes", whole, [verb, "modes.h5"]))
        assert outcome.code == 0, outcome.text


def test_amplitudes_beyond_all_flanges():
    command = ["profiles", "s1002", "60E1", "--amplitude", "1e308"]
    refused(Case("amplitude", {}, command), "--amplitude 1e+305: must be below 1e+100 m")


def as_a_row(file):
    del file["states/value"]
    file["states"].create_dataset("value", data=[0.0] * 9)


def test_states_that_are_no_table():
    files = yaml_cases.around({"run.h5": changed("run.h5", as_a_row)})
    command = ["run", "scenarios/systems/double_pendulum.yaml", "--restart", "run.h5", "-o", "o.h5"]
    sampled = ["--set", "output.interval=5 ms", "--set", "duration=60 ms"]
    refused(Case("restart", files, [*command, *sampled, "-q"]), "states/value has the shape")


SHORT = ["--set", "duration=20 ms", "--set", "output.interval=5 ms", "--backend", "interpreted"]


@pytest.mark.parametrize(
    ("system", "given", "instead"),
    [
        ("bicycle", "com: [0.3 m, 0, 0.9", "com: [0.3 m, -1e308 m, 0.9"),
        ("rail_wheelset", "value: 2.5 MN*m/rad", "value: 2.5e12 MN*m/rad"),
    ],
)
def test_numbers_that_end_a_run_at_once(system, given, instead):
    """A mass far away overflows; a run that ends after 0.1 us has millions of samples a second."""
    name = f"systems/{system}.yaml"
    text = yaml_cases.system_texts()[name]
    assert given in text
    files = yaml_cases.around({name: text.replace(given, instead).encode()})
    command = ["run", f"scenarios/systems/{system}.yaml", "-o", "out.h5", "--no-plots", "-q"]
    outcome = run(Case(system, files, [*command, *SHORT], outputs=("out.h5",)))
    assert outcome.code in (1, 3) and not outcome.faults, outcome


@pytest.mark.parametrize(
    "place", ["states/value", "restart/history", "restart/event_at", "events/at"]
)
def test_arrays_that_are_not_in_the_file(place):
    def change(file):
        if place in file:
            del file[place]
        file.create_dataset(place, shape=(10**12,), chunks=(1000,), dtype=float)

    refused(
        Case("info", {"run.h5": changed("run.h5", change)}, ["info", "run.h5"]), "not in the file"
    )


def formats(file):
    file.attrs["format"] = [1.0, 2.0]


@pytest.mark.parametrize("name", ["run.h5", "response.h5", "study.h5"])
@pytest.mark.parametrize("verb", ["info", "report", "compare"])
def test_formats_that_are_lists(name, verb):
    files = {name: changed(name, formats), "whole.h5": changed(name, lambda file: None)}
    others = ["whole.h5"] if verb == "compare" else []
    outcome = run(Case(name, files, [verb, name, *others]))
    assert (outcome.code, outcome.faults) == (2, []), outcome


@pytest.mark.parametrize("value", [1.79e308, -1.79e308])
def test_lines_at_the_end_of_all_numbers(value):
    axes = new_figure(2.0).subplots()
    axes.plot([0.0, 1.0, 2.0], [value] * 3)
    axes.set_ylim(0.9 * value, value)
    leave_room(axes)
    assert np.isfinite(axes.get_ylim()).all()


@pytest.mark.parametrize(
    ("given", "instead", "words"),
    [
        ("reference_line_end_u = 10.0", "reference_line_end_u = 1e308", "a finite number, 1e+06"),
        ("long_section_v_left = 1.5", "long_section_v_left = -inf", "a finite number, 1e+06"),
        (" 0.012089", "1e39     ", "number 5 of cross section 2 is 1e+39"),
        (" 0.012089", "-1e301   ", "number 5 of cross section 2 is -1e+301"),
        (
            "reference_line_end_u = 10.0",
            "reference_line_end_u = 90",
            "the file holds 21: it is cut",
        ),
    ],
)
def test_measured_roads_beyond_all_bounds(given, instead, words):
    head, body = road_file_cases.roads()[b"LRFI"]
    content = (head + body).replace(given.encode(), instead.encode(), 1)
    assert content != head + body
    text = yaml_cases.scenario_texts()["scenarios/iltis_ramp_steer.yaml"]
    text = text.replace("kind: flat", "kind: opencrg\n  file: a.crg")
    files = {"a.yaml": text.encode(), "a.crg": content}
    refused(Case("opencrg", files, ["validate", "a.yaml"]), words)


def test_heights_that_no_slope_joins():
    rows = "".join(f"{k}, {z}\n" for k, z in enumerate([0, 1e308, 1.7e308, 1e-300, 0, 1, 2]))
    flat = yaml_cases.scenario_texts()["scenarios/iltis_ramp_steer.yaml"]
    text = flat.replace("kind: flat", "kind: profile\n  file: r.csv")
    files = {"a.yaml": text.encode(), "r.csv": f"x [m], z [m]\n{rows}".encode()}
    outcome = run(Case("road", files, ["validate", "a.yaml"]))
    assert outcome.code in (0, 2) and not outcome.faults, outcome


def test_tyres_without_the_shape_of_their_trail():
    text = road_file_cases.tyres()[1]
    line = next(line for line in text.splitlines() if line.startswith("QCZ1"))
    files = {"a.tir": text.replace(line, "").encode()}
    refused(Case("tyre", files, ["tyre", "a.tir"]), "QCZ1: missing: Shape factor Cpt")


def test_roads_that_are_walls():
    flat = yaml_cases.scenario_texts()["scenarios/iltis_ramp_steer.yaml"]
    text = flat.replace("kind: flat", "{kind: plane, slope_x: 0, slope_y: 300}")
    text = text.replace("road:\n  {", "road: {")
    refused(Case("road", {"a.yaml": text.encode()}, ["validate", "a.yaml"]), "road.slope_y")


def test_masses_whose_squares_overflow():
    name = "systems/double_pendulum.yaml"
    text = yaml_cases.system_texts()[name]
    given = "mass: {value: 1 kg"
    assert given in text
    files = {name: text.replace(given, "mass: {value: 1e200 kg").encode()}
    outcome = run(Case("mass", yaml_cases.around(files), ["eig", name, "-o", "m.h5"], ("m.h5",)))
    assert (outcome.code, outcome.faults, outcome.left) == (3, [], []), outcome
    assert "the result cannot be kept: channel_shape holds values" in outcome.text


def test_numbers_that_no_scale_reaches():
    def change(file):
        file.pop("checksums", None)
        file["wheelset/roll"][...] = 1e308

    files = {"rail.h5": changed("rail.h5", change)}
    outcome = run(Case("result", files, ["report", "rail.h5"], ("rail_report.html",)))
    assert outcome.code == 0 and not outcome.faults, outcome


def test_a_study_whose_checksums_are_not_in_the_file():
    def change(file):
        del file["cases/crc"]
        file.create_dataset("cases/crc", (10**12,), "u4", chunks=(1000,))

    files = {"study.h5": changed("study.h5", change), "study.yaml": yaml_cases.STUDY.encode()}
    words = ["sweep", "study.yaml", "-o", "study.h5", "--resume", "--workers", "1", "-q"]
    outcome = run(Case("resumed", yaml_cases.around(files), words, ("study.h5",)))
    assert outcome.code == 2, outcome
    assert "is damaged (cases/crc is not in the file)" in outcome.text


WAVY = "angle [deg], radius [mm]\n" + "".join(
    f"{k}, {30 + k // 15 % 4}\n" for k in range(0, 360, 15)
)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (WAVY, "the follower bridges parts of the cam"),
        (WAVY.replace("15, 31\n", "15, 39\n"), "bridges parts of the cam|no smooth curve passes"),
    ],
)
def test_measured_cams_that_are_hollow(points, words):
    files = {"cam.yaml": mechanism_cases.OUTLINE.encode(), "measured.csv": points.encode()}
    profile = ["--profile", "out.dxf", "--tolerance", "10 um"]
    outcome = run(Case("cam", files, ["cam", "cam.yaml", *profile]))
    assert (outcome.code, outcome.faults) == (2, []), outcome
    assert re.search(words, outcome.text)


@pytest.mark.parametrize("radius", ["-1e308 m", "1e100 m"])
def test_beams_as_thick_as_numbers_go(radius):
    text = mechanism_cases.BEAM.replace("SECTION", f"{{shape: circle, radius: {radius}}}")
    case = Case("beam", {"beam.yaml": text.encode()}, ["validate", "beam.yaml"])
    refused(case, "elements.rod: beam 'rod': its numbers are too large")


def test_heads_of_measured_channels_have_dots_and_units():
    """A head such as "upper.angle [rad]" was no column."""
    files = yaml_cases.around({
        "study.yaml": mechanism_cases.STUDIES["identify"].encode(),
        "measured.csv": mechanism_cases.MEASURED.replace("[rad]", "[kg]").encode(),
    })  # fmt: skip
    refused(
        Case("identify", files, ["identify", "study.yaml", "-o", "out.h5"]), "unit 'kg' does not"
    )


def test_damaged_lists_of_scales_do_not_crash_hdf5():
    """HDF5's own functions for dimension scales read beyond their memory on this file."""
    content = (Path(__file__).parent / "once_failed" / "damaged_scales.h5").read_bytes()
    case = Case("scales", {"modes.h5": content}, ["export-data", "modes.h5", "-o", "o.csv"])
    for _ in range(3):
        refused(case, "modes.h5: is damaged (Unable to synchronously open object")


@pytest.mark.parametrize("figure", ["linear_critical", "linear_critical_frequency"])
def test_critical_speeds_at_the_end_of_all_numbers(figure):
    def change(file):
        file.attrs[f"figure_{figure}"] = 1e308

    outcome = run(Case(figure, {"hunt.h5": changed("hunt.h5", change)}, ["plot", "hunt.h5"],
                       outputs=("hunt_plots",)))  # fmt: skip
    assert (outcome.code, outcome.faults) == (0, []), outcome


def test_responses_that_end_where_they_begin_leave_no_warning():
    def change(file):
        file["frequency"][-1] = file["frequency"][0]

    outcome = run(Case("response", {"response.h5": changed("response.h5", change)},
                       ["plot", "response.h5"], outputs=("response_plots",)))  # fmt: skip
    assert outcome.faults == [], outcome


def test_lengths_whose_squares_overflow_leave_no_warning():
    name = "systems/parallelogram.yaml"
    text = yaml_cases.system_texts()[name].replace(
        "at: [crank.length, 0, 0]", "at: [0, 0, 1e200 m]"
    )
    command = ["run", "scenarios/systems/parallelogram.yaml", "-o", "out.h5", *SHORT, "-q"]
    files = yaml_cases.around({name: text.encode()})
    refused(Case("lengths", files, command), "contradictory constraints")


NOT_FITTING = [
    ("contact.h5", "jumps/to"),
    ("handling.h5", "turn.angle"),
    ("handling.h5", "figure_value"),
    ("track.h5", "curvature"),
    ("cam.h5", "figure_value"),
    ("tyre.h5", "tyre_1/lateral/load"),
    ("sensitivity.h5", "channel_slope"),
    ("sensitivity.h5", "figure_slope"),
    ("optimum.h5", "objective"),
    ("optimum.h5", "front_objective"),
    ("identified.h5", "sample_measured"),
    ("uncertainty.h5", "shares"),
    ("manoeuvre.h5", "control_value"),
]


@pytest.mark.parametrize("values", [np.zeros((2, 3, 4, 5)), np.array([b"a", b"b"])])
@pytest.mark.parametrize(("name", "place"), NOT_FITTING)
def test_tables_whose_arrays_do_not_fit(name, place, values):
    def change(file):
        assert place in file, list(file)
        attributes = {k: v for k, v in file[place].attrs.items() if k.islower()}
        del file[place]
        file.create_dataset(place, data=values).attrs.update(attributes)

    refused(Case("table", {name: changed(name, change)}, ["report", name]), "is damaged (")


@pytest.mark.parametrize(
    "values", [np.float64(5.5), np.zeros(7), np.arange(4), np.array([b"a"] * 4), np.zeros((0, 3))]
)
def test_modes_of_which_only_some_numbers_are_read(values):
    """The damping ratio follows from eigenvalues; who exports all numbers reads it as well."""

    def change(file):
        del file["case_1/damping_ratio"]
        file["case_1"].create_dataset("damping_ratio", data=values)

    command = ["export-data", "modes.h5", "-o", "out.csv"]
    files = {"modes.h5": changed("modes.h5", change)}
    refused(Case("modes", files, command), "is damaged (damping_ratio of shape")


def test_a_scene_that_is_not_in_the_file():
    def change(file):
        del file["scene/outline"]
        file.create_dataset("scene/outline", (10**12,), "f8", chunks=(1000,))

    words = "is damaged (outline is not in the file)"
    refused(Case("scene", {"car.h5": changed("car.h5", change)}, ["animate", "car.h5"]), words)


@pytest.mark.parametrize(
    ("name", "place"),
    [
        ("cam.h5", "pressure_angle"),
        ("track.h5", "cant"),
        ("tyre.h5", "tyre_1/combined"),
    ],
)
def test_tables_without_a_column_that_is_drawn(name, place):
    def change(file):
        del file[place]
        if "columns" in file:
            names = [n for n in file["columns"].asstr()[()] if n != place]
            del file["columns"]
            file["columns"] = names

    words = f"({place.rpartition('/')[2]} is not there)"
    refused(Case("table", {name: changed(name, change)}, ["plot", name]), words)


def test_a_result_of_no_tyre():
    def change(file):
        del file["tyre_1"]

    refused(Case("t", {"tyre.h5": changed("tyre.h5", change)}, ["info", "tyre.h5"]), "no tyre")


def test_a_response_whose_imaginary_part_is_shorter():
    def change(file):
        values = file["response_imag"][()]
        del file["response_imag"]
        file["response_imag"] = values[:, :, :0]

    words = ["export-data", "response.h5", "-o", "out.csv"]
    refused(Case("response", {"response.h5": changed("response.h5", change)}, words), "is damaged")


@pytest.mark.parametrize(
    ("name", "place"), [("run.h5", "states/long_name"), ("modes.h5", "channel")]
)
def test_a_text_longer_than_the_file(name, place):
    """HDF5 makes room for it before it looks: 3.4 GB."""
    import h5py

    content = bytearray(changed(name, lambda file: None))
    with h5py.File(io.BytesIO(bytes(content)), "r") as file:
        start = file[place].id.get_offset()
    content[start : start + 4] = (3_372_220_439).to_bytes(4, "little")
    words = f"texts of {place} that are longer than the file"
    refused(Case("text", {name: bytes(content)}, ["plot", name, "--format", "png"]), words)


def test_parameters_that_are_a_list():
    files = yaml_cases.around({})
    text = files["systems/quarter_car.yaml"].decode()
    files["systems/quarter_car.yaml"] = re.sub(
        r"^parameters:.*?^(?=\w)", "parameters: [{a: 1}]\n", text, flags=re.DOTALL | re.MULTILINE
    ).encode()
    command = ["validate", "scenarios/systems/quarter_car.yaml", "--set", "parameters.a=2"]
    refused(Case("list", files, command), "parameters: expected a mapping, found a list")


def test_a_motion_whose_first_time_is_no_number():
    table = table_cases.MOTION.replace("0, 0", "nan, 0", 1)
    files = yaml_cases.around({"motion.csv": table.encode()})
    command = ["inverse", "scenarios/systems/slider_crank.yaml", "--motion", "motion.csv"]
    refused(Case("motion", files, command), "motion.csv: a value is no finite number")


def test_a_cam_with_a_roller_beyond_all_bounds():
    text = re.sub("follower:.*", "follower: {kind: roller, radius: 1e308 m}", ECCENTRIC)
    words = "follower.radius: is longer than 1e+06 m"
    refused(Case("cam", {"cam.yaml": text.encode()}, ["cam", "cam.yaml"]), words)


def test_a_response_without_bounds_is_written_without_a_warning():
    def change(file):
        values = file["response_imag"][()]
        values[...] = np.inf
        file["response_imag"][...] = values

    words = ["export-data", "response.h5", "-o", "out.csv"]
    files = {"response.h5": changed("response.h5", change)}
    assert run(Case("response", files, words, ("out.csv",))).faults == []


@pytest.mark.parametrize("name", ["", ".", "/"])
@pytest.mark.parametrize("verb", ["handling", "steady"])
def test_names_that_name_no_file(verb, name):
    refused(Case("name", {}, [verb, name]), "names no file; give the name of one")


def test_a_weave_quicker_than_its_samples():
    text = yaml_cases.scenario_texts()["scenarios/iltis_ramp_steer.yaml"]
    weave = "manoeuvre:\n  kind: weave\n  amplitude: 1 deg\n  frequency: 1e13 Hz\n  begin: 0 s\n"
    text = re.sub(r"^manoeuvre:.*?^(?=\w)", weave, text, flags=re.DOTALL | re.MULTILINE)
    sets = ["duration=20 ms", "output.interval=5 ms", "solver={kind: rk4, step: 1 ms}"]
    command = ["run", "a.yaml", "-o", "out.h5", "--no-plots", "-q", "--backend", "interpreted"]
    command += [word for item in sets for word in ("--set", item)]
    outcome = run(Case("weave", {"a.yaml": text.encode()}, command, ("out.h5",)))
    assert (outcome.code, outcome.faults) == (0, []), outcome


def test_a_summary_that_holds_records():
    import h5py

    def change(file):
        entry = file["summary/speed_mean"]
        about = dict(entry.attrs)
        del file["summary/speed_mean"]
        record = np.zeros(1, dtype=[("a", "<i4"), ("b", "<f8")])
        new = file["summary"].create_dataset("speed_mean", data=record)
        for key, value in about.items():
            if not isinstance(value, h5py.Reference):
                new.attrs[key] = value

    words = "summary/speed_mean is neither number nor text"
    refused(Case("summary", {"car.h5": changed("car.h5", change)}, ["report", "car.h5"]), words)


def test_an_experiment_without_signals():
    text = mechanism_cases.STUDIES["identify"].replace("      upper.angle: {noise: 1 mrad}\n", "")
    files = yaml_cases.around({
        "study.yaml": text.encode(), "measured.csv": mechanism_cases.MEASURED.encode(),
    })  # fmt: skip
    command = ["identify", "study.yaml", "-o", "out.h5"]
    refused(Case("identify", files, command, ("out.h5",)), "needs signals")


def test_a_scatter_of_nothing():
    lines = mechanism_cases.STUDIES["uncertainty"].splitlines(keepends=True)
    text = "".join(line for line in lines if not line.startswith("of:"))
    files = yaml_cases.around({"study.yaml": text.encode()})
    refused(Case("scatter", files, ["uncertainty", "study.yaml"]), "of: missing")


def test_more_starts_than_memory_holds():
    text = mechanism_cases.STUDIES["optimise"] + "starts: 1000000000\n"
    files = yaml_cases.around({"study.yaml": text.encode()})
    refused(Case("starts", files, ["validate", "study.yaml"]), "a whole number of at most 10000")


def test_gaps_between_samples_are_not_filled_without_end():
    time = np.append(0.005 * np.arange(20.0), 1e9)
    with pytest.raises(InputError, match="leave gaps beside steps of"):
        even_samples(time, {})
    with pytest.raises(InputError, match="are too long to assess"):
        sliding_mean(signal_of(np.array([0.0, 1e300])), signal_of(np.zeros(2)), window=2.0, every=1)


def test_a_film_of_more_pictures_than_anyone_sees(tmp_path):
    scene = SimpleNamespace(time=np.array([0.0, 1e12]))
    given = {"view": "angle", "rate": 15, "speed": 1.0, "progress": lambda *_: None}
    with pytest.raises(InputError, match="pictures is too long, 20000 at most"):
        draw_film(scene, tmp_path / "a.gif", **given)


def test_a_path_longer_than_pictures_true_to_scale_show():
    files = {"car.h5": changed("car.h5", far_away)}
    outcome = run(Case("path", files, ["plot", "car.h5", "--only", "path"], ("car_plots",)))
    assert (outcome.code, outcome.faults) == (0, []), outcome
    assert outcome.seconds < 5.0


def far_away(file):
    file.pop("checksums", None)
    for name in ("chassis/x", "chassis/y"):
        values = file[name][()]
        file[name][...] = values * 1e5
    file["chassis/x"][-1] = 1e7


def test_forces_of_more_samples_than_memory_holds():
    command = ["inverse", "scenarios/systems/slider_crank.yaml", "-o", "out.h5"]
    command += ["--set", "duration=1 s", "--set", "output.interval=2e-8 s"]
    files = yaml_cases.around({"motion.csv": table_cases.MOTION.encode()})
    case = Case("inverse", files, [*command, "--motion", "motion.csv"])
    refused(case, "gives 50000001 samples, and forces of at most")


def test_derivatives_of_more_samples_than_memory_holds():
    check_size(10_000, 10_000)
    with pytest.raises(InputError, match="more than fit the memory; take a longer one"):
        check_size(20_000_000, 40)


BLANKS = " " * 100_000


@pytest.mark.parametrize(
    "read",
    [
        lambda: to_si(f"1 a{BLANKS}b", "m"),
        lambda: to_si(f"1{BLANKS}", "m"),
        lambda: parse_unit("m " * 50_000),
        lambda: read_expression(f"1{BLANKS[:1900]}!"),
        lambda: read_expression("1" * 1999 + "!"),
        lambda: read_columns_of(f"x [{BLANKS}a{BLANKS}\n1\n"),
        lambda: read_columns_of(f"x{BLANKS}!{BLANKS}\n1\n"),
        lambda: slope_of("9" * 400 + ":1") or refuse(),
    ],
)
def test_texts_are_read_in_time_that_grows_with_their_length(read):
    """Blanks that a pattern could share out in many ways took seconds for each kilobyte."""
    begin = time.process_time()
    with pytest.raises((InputError, ExpressionError)):
        read()
    assert time.process_time() - begin < 0.3


def read_columns_of(text):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "a.csv")
        file.write_text(text)
        return read_columns(file, {"x": ColumnKind("m")})


def refuse():
    raise InputError("no slope")


@pytest.mark.parametrize("field", ["curvature", "direction", "at"])
def test_one_number_in_place_of_a_vector(field):
    text = mechanism_cases.BEAM.replace("SECTION", mechanism_cases.SECTIONS[0])
    text = text.replace("    frames:", f"    {field}: sin(1)\n    frames:", 1)
    files = {"beam.yaml": text.encode()}
    refused(Case("beam", files, ["validate", "beam.yaml"]), f"elements.rod.{field}: expected a vec")


@pytest.mark.parametrize(
    ("section", "words"),
    [("MDI_HEADER", "it belongs in [LONGITUDINAL_COEFFICIENTS]"), ("UNITS", "no dimension named")],
)
def test_a_coefficient_among_the_heads_of_a_tyre_file(section, words):
    text = road_file_cases.tyres()[1]
    line = next(line for line in text.splitlines() if line.startswith("REX2"))
    moved = text.replace(f"{line}\n", "").replace(f"[{section}]\n", f"[{section}]\n{line}\n")
    refused(Case("tyre", {"a.tir": moved.encode()}, ["tyre", "a.tir"]), words)


ROLLERS = """
title: Rollers
parameters: {arm: 0.8 m, radius: 0.1 m}
bodies:
  first: {joints: [R2 angle], mass: 3 kg, com: [0, 0, 0.5 m]}
repeat:
- for: {k: {from: 2, to: 3000}}
  bodies:
    roller_{k}: {parent: first, joints: [R2 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 0]}
  constraints:
    rolls_{k}:
      kind: rate_expression
      zero: arm * first.angle_rate + radius * roller_{k}.angle_rate
"""


@pytest.mark.long
@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("1 kg*m^2, 0]", "1 kg*m^2, 0 kg*m^2]", ""),
        ("roller_{k}.angle_rate", "roler_{k}.angle_rate", "did you mean 'roller_"),
        ("parent: first", "parent: 'roller_{k - 1}'", "no body named 'roller_1'"),
        ("parent: first", "parent: 'missing_{k}'", "no body named 'missing_2'"),
        ("Rollers", f"Rollers\ninitial: {{{', '.join(f'a{k}: 1 rad' for k in range(3000))}}}",
         "no coordinate named 'a0'"),
    ],
)  # fmt: skip
def test_thousands_of_parts_are_checked_at_once(old, new, words):
    text = ROLLERS.replace(old, new)
    outcome = run(Case("many", {"many.yaml": text.encode()}, ["validate", "many.yaml"]))
    assert (outcome.code, outcome.faults) == (2 if words else 0, []), outcome
    assert words in outcome.text
