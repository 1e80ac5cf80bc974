"""The command line of studies: check, schema, options, missing parts."""

import json
import subprocess
import sys

import jsonschema
import pytest
from ruamel.yaml import YAML
from small_study import ROOT, command, environment

from vehicledyn.studies import load_study, study_schema

EXAMPLES = sorted((ROOT / "scenarios" / "studies").glob("*.yaml"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_are_valid_and_fit_the_schema(path):
    assert load_study(path).design.count >= 1
    jsonschema.validate(YAML(typ="safe").load(path), study_schema())


def test_the_schema_refuses_what_the_reader_refuses():
    example = YAML(typ="safe").load(EXAMPLES[0])
    for wrong in ({"number": 0}, {"seed": -1}, {"kind": "gird"}, {"vary": {"speed": 3}}):
        changed = {**example, "cases": {**example["cases"], **wrong}}
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(changed, study_schema())


def test_checking_a_study_loads_no_numerics(study):
    code = (
        "import sys; sys.argv = ['vehicledyn', 'validate', 'study.yaml']\n"
        "from vehicledyn.cli import main\n"
        "try: main()\n"
        "except SystemExit as end: assert not end.code\n"
        "heavy = {'numpy', 'casadi', 'h5py', 'matplotlib', 'pandas', 'distributed'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=study.parent, env=environment(ROOT), check=False,
        capture_output=True, text=True,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (0, "study.yaml: ok\n"), done.stderr


def test_json_of_a_sweep(study):
    done = command(
        "sweep", "study.yaml", "--json", "--workers", "1", "--set", "cases.number=2",
        folder=ROOT, cwd_of=study,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert (told["result"], told["status"], told["cases"]["done"]) == ("study.h5", "ok", 2)
    info = json.loads(command("info", "study.h5", "--json", folder=ROOT, cwd_of=study).stdout)
    assert info["cases"]["done"] == 2
    assert [axis["name"] for axis in info["axes"]] == ["parameters.length", "parameters.mass"]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--lanes", "3"], "--lanes 3: choose 1, 4 or 8"),
        (["--workers", "0"], "Invalid value for '--workers'"),
        (["--backend", "x"], "Invalid value for '--backend': 'x' is not one of 'auto'"),
        (["--workers", "2", "--scheduler", "tls://x:1"], "--scheduler has workers of its own"),
        (["--scheduler", "tls://x:1"], "--scheduler and --tls belong together"),
        (["--tls", "."], "--scheduler and --tls belong together"),
        (["--scheduler", "tcp://x:1", "--tls", "."], "write tls://HOST:PORT; without TLS anybody"),
        (["--set", "cases.number=0"], "must be at least 1, is 0"),
    ],
)
def test_wrong_options(study, words, told):
    done = command("sweep", "study.yaml", *words, folder=ROOT, cwd_of=study)
    assert done.returncode == 2
    assert told in " ".join(done.stderr.split())
    assert not (study.parent / "study.h5").exists()
