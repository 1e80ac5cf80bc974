"""Every command and every listing of README and CONTRIBUTING works."""

import math
import re
import shutil
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from programs import run

import vehicledyn
from vehicledyn.results.store.reader import open_result

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
SLALOM = "scenarios/iltis_slalom.yaml"
FILE = re.compile(r"^# (\S+)\n")


def blocks(text, language):
    return [body for kind, body in BLOCK.findall(text) if kind == language]


def test_readme_begins_with_installing_and_running_then_testing():
    first, second = blocks(README, "sh")[:2]
    assert first.strip().endswith("/pip install . && .venv/bin/vehicledyn run " + SLALOM)
    assert second.strip().endswith('/pip install ".[test]" && .venv/bin/pytest')
    assert (ROOT / SLALOM).is_file()


def test_listings_of_the_readme(tmp_path):
    (scenario,) = blocks(README, "yaml")
    (tmp_path / "my_ramp.yaml").write_text(scenario, encoding="utf-8")
    for block in blocks(README, "sh")[2:]:
        for line in block.splitlines():
            run(line, tmp_path)
    with open_result(tmp_path / "loaded.h5") as loaded, open_result(tmp_path / "light.h5") as light:
        heavier = loaded.as_frame().filter(like="normal_force").iloc[0].sum()
        lighter = light.as_frame().filter(like="normal_force").iloc[0].sum()
    assert heavier - lighter == pytest.approx(300 * 9.81, rel=1e-6)
    assert (tmp_path / "loaded_plots" / "path.png").is_file()
    assert "<testsuite " in (tmp_path / "report.xml").read_text()


def test_twenty_lines_of_python_load_change_simulate_plot_sweep_and_compare(tmp_path):
    (listing,) = blocks(README, "python")
    assert len(listing.splitlines()) <= 20
    printed = run([sys.executable, "-W", "error", "-c", listing], tmp_path)
    assert "chassis.roll (time: 501) [rad]  Roll angle" in printed
    assert re.search(r"^0\.\d+ m$", printed, re.MULTILINE)
    speeds = re.findall(r"^[01] +(\d\.\d+) +(0\.\d+)$", printed, re.MULTILINE)
    assert [float(speed) for speed, _ in speeds] == pytest.approx([30 / 3.6, 35 / 3.6], rel=1e-6)
    assert float(speeds[0][1]) < float(speeds[1][1]), "it rolls more at the higher speed"
    assert "different: result against reference" in printed
    assert "chassis.mass = 1500 kg" in printed
    assert (tmp_path / "roll.png").is_file()
    with open_result(tmp_path / "loaded.h5") as result:
        assert result.is_whole


def test_readme_lists_every_command_and_folder():
    told = set(re.findall(r"^\| `(\w+)", README, re.MULTILINE))
    listed = run(["vehicledyn", "--help"], ROOT).partition("Commands:")[2]
    assert told == set(re.findall(r"^  (\w+)", listed, re.MULTILINE))
    packages = {path.parent.name for path in (ROOT / "vehicledyn").glob("*/__init__.py")}
    assert packages <= set(re.findall(r"\(vehicledyn/(\w+)\)", README))


@pytest.mark.parametrize("text", [README, CONTRIBUTING], ids=["readme", "contributing"])
def test_links_lead_to_files(text):
    links = re.findall(r"\]\(([^)#:]+)\)", text)
    assert links
    assert [link for link in links if not (ROOT / link).exists()] == []


END_STOP = """
import vehicledyn.integrate
from vehicledyn.base.registry import find
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, derive
from vehicledyn.multibody.stop import EndStop
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.integrate.simulate import simulate

ball = Body("ball", GROUND, joints=(Joint("T3", "height", start=-1.0),), mass=1.0)
stop = EndStop("stop", "height", 0.0, 0.5)
system = System("ball", ParameterTable(), (ball,), parts=(stop,), gravity=(0.0, 0.0, 9.81))
simulate(
    compile_kernel(derive(system), backend="interpreted"), find("solver", "rk4")(step=0.01),
    start=0.0, stop=1.2, interval=0.1, state=[-1.0, 0.0], unknowns=[],
    sink=lambda *samples: None, happened=lambda name, time: print(time),
)
"""


LAWS = """
import vehicledyn.catalogue
from vehicledyn.base.registry import find
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, derive
from vehicledyn.multibody.elements.coordinate_forces import CoordinateForce
from vehicledyn.rail.creep.creep_law import CreepContact, kalker_forces
from vehicledyn.rail.geometry.hertz import ContactEllipse

last = []
mass = Body("mass", GROUND, joints=(Joint("T1", "x", start=1.0),), mass=1.0)
pull = lambda situation: -4.0 * situation.kinematics.coordinate("x")
spring = CoordinateForce("spring", "x", pull)
system = System("oscillator", ParameterTable(), (mass,), parts=(spring,))
simulate(
    compile_kernel(derive(system), backend="interpreted"),
    find("solver", "rk23")(relative_tolerance=1e-7, absolute_tolerance=1e-9),
    start=0.0, stop=1.0, interval=0.1, state=[1.0, 0.0], unknowns=[],
    sink=lambda t, x, z, y: last.extend(x[:, 0]),
)
print(last[-1])
law = find("creep", "exponential")(friction=0.3)
felt = lambda xi: CreepContact(xi, 0.0, 0.0, 5e4, ContactEllipse(5e-3, 5e-3), 8.2e10, 0.28, 0.0)
print(law.forces(felt(0.1)).longitudinal)
linear = kalker_forces(felt(1e-6), law.stiffness_factor).longitudinal
print(law.forces(felt(1e-6)).longitudinal / linear)
"""


def test_examples_of_contributing_make_a_vehicle_that_changes_the_lane(tmp_path):
    """Each example is put where its first line says, into a copy of the package, and runs."""
    shutil.copytree(Path(vehicledyn.__file__).parent, tmp_path / "vehicledyn")
    examples = [*blocks(CONTRIBUTING, "python"), *blocks(CONTRIBUTING, "yaml")]
    assert len(examples) == 15
    for example in examples:
        path = tmp_path / FILE.match(example)[1]
        if path.exists():  # shown as an example, and part of the package
            assert path.read_text(encoding="utf-8") == example.partition("\n")[2]
            continue
        path.parent.mkdir(exist_ok=True)
        path.write_text(example, encoding="utf-8")
    command = [sys.executable, "-m", "vehicledyn", "run", "scenarios/lane_change.yaml"]
    run([*command, "--no-plots"], tmp_path, PYTHONSAFEPATH="")
    with open_result(tmp_path / "lane_change.h5") as result:
        assert result.is_whole
        table = result.as_frame()
    assert table["chassis.y"].iloc[-1] == pytest.approx(3.0, abs=0.1)
    assert np.allclose(table["air_drag.force"], -0.5 * 1.2 * 1.6 * 15.0**2, rtol=0.01)
    assert 0.1 < table["load.first_angle"].abs().max() < 1.0  # swings, does not go over
    impacts = run([sys.executable, "-c", END_STOP], tmp_path, PYTHONSAFEPATH="").split()
    # From rest, 1 m above: after √(2h/g), then flights of 2 e √(2h/g) and e times that.
    fall = math.sqrt(2.0 / 9.81)
    expected = [fall, 2.0 * fall, 2.5 * fall]
    assert [float(time) for time in impacts] == pytest.approx(expected, abs=1e-6)
    angle, sliding, sticking = run(
        [sys.executable, "-c", LAWS], tmp_path, PYTHONSAFEPATH=""
    ).split()
    assert float(angle) == pytest.approx(math.cos(2.0), abs=1e-5)
    assert float(sliding) == pytest.approx(-0.3 * 5e4, rel=1e-3)
    assert float(sticking) == pytest.approx(1.0, abs=1e-3)
    model = f"MODEL = {str(ROOT / 'systems' / 'quarter_car.yaml')!r}\n"
    *_, difference, squared = run(
        [sys.executable, "-c", model + ANALYSIS_AND_PASS], tmp_path, PYTHONSAFEPATH=""
    ).splitlines()
    assert float(difference) == pytest.approx(0.0, abs=1e-12)
    assert squared == "(sq(x)*y) 18.0"


ANALYSIS_AND_PASS = """
import casadi as ca
import vehicledyn as vd
from vehicledyn.analyses.linear.least_damping import find_least_damping
from vehicledyn.codegen.passes.squares import use_squares

found = find_least_damping(vd.load(MODEL), backend="interpreted", progress=print)
modes = vd.modes(MODEL, backend="interpreted")
ratios = modes["damping_ratio"].values[modes["kind"].values == "oscillation"]
print(found.damping_ratio - min(ratios))
x, y = ca.SX.sym("x"), ca.SX.sym("y")
written = ca.SX.binary(ca.OP_POW, x, 2.0) * y
(squared,) = use_squares(ca.Function("f", [x, y], [written]), [x, y])
print(str(squared), float(ca.Function("g", [x, y], [squared])(3.0, 2.0)))
"""


def test_all_data_files_are_packed():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    kept = project["tool"]["setuptools"]["package-data"]
    packages = {path.parent for path in (ROOT / "vehicledyn").rglob("__init__.py")}
    files = [
        path
        for path in (ROOT / "vehicledyn").rglob("*")
        if path.is_file() and path.suffix not in (".py", ".pyc")
    ]
    assert len(files) >= 5
    for path in files:
        folder = next(parent for parent in path.parents if parent in packages)
        package = ".".join(folder.relative_to(ROOT).parts)
        patterns = [*kept["*"], *kept.get(package, ())]
        depth = len(path.relative_to(folder).parts)
        fitting = [pattern for pattern in patterns if pattern.count("/") == depth - 1]
        assert any(path.match(pattern) for pattern in fitting), path
