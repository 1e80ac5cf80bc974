"""Result files of eigenmodes and frequency responses: what is written is read again."""

from dataclasses import replace

import h5py
import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.results.labelled.data import LabelledData
from vehicledyn.results.labelled.requested import save_requested, save_standard
from vehicledyn.results.plots.linear.bode import bode_figures
from vehicledyn.results.plots.linear.mode_figures import mode_figures
from vehicledyn.results.plots.picture_files import save_figures
from vehicledyn.results.plots.table_results import describe_table, holds_table
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables import mode_table
from vehicledyn.results.tables.mode_table import ModeCase, ModeTable, read_modes, write_modes
from vehicledyn.results.tables.response_table import (
    ResponseTable,
    ratio_unit,
    read_response,
    write_response,
)


def modes():
    rng = np.random.default_rng(5)

    def shape(*size):
        return rng.normal(size=size) + 1j * rng.normal(size=size)

    cases = tuple(
        ModeCase(
            speed, f"spring={speed:g} N/m", np.array([0.0, -3.0, -1.0 + 4.0j]),
            ("free", "aperiodic", "oscillation"), shape(3, 2), shape(3, 3), rng.random((3, 2)),
        )
        for speed in (0.0, 5.0)
    )  # fmt: skip
    states = (Quantity("x", "m", "Place"), Quantity("x_rate", "m/s", "Speed"))
    channels = (*states, Quantity("spring.force", "N", "Force"))
    return ModeTable("A mass", "mass", states, channels, ("x",), cases)


def response():
    frequency = np.geomspace(0.1, 10.0, 9)
    s = 2j * np.pi * frequency
    values = np.stack([1.0 / (1.0 + s), s / (1.0 + s) ** 4], axis=1)[:, None, :]
    return ResponseTable(
        "A lag", "lag", 20.0, frequency, (Quantity("u", "m", "Input"),),
        (Quantity("a.y", "rad/s", "First"), Quantity("b", "m", "Second")), values,
        np.array([[1.0, np.nan]]),
    )  # fmt: skip


def test_modes_are_read_as_they_were_written(tmp_path):
    table, path = modes(), tmp_path / "modes.h5"
    write_modes(path, table)
    again = read_modes(path)
    assert replace(again, cases=()) == replace(table, cases=())
    for one, other in zip(again.cases, table.cases, strict=True):
        assert (one.speed, one.setting, one.kind) == (other.speed, other.setting, other.kind)
        for name in ("eigenvalue", "state_shape", "channel_shape", "participation"):
            assert np.array_equal(getattr(one, name), getattr(other, name))
    with h5py.File(path) as file:
        assert file["case_2/channel_shape_real"].dims[1][0].name == "/channel"
        assert file["case_1/frequency"].attrs["units"] == "Hz"


def test_responses_are_read_as_they_were_written(tmp_path):
    table, path = response(), tmp_path / "response.h5"
    write_response(path, table)
    again = read_response(path)
    assert (again.inputs, again.outputs, again.speed) == (table.inputs, table.outputs, 20.0)
    assert np.array_equal(again.response, table.response)
    assert np.array_equal(again.static_gain, table.static_gain, equal_nan=True)
    with h5py.File(path) as file:
        assert file["phase"][-1, 0, 1] == pytest.approx(table.phase[-1, 0, 1])
        assert file["response_imag"].dims[0][0].name == "/frequency"


def test_phases_do_not_jump():
    """s/(1 + s)⁴ falls from +90 to -270 degrees without a step of 360."""
    phase = np.degrees(response().phase[:, 0, 1])
    assert phase[0] == pytest.approx(90.0 - 4.0 * np.degrees(np.arctan(0.2 * np.pi)), abs=1e-9)
    assert (np.diff(phase) < 0.0).all() and phase[-1] < -260.0


def test_the_file_is_whole_or_absent(tmp_path, monkeypatch):
    path = tmp_path / "modes.h5"
    write_modes(path, modes())
    before = path.read_bytes()

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(mode_table, "write_numbers", full)
    with pytest.raises(InputError, match="No space left on device; free some space"):
        write_modes(path, modes())
    assert path.read_bytes() == before
    assert [item.name for item in tmp_path.iterdir()] == ["modes.h5"]


def test_other_files_are_refused(tmp_path):
    path = tmp_path / "modes.h5"
    write_modes(path, modes())
    with pytest.raises(InputError, match="holds no vehicledyn-response data"):
        read_response(path)
    (tmp_path / "text.h5").write_text("no")
    assert not holds_table(tmp_path / "text.h5")
    with pytest.raises(InputError, match="is not an HDF5 file"):
        read_modes(tmp_path / "text.h5")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1.0
    with pytest.raises(InputError, match="its format is 'unknown'"):
        read_modes(tmp_path / "other.h5")
    with h5py.File(path, "a") as file:
        del file["case_2/kind"]
    with pytest.raises(InputError, match="is damaged"):
        read_modes(path)


def test_a_file_whose_format_cannot_be_read_is_called_damaged(tmp_path):
    path = tmp_path / "modes.h5"
    write_modes(path, modes())
    broken = bytearray(path.read_bytes())
    place = broken.find(b"GCOL\1")
    broken[place + 24 : place + 32] = (2**63 - 1).to_bytes(8, "little")
    path.write_bytes(broken)
    with pytest.raises(InputError, match=r"is damaged \(wrong checksum"):
        read_modes(path)


def test_figures_and_descriptions(tmp_path):
    write_modes(tmp_path / "m.h5", modes())
    write_response(tmp_path / "r.h5", response())
    drawn = save_standard({"": tmp_path / "m.h5"}, tmp_path / "p", formats=("png",))
    assert [p.name for p in drawn] == [
        "root_locus.png", "mode_shapes_case_1_page_1.png", "mode_shapes_case_2_page_1.png",
    ]  # fmt: skip
    responses = LabelledData(tmp_path / "r.h5")
    drawn = save_requested({"": responses}, tmp_path / "p", patterns=["bode_b"], formats=("svg",))
    assert [p.name for p in drawn] == ["bode_b.svg"]
    with pytest.raises(InputError, match="no channel or figure named 'bode_c'; did you mean"):
        save_requested({"": responses}, tmp_path / "p", patterns=["bode_c"], formats=("svg",))
    text = describe_table(tmp_path / "r.h5").as_text()
    assert "9 frequencies from 0.1 to 10 Hz" in text and "a.y" in text
    told = describe_table(tmp_path / "m.h5").as_dict()
    assert told["cases"] == ["spring=0 N/m", "5 m/s, spring=5 N/m"]


def test_axes_say_quantity_and_unit():
    (_, figure), *_ = bode_figures(response())
    upper, lower = figure.axes
    assert upper.get_ylabel() == "Magnitude [rad/s/m]"
    assert (lower.get_ylabel(), lower.get_xlabel()) == ("Phase [deg]", "Frequency [Hz]")
    (name, locus), *_ = mode_figures(modes())
    assert name == "root_locus"
    assert locus.axes[0].get_xlabel() == "Real part [1/s]"


def test_figures_of_undamped_modes_show_no_rounding_errors():
    (case, *_) = modes().cases
    undamped = replace(case, eigenvalue=np.array([0.0, 4.0j, -1e-15 + 5.0j]))
    table = replace(modes(), cases=(undamped,))
    (_, locus), (_, shapes) = mode_figures(table)
    assert locus.axes[0].get_xlim() == pytest.approx((-0.5, 0.5))
    assert shapes.axes[-1].get_title(loc="left").endswith(" Hz, damping ratio 0")
    assert not any(" -0°" in text.get_text() for axes in shapes.axes for text in axes.texts)


def test_pictures_of_unknown_formats_are_refused(tmp_path):
    with pytest.raises(InputError, match="picture format"):
        save_figures([], tmp_path, ("gif",))


@pytest.mark.parametrize(
    ("output", "given", "unit"),
    [("m", "m", "1"), ("rad/s", "m", "rad/s/m"), ("N", "1", "N"), ("m", "N/m", "m/(N/m)")],
)
def test_units_of_ratios(output, given, unit):
    assert ratio_unit(output, given) == unit
