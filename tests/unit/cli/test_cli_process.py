"""The command line as users run it: in a process of its own."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import typer

from vehicledyn.cli.verbs import HOMES, command_line

pytestmark = pytest.mark.long

HEAVY = ("casadi", "h5py", "matplotlib", "numpy", "pandas", "rich", "scipy")
SCENARIOS = Path(__file__).parents[3] / "scenarios" / "systems"
STANDING = """\
title: The Iltis rolls
model: iltis
parameters: {chassis: {mass: 1300 m}}
speed: -3
"""


def command(*arguments, **options):
    environment = os.environ | options.pop("env", {})
    return subprocess.run(
        [sys.executable, "-m", "vehicledyn", *arguments],
        check=False, capture_output=True, text=True, env=environment, timeout=60, **options,
    )  # fmt: skip


def test_version_and_help():
    assert command("--version").stdout.startswith("vehicledyn ")
    assert "validate" in command("--help").stdout
    assert command("run", "--help").returncode == 0


@pytest.mark.parametrize(
    "arguments",
    [(), ("bla",), ("run",), ("run", "--bla"), ("validate",), ("models", "bla"),
     ("run", "x.yaml", "--backend", "quick"), ("compare", "a.h5", "b.h5", "--relative", "-1")],
)  # fmt: skip
def test_wrong_usage_exits_with_2(arguments):
    done = command(*arguments)
    assert done.returncode == 2
    assert "Usage: vehicledyn" in done.stderr + done.stdout
    assert "Traceback" not in done.stderr


def test_each_verb_is_found_where_it_is_said_to_be():
    """Where one verb is asked for, only its module is loaded; help lists all of them."""
    everything = typer.main.get_command(command_line()).commands
    homes = [verb for verbs in HOMES.values() for verb in verbs]
    assert {*homes, "run", "validate", "schema", "doctor"} == set(everything)
    assert set(typer.main.get_command(command_line(["valdate"])).commands) == set(everything)
    for verb, whole in everything.items():
        commands = typer.main.get_command(command_line([verb, "--help"])).commands
        assert len(commands) < len(everything)
        assert [item.name for item in commands[verb].params] == [item.name for item in whole.params]


@pytest.mark.parametrize("verb", ["--help", "--version", "validate", "schema"])
def test_quick_verbs_load_nothing_heavy(tmp_path, verb):
    scenario = tmp_path / "iltis.yaml"
    scenario.write_text(STANDING)
    said = heavy_loaded_by(verb, *([str(scenario)] if verb == "validate" else []))
    assert said.endswith("loaded []\n")
    assert f"exit code {2 if verb == 'validate' else 0}" in said


def test_help_reads_no_scenarios():
    """What reads files loads with the command that needs it."""
    said = heavy_loaded_by("--help", heavy=(*HEAVY, "vehicledyn.files", "ruamel"))
    assert said.endswith("exit code 0\nloaded []\n")


def test_validating_rails_loads_nothing_heavy():
    names = ("rail_wheelset", "radial_wheelset", "testset_wheelset")
    files = [str(SCENARIOS / f"{name}.yaml") for name in names]
    said = heavy_loaded_by("validate", *files, heavy=(*HEAVY, "vehicledyn.multibody.model.system"))
    assert said.endswith("loaded []\n")
    assert "exit code 0" in said


def test_validating_a_car_on_tyres_of_files_loads_nothing_heavy():
    said = heavy_loaded_by("validate", str(SCENARIOS / "sedan.yaml"))
    assert said.endswith("exit code 0\nloaded []\n")


def test_validating_a_vehicle_loads_the_parts_that_it_names():
    iltis = SCENARIOS.parent / "iltis_slalom.yaml"
    others = ("vehicledyn.multibody", "vehicledyn.studies.load", "vehicledyn.road.tyres.linear")
    said = heavy_loaded_by("validate", str(iltis), heavy=(*HEAVY, *others))
    assert said.endswith("exit code 0\nloaded []\n")


def heavy_loaded_by(*arguments, heavy=HEAVY):
    """Return what the command says, its exit code and the heavy modules that it loads."""
    code = (
        "import sys\nfrom vehicledyn.cli import main\n"
        f"sys.argv = ['vehicledyn', *{arguments!r}]\n"
        "try:\n    main()\nexcept SystemExit as end:\n    print('exit code', end.code)\n"
        f"print('loaded', sorted(set({heavy!r}) & set(sys.modules)))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], check=False, capture_output=True, text=True, timeout=60
    )
    return done.stdout


def test_validate_tells_every_problem_on_standard_error(tmp_path):
    scenario = tmp_path / "iltis.yaml"
    scenario.write_text(STANDING)
    done = command("validate", str(scenario), "--set", "parameters.gravity=3 kg")
    assert (done.returncode, done.stdout) == (2, "")
    assert f"{scenario}:3:30: parameters.chassis.mass: '1300 m' has the wrong unit" in done.stderr
    assert f"{scenario}:4:8: speed: must be at least 0 m/s" in done.stderr
    assert "--set parameters.gravity: '3 kg' has the wrong unit" in done.stderr


def test_schema_goes_to_a_file_or_standard_output(tmp_path):
    file = tmp_path / "schema.json"
    assert command("schema", "-o", str(file)).stdout == ""
    assert json.loads(command("schema").stdout) == json.loads(file.read_text())


def test_file_that_cannot_be_written(tmp_path):
    done = command("schema", "-o", str(tmp_path / "none" / "schema.json"))
    assert (done.returncode, done.stdout) == (2, "")
    assert "schema.json: cannot be written: No such file" in done.stderr


def test_closed_pipe_is_quiet():
    process = subprocess.Popen(
        [sys.executable, "-m", "vehicledyn", "schema"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    process.stdout.close()
    with process.stderr as messages:
        assert messages.read() == b""
    assert process.wait(60) == 141


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")  # noqa: PTH110
def test_full_standard_output_is_told():
    with open("/dev/full", "w") as full:  # noqa: PTH123
        done = subprocess.run(
            [sys.executable, "-m", "vehicledyn", "schema"],
            check=False, stdout=full, stderr=subprocess.PIPE, text=True, timeout=60,
        )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr == "standard output cannot be written: No space left on device\n"


def test_interrupt_exits_with_130():
    names = [str(SCENARIOS / "double_pendulum.yaml")] * 500
    process = subprocess.Popen(
        [sys.executable, "-u", "-m", "vehicledyn", "validate", *names],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout.readline().endswith(": ok\n")
    process.send_signal(signal.SIGINT)
    _, messages = process.communicate(timeout=60)
    assert process.returncode == 130
    assert messages == "interrupted\n"


@pytest.mark.skipif(os.name != "posix", reason="needs a POSIX shell")
@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&- >&- 2>&-"])
def test_closed_streams_are_no_bug(closed):
    done = subprocess.run(
        f"'{sys.executable}' -m vehicledyn models list {closed}",
        check=False, shell=True, capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")


def test_text_that_the_terminal_cannot_show(tmp_path):
    scenario = tmp_path / "größe.yaml"
    done = command("validate", str(scenario), env={"PYTHONIOENCODING": "ascii"})
    assert done.returncode == 2
    assert "there is no such file" in done.stderr


def test_doctor(tmp_path):
    folder = tmp_path / "cache"
    folder.mkdir()
    (folder / "abc-123.so").write_bytes(b"")
    environment = {"VEHICLEDYN_CACHE": str(folder), "VEHICLEDYN_CC": "none"}
    facts = json.loads(command("doctor", "--json", env=environment).stdout)
    assert facts["compiler"] is None
    assert "VEHICLEDYN_CC=none" in facts["compiler_remark"]
    assert (facts["cache_folder"], facts["cache_writable"]) == (str(folder), True)
    assert facts["cached_kernels"] == 1
    assert facts["packages"]["casadi"] != "not installed"
    assert facts["catalogues"]["model"] >= 1
    assert "C compiler" in command("doctor", env=environment).stdout


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="needs owners and modes")
def test_doctor_shows_a_cache_that_others_can_write(tmp_path):
    folder = tmp_path / "cache"
    folder.mkdir()
    folder.chmod(0o777)
    environment = os.environ | {"VEHICLEDYN_CACHE": str(folder)}
    told = command("doctor", env=environment).stdout
    assert f"the cache folder is not used, since others can write to the folder {folder}" in told
    facts = json.loads(command("doctor", "--json", env=environment).stdout)
    assert "(mode 0777)" in facts["cache_remark"]


def test_models_are_listed():
    assert "iltis" in json.loads(command("models", "list", "--json").stdout)
    assert "\niltis  " in command("models", "list").stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("models", "show", "ilti"), "no system or scenario named 'ilti'; did you mean 'iltis'?"),
        (("equilibrium", "ilti"), "no system or scenario named 'ilti'; did you mean 'iltis'?"),
        (("eig", "none.yaml"), "none.yaml:1:1: file: there is no such file"),
        (("eig", "iltis", "--speed", "20 kg"), "--speed 20 kg: '20 kg' has the wrong unit"),
        (("eig", "iltis", "--speed=-1 m/s"), "--speed -1 m/s: must not be negative"),
        (("eig", "iltis", "--set", "parameters.chassis.mass=0"), "must be greater than 0 kg"),
        (("plot", "a.h5", "--format", "gif"), "--format gif: write png, svg or png,svg"),
        (("plot", "."), ".: this is a folder, not a file"),
        (("info", "none.h5"), "none.h5"),
        (("compare", "a.h5", "b.h5", "--tolerance", "x"), "--tolerance x: write PATTERN=VALUE"),
        (("compare", "a.h5", "b.h5", "--tolerance", "x=nan"), "--tolerance x=nan: write"),
        (("compare", "a.h5", "b.h5"), "a.h5: there is no such file"),
    ],
)  # fmt: skip
def test_bad_input_is_one_clear_message(tmp_path, arguments, words):
    done = command(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert words in done.stderr + done.stdout
    assert "Traceback" not in done.stderr
