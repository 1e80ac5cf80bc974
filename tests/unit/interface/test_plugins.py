"""A user's own laws are loaded by a file or an installed package, and by nothing else."""

import os
import re
import subprocess
import sys

import pytest

import vehicledyn as vd
import vehicledyn.catalogue
from vehicledyn.base import plugins, registry
from vehicledyn.cli.exit_codes import INPUT
from vehicledyn.cli.unforeseen import describe_failure

pytestmark = pytest.mark.long

SPRING = '''\
"""A tyre of the user's own."""

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.tyres.tyre import Tyre, TyreForces, TyreInput


@register("tyre", "NAME")
class Own(Tyre):
    """Force in proportion to the slip angle."""

    stiffness: float = quantity("N/rad", "Slope of the lateral force", gt=0)

    def forces(self, contact: TyreInput) -> TyreForces:
        """Return the force against the slip."""
        return TyreForces(0.0, -self.stiffness * contact.slip_angle, 0.0)
'''
SCENARIO = """\
title: On own tyres
model: iltis
tyres: {kind: own_of_test, stiffness: 60 kN/rad}
road: {kind: flat}
wheel_spin: free
speed: 15 m/s
manoeuvre: {kind: straight}
duration: 1 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""


@pytest.fixture(autouse=True)
def catalogues_as_before():
    before = {family: set(entries) for family, entries in registry._catalogues.items()}
    loaded = dict(plugins._loaded)
    yield
    for family, entries in registry._catalogues.items():
        for name in set(entries) - before.get(family, set()):
            if "own_" in name or "bare_" in name:
                del entries[name]
    plugins._loaded.clear()
    plugins._loaded.update(loaded)


def written(folder, text=SPRING, name="own_of_test", file="my_tyre.py"):
    path = folder / file
    path.write_text(text.replace("NAME", name), encoding="utf-8")
    return path


def command(folder, *words):
    return subprocess.run(
        [sys.executable, "-m", "vehicledyn", *map(str, words)], cwd=folder, check=False,
        env=os.environ | {"PYTHONPATH": str(folder)}, capture_output=True, text=True, timeout=120,
    )  # fmt: skip


def test_a_law_is_known_once_its_file_is_loaded(tmp_path):
    (tmp_path / "own.yaml").write_text(SCENARIO, encoding="utf-8")
    with pytest.raises(vd.InputError, match="no tyre named 'own_of_test'"):
        vd.load(tmp_path / "own.yaml")
    path = written(tmp_path)
    assert vd.load_plugin(path) == [("tyre", "own_of_test")]
    assert vd.load_plugin(str(path)) == [("tyre", "own_of_test")]
    loaded = vd.load(tmp_path / "own.yaml")
    assert loaded.scenario.tyres.front.stiffness == 60e3


@pytest.mark.parametrize(
    ("text", "name", "words"),
    [
        (SPRING, "linear", r"my_tyre\.py:8: .*tyre 'linear' is registered twice; vehicledyn\.road"),
        (SPRING + "\n1 / 0\n", "own_of_test", r"my_tyre\.py:18: .*ZeroDivisionError"),
        ("def f(:\n", "", r"my_tyre\.py:1: .*SyntaxError"),
        ("import no_such_module\n", "", r"my_tyre\.py:1: .*ModuleNotFoundError: No module named"),
        ("import sys\nsys.exit(3)\n", "", r"my_tyre\.py:2: .*SystemExit"),
        (SPRING + SPRING, "own_of_test", "registered twice"),
        (
            SPRING.replace('"tyre"', '"tyer"'),
            "own_of_test",
            r"my_tyre\.py: no catalogue named 'tyer'; did you mean 'tyre'",
        ),
        (
            SPRING.replace("def forces", "def force"),
            "own_of_test",
            r"my_tyre\.py:8: .*tyre 'own_of_test' lacks forces",
        ),
    ],
)
def test_a_plugin_that_fails_is_one_message_and_registers_nothing(tmp_path, text, name, words):
    if text == SPRING + SPRING:
        text = text.replace("class Own", "class First", 1)
    before = registry.kinds("tyre")
    path = written(tmp_path, text, name)
    with pytest.raises(vd.InputError, match=words):
        vd.load_plugin(path)
    assert registry.kinds("tyre") == before
    assert str(path) not in plugins.loaded_plugins()


def test_a_name_that_another_plugin_has_names_its_file(tmp_path):
    first = written(tmp_path, SPRING, "own_taken_of_test")
    second = first.with_name("second.py")
    second.write_text(first.read_text(encoding="utf-8"), encoding="utf-8")
    vd.load_plugin(first)
    with pytest.raises(vd.InputError, match=rf"second\.py:8: .*twice; {re.escape(str(first))} has"):
        vd.load_plugin(second)


def test_a_law_that_fails_later_is_no_bug_of_the_program(tmp_path):
    """The message names its line; where none is at fault, it says that a plugin was loaded."""
    begin = "        return TyreForces"
    text = SPRING.replace(begin, "        1 // 0\n" + begin)
    error = written(tmp_path, text, "own_error_of_test")
    vd.load_plugin(error)
    law = registry.find("tyre", "own_error_of_test").model_construct()
    with pytest.raises(ZeroDivisionError) as failed:
        law.forces(None)
    line = text.splitlines().index("        1 // 0") + 1
    assert describe_failure(failed.value) == (
        f"{error}:{line}: the plugin failed: ZeroDivisionError: {failed.value}",
        INPUT,
    )
    other, _ = describe_failure(TypeError("x"))
    assert other.startswith("this is a bug of vehicledyn or of a plugin: TypeError")


def test_what_is_no_python_file_is_refused(tmp_path):
    with pytest.raises(vd.InputError, match="there is no such file"):
        vd.load_plugin(tmp_path / "none.py")
    with pytest.raises(vd.InputError, match="a plugin is a Python file"):
        vd.load_plugin(tmp_path / "own.yaml")


def test_a_plugin_may_import_what_lies_beside_it(tmp_path):
    (tmp_path / "numbers_of_test.py").write_text("NAME = 'own_of_test'\n", encoding="utf-8")
    text = SPRING.replace('"NAME"', "NAME").replace(
        "from vehicledyn.base.parameters", "from numbers_of_test import NAME\n"
        "from vehicledyn.base.parameters", 1,
    )  # fmt: skip
    path = tmp_path / "my_tyre.py"
    path.write_text(text, encoding="utf-8")
    paths = list(sys.path)
    assert vd.load_plugin(path) == [("tyre", "own_of_test")]
    assert sys.path == paths


def test_the_command_line_takes_it_before_and_after_the_verb(tmp_path):
    written(tmp_path)
    (tmp_path / "own.yaml").write_text(SCENARIO, encoding="utf-8")
    without = command(tmp_path, "validate", "own.yaml")
    assert without.returncode == 2 and "no tyre named 'own_of_test'" in without.stderr
    for words in (("--plugin", "my_tyre.py", "validate"), ("validate", "--plugin", "my_tyre.py")):
        done = command(tmp_path, *words, "own.yaml")
        assert (done.returncode, done.stdout) == (0, "own.yaml: ok\n"), done.stderr
    wrong = command(tmp_path, "run", "own.yaml", "--plugin", "none.py")
    assert (wrong.returncode, wrong.stderr) == (2, "none.py: there is no such file\n")


def test_an_installed_package_brings_laws_with_it(tmp_path):
    written(tmp_path, file="own_tyres.py")
    info = tmp_path / "own_tyres-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Name: own-tyres\nVersion: 1.0\n", encoding="utf-8")
    (info / "entry_points.txt").write_text(
        "[vehicledyn.plugins]\ntyres = own_tyres\n", encoding="utf-8"
    )
    (tmp_path / "own.yaml").write_text(SCENARIO, encoding="utf-8")
    done = command(tmp_path, "validate", "own.yaml")
    assert (done.returncode, done.stdout) == (0, "own.yaml: ok\n"), done.stderr
    (tmp_path / "own_tyres.py").write_text("1 / 0\n", encoding="utf-8")
    done = command(tmp_path, "validate", "own.yaml")
    assert done.returncode == 2
    assert "plugin 'tyres' of own-tyres" in done.stderr and "own_tyres.py:1" in done.stderr


@pytest.mark.long
def test_the_processes_of_a_sweep_know_it(tmp_path):
    vd.load_plugin(written(tmp_path))
    (tmp_path / "own.yaml").write_text(SCENARIO, encoding="utf-8")
    study = vd.sweep(
        tmp_path / "own.yaml", vary={"tyres.stiffness": ["50 kN/rad", "60 kN/rad"]},
        duration="0.1 s", channels=["chassis.x"], workers=2,
    )  # fmt: skip
    assert study["case.status"].values.tolist() == ["done", "done"]


WIND = '''\
"""Wind on a body."""

from dataclasses import dataclass

from vehicledyn.base.registry import register
from vehicledyn.multibody.model.declaration import body_name, number
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Wrench
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel


@register("element_type", "own_wind")
@dataclass(frozen=True)
class OwnWind(BasePart):
    """A constant push along the first axis of a body."""

    body: str = body_name("The body", may_be_ground=False)
    push: float = number("N", "The push", above=0.0)

    def loads(self, situation):
        """Return the push."""
        along, none = ops.vector(self.push, 0, 0), ops.vector(0, 0, 0)
        return Loads(wrenches=(Wrench(self.body, along, none),))

    def outputs(self, situation):
        """Return the push."""
        return (Output(Channel(f"{self.name}.push", "N", "Push of the wind"), self.push),)
'''
SLED = """\
title: A sled in the wind
parameters: {gust: 6 N}
bodies: {sled: {joints: [T1 x], mass: 3 kg}}
elements: {wind: {kind: own_wind, body: sled, push: gust / 2}}
"""

RUN = """\
title: A sled in the wind
model: sled.yaml
duration: 1 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""


def test_an_element_of_the_users_own_works_everywhere(tmp_path):
    written(tmp_path, WIND, file="my_wind.py")
    (tmp_path / "sled.yaml").write_text(SLED, encoding="utf-8")
    without = command(tmp_path, "validate", "sled.yaml")
    assert without.returncode == 2 and "no element named 'own_wind'" in without.stderr
    own = ("--plugin", "my_wind.py")
    shown = command(tmp_path, "models", "show", "sled.yaml", *own)
    assert "wind.push" in shown.stdout and "Push of the wind" in shown.stdout, shown.stderr
    schema = command(tmp_path, "schema", "--of", "system", *own)
    assert '"element.own_wind"' in schema.stdout and "The push [N]" in schema.stdout, schema.stderr
    script = (
        "import vehicledyn as vd; vd.load_plugin('my_wind.py'); "
        "r = vd.simulate('sled.yaml', duration='2 s'); print(r['sled.x'].values[-1])"
    )
    environment = os.environ | {"PYTHONPATH": str(tmp_path)}
    seen = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, check=False, env=environment,
        capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert float(seen.stdout) == pytest.approx(0.5 * (3.0 / 3.0) * 2.0**2, rel=1e-9), seen.stderr


def test_a_run_with_an_element_of_the_users_own_is_not_remembered(tmp_path):
    """The file of the plugin may have changed since."""
    from vehicledyn.analyses.preparation.memory.run_cache import key_of_run

    vd.load_plugin(written(tmp_path, WIND, file="my_wind.py"))
    (tmp_path / "sled.yaml").write_text(SLED, encoding="utf-8")
    (tmp_path / "run.yaml").write_text(RUN, encoding="utf-8")
    assert key_of_run(vd.load(tmp_path / "run.yaml")) is None
    drag = "{kind: air_drag, body: sled, drag_area: 1 m^2}"
    text = SLED.partition("elements")[0] + f"elements: {{wind: {drag}}}\n"
    (tmp_path / "sled.yaml").write_text(text, encoding="utf-8")
    assert key_of_run(vd.load(tmp_path / "run.yaml")) is not None


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("push: gust / 2", "push: gust * 1 m", "push: this is in J|push: this is in N.m"),
        ("push: gust / 2", "push: -1 N", "push: must be greater than 0 N"),
        ("body: sled,", "body: ground,", "the ground needs no force"),
        ("body: sled,", "body: slet,", "no body named 'slet'; did you mean 'sled'"),
        (", push: gust / 2", "", "push: missing: The push"),
    ],
)
def test_its_fields_are_checked_as_they_are_declared(tmp_path, old, new, words):
    vd.load_plugin(written(tmp_path, WIND, file="my_wind.py"))
    path = tmp_path / "sled.yaml"
    path.write_text(SLED.replace(old, new), encoding="utf-8")
    with pytest.raises(vd.InputError, match=rf"sled\.yaml:4:\d+: elements\.wind.*({words})"):
        vd.load(path)


def test_a_field_without_declaration_is_refused(tmp_path):
    text = WIND.replace('number("N", "The push", above=0.0)', "0.0").replace("own_", "bare_")
    vd.load_plugin(written(tmp_path, text, file="my_wind.py"))
    (tmp_path / "sled.yaml").write_text(SLED.replace("own_", "bare_"), encoding="utf-8")
    with pytest.raises(vd.InputError, match="'push' has no declaration"):
        vd.load(tmp_path / "sled.yaml")
