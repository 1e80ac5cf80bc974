"""The FMU, simulated by an independent importer, runs as the program itself does."""

import ctypes
import re
import subprocess
import zipfile
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from export_cases import CASES, case

from vehicledyn.analyses import run_scenario
from vehicledyn.analyses.models.exporting import export_target
from vehicledyn.base.registry import find
from vehicledyn.codegen.toolchain.compiler import CompilationError, find_compiler
from vehicledyn.export.document import ExportedStart, start_of
from vehicledyn.export.fmi_description import RunDefaults
from vehicledyn.export.fmu import export_fmu
from vehicledyn.files.scenario import load_scenario
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, BasePart, Body, Joint, ParameterTable, System, derive
from vehicledyn.multibody.model.parts import PartEvent
from vehicledyn.results.store.reader import open_result

pytestmark = pytest.mark.long

fmpy = pytest.importorskip("fmpy", reason="fmpy, which simulates FMUs, is not installed")
FMU3Model = fmpy.fmi3.FMU3Model
FMICallException = fmpy.fmi1.FMICallException

ROOT = Path(__file__).parents[3]
STOP, INTERVAL = 2.0, 0.05
SAME_MOTION = 1e-6
TOLERANCE = 1e-10


@pytest.fixture(autouse=True)
def _compiler():
    try:
        find_compiler()
    except CompilationError as error:
        pytest.skip(f"{error}, which the FMU needs to run")


def own_motion(equations, values=None):
    """Times and channels by name, from the program's own integrator at the same tolerance."""
    import_solvers()
    kernel = compile_kernel(equations, backend="interpreted")
    if values is not None:
        kernel.set_parameters(values)
    start = start_of(equations)
    found = []
    simulate(
        kernel,
        find("solver", "dop853")(relative_tolerance=1e-11, absolute_tolerance=1e-11),
        start=0.0, stop=STOP, state=np.array(start.state),
        unknowns=kernel.solve_unknowns(0.0, start.state, start.unknowns),
        interval=INTERVAL, sink=lambda t, x, z, y: found.append((t, y)),
    )  # fmt: skip
    times, channels = (np.concatenate(column) for column in zip(*found, strict=True))
    return times, dict(zip((c.name for c in equations.channels), channels.T, strict=True))


def import_solvers():
    """Register the solvers."""
    import_module("vehicledyn.catalogue")


def imported_motion(path, **options):
    """The same from fmpy, which checks the description against the schema of the standard."""
    return fmpy.simulate_fmu(
        str(path), validate=True, solver="CVode", relative_tolerance=TOLERANCE, stop_time=STOP,
        output_interval=INTERVAL, record_events=False, **options,
    )  # fmt: skip


def assert_same(found, times, wanted):
    """Channels agree, measured by the largest value of each."""
    at = np.searchsorted(found["time"], times - 1e-9)
    assert found["time"][at] == pytest.approx(times, abs=1e-9)
    for name, values in wanted.items():
        scale = max(1.0, np.abs(values).max())
        assert np.abs(found[name][at] - values).max() < SAME_MOTION * scale, name


@pytest.mark.parametrize(
    "name", ["double_pendulum", "four_bar", "motor_on_a_shaker", "rod_on_curves"]
)
def test_motion(name, tmp_path):
    equations = case(name).equations
    path = export_fmu(equations, tmp_path / "model.fmu")
    times, wanted = own_motion(equations)
    assert max(np.ptp(values) for values in wanted.values()) > 0.5
    assert_same(imported_motion(path), times, wanted)


def test_parameters_and_starts_may_be_set(tmp_path):
    """A heavier, shorter rocker: the loop is closed anew by the FMU itself."""
    equations = case("four_bar").equations
    names = [p.name for p in equations.parameters]
    values = np.array([p.value for p in equations.parameters])
    values[names.index("rocker.mass")] = 3.0
    values[names.index("rocker.length")] = 0.79
    path = export_fmu(equations, tmp_path / "model.fmu")
    changed = {"rocker.mass": 3.0, "rocker.length": 0.79}
    times, wanted = own_motion(equations, values)
    assert_same(imported_motion(path, start_values=changed), times, wanted)
    _, plain = own_motion(equations)
    assert np.abs(plain["crank.angle"] - wanted["crank.angle"]).max() > 0.01


@pytest.fixture
def four_bar(tmp_path):
    """An instance of the FMU that waits in initialisation mode, and its variables by name."""
    path = export_fmu(case("four_bar").equations, tmp_path / "model.fmu")
    description = fmpy.read_model_description(str(path), validate=True)
    folder = fmpy.extract(str(path), str(tmp_path / "unpacked"))
    fmu = FMU3Model(
        guid=description.guid, unzipDirectory=folder, instanceName="test",
        modelIdentifier=description.modelExchange.modelIdentifier,
    )  # fmt: skip
    fmu.instantiate()
    fmu.enterInitializationMode(startTime=0.0)
    yield fmu, {v.name: v.valueReference for v in description.modelVariables}
    fmu.freeInstance()


def test_rates_follow_parameters_states_and_restored_points(four_bar):
    fmu, references = four_bar
    e = case("four_bar").equations
    kernel = compile_kernel(e, backend="interpreted")
    values = np.array([p.value for p in e.parameters])
    names = [p.name for p in e.parameters]

    def rates():
        return fmu.getFloat64([references[f"der({state.name})"] for state in e.states])

    def expected(x):
        kernel.set_parameters(values)
        z = kernel.solve_unknowns(0.0, x, [v.start for v in e.unknowns])
        return pytest.approx(kernel.rates(0.0, x, z), rel=1e-9)

    x = [v.start for v in e.states]
    assert rates() == expected(x)
    held = fmu.getFMUState()
    for name, value in (("gravity", 1.6), ("coupler.length", 1.09)):
        values[names.index(name)] = value
        fmu.setFloat64([references[name]], [value])
        assert fmu.getFloat64([references[name]]) == [value]
        assert rates() == expected(x)
    fmu.setFloat64([references["crank.angle"]], [0.85])
    assert rates() == expected([0.85, x[1]])
    fmu.exitInitializationMode()
    fmu.enterContinuousTimeMode()
    fmu.setContinuousStates((ctypes.c_double * 2)(0.8, 3.0), 2)
    assert rates() == expected([0.8, 3.0])
    fmu.setFMUState(held)
    values[:] = [p.value for p in e.parameters]
    assert rates() == expected(x)
    fmu.freeFMUState(held)


def test_what_cannot_be_is_refused(four_bar):
    fmu, references = four_bar
    with pytest.raises(FMICallException):
        fmu.getFloat64([10_000])
    with pytest.raises(FMICallException):
        fmu.setFloat64([references["rocker.angle"]], [1.0])
    fmu.setFloat64([references["coupler.length"]], [0.01])  # too short to reach the rocker
    with pytest.raises(FMICallException):
        fmu.exitInitializationMode()


def test_functions_are_those_of_the_standard(tmp_path):
    """The source compiles with the headers of the standard, which fmpy carries."""
    export_fmu(case("four_bar").equations, tmp_path / "model.fmu")
    with zipfile.ZipFile(tmp_path / "model.fmu") as archive:
        archive.extractall(tmp_path)
    headers = Path(fmpy.__file__).parent / "c-code"
    declared = set(re.findall(r"\b(fmi3\w+)TYPE\b", (headers / "fmi3Functions.h").read_text()))
    assert len(declared) > 70
    compiler, library = find_compiler(), tmp_path / "model.so"
    command = [
        *compiler.command, "-std=gnu11", "-DFMI3_HEADERS", f"-I{headers}", "-Werror", "-fPIC",
        "-shared", str(tmp_path / "sources" / "four_bar.c"), "-o", str(library), "-lm",
    ]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    loaded = ctypes.CDLL(str(library))
    assert [name for name in sorted(declared) if not hasattr(loaded, name)] == []


@dataclass(frozen=True)
class Floor(BasePart):
    """Throw a ball back with less speed, and end the run where it has crossed a line."""

    def events(self, situation):
        k = situation.kinematics
        return (
            PartEvent(
                "touch", k.coordinate("ball.height"), "falling",
                resets={"ball.height_rate": -0.8 * k.rate("ball.height")},
            ),
            PartEvent("line", k.coordinate("ball.way") - 1.68, "rising", terminal=True),
        )  # fmt: skip


def ball():
    joints = (
        Joint("T1", "ball.way", start_rate=1.0), Joint("T3", "ball.height", start=1.0),
    )  # fmt: skip
    body = Body("ball", GROUND, joints=joints, mass=1.0)
    return derive(System("ball", ParameterTable(), (body,), parts=(Floor("floor"),)))


def test_events_reset_states_and_end_the_run(tmp_path):
    """A bouncing ball: times of contact in closed form, height between them likewise."""
    path = export_fmu(ball(), tmp_path / "ball.fmu")
    found = imported_motion(path)
    fall = np.sqrt(2.0 / 9.81)
    speed, begin, n_bounces = 9.81 * fall, fall, 0
    for time, height in zip(found["time"], found["ball.height"], strict=True):
        while time > begin + 2.0 * 0.8 * speed / 9.81:
            speed *= 0.8
            begin += 2.0 * speed / 9.81
            n_bounces += 1
        if time <= fall:
            expected = 1.0 - 0.5 * 9.81 * time**2
        else:
            expected = 0.8 * speed * (time - begin) - 0.5 * 9.81 * (time - begin) ** 2
        assert height == pytest.approx(expected, abs=1e-6), time
    assert n_bounces == 1
    assert found["time"][-1] == pytest.approx(1.65)  # the last sample before the line


def test_description_names_everything_once(tmp_path):
    e = case("motor_on_a_shaker").equations
    path = export_fmu(e, tmp_path / "model.fmu", experiment=RunDefaults(3.0, 0.1))
    description = fmpy.read_model_description(str(path), validate=True)
    by_name = {v.name: v for v in description.modelVariables}
    assert len(by_name) == len(description.modelVariables)
    assert description.defaultExperiment.stopTime == "3.0"
    for state in e.states:
        assert by_name[state.name].causality == "output"
        assert float(by_name[state.name].start) == state.start
        assert by_name[f"der({state.name})"].derivative is by_name[state.name]
    for parameter in e.parameters:
        item = by_name[parameter.name]
        assert (item.causality, item.variability) == ("parameter", "tunable")
        assert (float(item.start), item.unit) == (parameter.value, parameter.unit)
        assert item.description == parameter.description
    for channel in e.channels:
        assert by_name[channel.name].causality == "output"
        assert by_name[channel.name].unit == channel.unit
    assert len(description.outputs) == len(e.channels)


def test_equal_systems_give_equal_files(tmp_path):
    first = export_fmu(derive(CASES["four_bar"]()), tmp_path / "a.fmu")
    second = export_fmu(derive(CASES["four_bar"]()), tmp_path / "b.fmu")
    assert first.read_bytes() == second.read_bytes()


def test_without_a_compiler_the_source_is_left(tmp_path, monkeypatch, caplog):
    monkeypatch.setenv("VEHICLEDYN_CC", "none")
    e = case("double_pendulum").equations
    path = export_fmu(e, tmp_path / "model.fmu")
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
    assert names == [
        "modelDescription.xml", "sources/double_pendulum.c", "sources/buildDescription.xml"
    ]  # fmt: skip
    assert "source only" in caplog.text


def test_start_values_may_be_given(tmp_path):
    e = case("double_pendulum").equations
    plain = start_of(e)
    start = ExportedStart(plain.parameters, (0.1, 0.2, 0.3, 0.4), plain.unknowns)
    found = imported_motion(export_fmu(e, tmp_path / "model.fmu", start))
    assert [found[v.name][0] for v in e.states] == [0.1, 0.2, 0.3, 0.4]


def test_slalom_of_the_iltis(tmp_path):
    """Step and tolerance are small enough for errors of either method not to be seen.

    Short output intervals keep the importer's first steps short, before it knows how long they
    may be.
    """
    import_solvers()
    changes = ["duration=4 s", "solver.step=0.25 ms", "output.interval=50 ms"]
    loaded = load_scenario(ROOT / "scenarios" / "iltis_slalom.yaml", changes)
    (path,) = export_target(loaded, kind="fmu", path=tmp_path, progress=silent).paths
    assert path == tmp_path / "iltis_slalom.fmu"
    output = tmp_path / "own.h5"
    run_scenario(loaded, output=output, backend="auto", progress=silent)
    found = fmpy.simulate_fmu(
        str(path), solver="CVode", relative_tolerance=1e-14, output_interval=0.01,
        record_events=False,
    )[::5]  # fmt: skip
    with open_result(output) as result:
        table = result.as_frame()
    assert found["time"] == pytest.approx(np.arange(81) * 0.05)
    for channel in table.columns:
        values = table[channel].to_numpy()
        largest = np.abs(values).max()
        if largest > 1e-9:  # others are zero but for rounding
            assert np.abs(found[channel] - values).max() < SAME_MOTION * largest, channel
    assert np.ptp(table["driver.rack"]) > 0.001


def silent(what, part=None):
    """Tell nobody."""


def test_source_is_for_any_processor(tmp_path):
    """Two wheels on rails are computed side by side where the processor can, not in an FMU."""
    import vehicledyn.catalogue
    from vehicledyn.analyses.preparation.build_model import build_subject
    from vehicledyn.files.scenario import load_model

    assert vehicledyn.catalogue
    system = build_subject(load_model(str(ROOT / "systems" / "radial_wheelset.yaml"))).system
    path = export_fmu(derive(system), tmp_path / "wheelset.fmu")
    with zipfile.ZipFile(path) as archive:
        assert any(name.startswith("binaries/") for name in archive.namelist())
