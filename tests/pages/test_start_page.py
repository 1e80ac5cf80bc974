"""Every command of docs/start.md works; files to begin with follow their schemas; completion."""

import functools
import json
import re
from pathlib import Path

import jsonschema
import pytest
from programs import call, run
from test_documents import blocks

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.models.start_files import STARTS, write_start
from vehicledyn.base.errors import InputError
from vehicledyn.base.yaml import read_yaml
from vehicledyn.cli.commands.start import Start
from vehicledyn.files.scenario import scenario_schema
from vehicledyn.files.system.schema import system_schema
from vehicledyn.results.store.reader import open_result

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "start.md").read_text(encoding="utf-8")
LINE = re.compile(r"# yaml-language-server: \$schema=(\S+)\n")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("start")
    for block in blocks(PAGE, "sh"):
        for line in block.splitlines():
            run(line, place)
    return place / "first"


def test_page(folder):
    assert {path.name for path in folder.glob("*.html")} == {
        "drive_report.html",
        "compared.html",
        "push_report.html",
    }
    told = (folder / "push_report.html").read_text(encoding="utf-8")
    assert "Running safety, comfort and wear" in told and "wheels.left" in told
    for name in re.findall(r"`first/(\S+\.(?:yaml|json))`", PAGE):
        assert (folder / name).is_file()
    with open_result(folder / "drive.h5") as result:
        assert result.is_whole and result.summary["cones_cleared"].value == 5
    with open_result(folder / "turn.h5") as result:
        # 60 rad/s for 0.5 s, more where the gas spring pushes.
        assert result.is_whole and result.channel("crank.angle").values[-1] > 20.0
    with open_result(folder / "push.h5") as result:
        lateral = result.channel("wheelset.lateral").values
        assert result.is_whole and abs(lateral[-100:]).max() < 0.3 * abs(lateral).max()


@functools.cache
def validator_of(schema):
    """Return what validates by the text of a schema, which is checked once itself."""
    schema = json.loads(schema)
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.mark.parametrize("kind", STARTS)
def test_files_follow_the_schemas_they_name(tmp_path, kind):
    for path in write_start(tmp_path, kind):
        if path.suffix == ".yaml":
            schema = tmp_path / LINE.match(path.read_text(encoding="utf-8"))[1]
            validator, data = validator_of(schema.read_text()), read_yaml(path).data
            assert [e.message for e in validator.iter_errors(data)] == [], path
            assert not validator.is_valid({**data, "tilte": "no"})


@pytest.mark.parametrize(
    ("schema", "pattern"),
    [(system_schema, "systems/*.yaml"), (scenario_schema, "scenarios/**/*.yaml")],
)
def test_schemas_accept_the_files_of_the_repository(schema, pattern):
    validator = jsonschema.Draft202012Validator(schema())
    paths = [path for path in ROOT.glob(pattern) if path.parent.name != "studies"]
    assert len(paths) > 15
    for path in paths:
        assert [e.message for e in validator.iter_errors(read_yaml(path).data)] == [], path


def test_schemas_know_choices_and_the_indices_of_repetitions():
    validator = jsonschema.Draft202012Validator(system_schema())
    data = read_yaml(ROOT / "systems" / "small_car.yaml").data
    wheels = data["mirror"][0]["repeat"][0]["wheels"]["{axle}_left"]
    for axle, good in (("{axle}", True), ("rear", True), ("middle", False)):
        wheels["axle"] = axle
        assert validator.is_valid(data) is good


def test_every_start_is_offered():
    assert {start.value for start in Start} == set(STARTS)


def test_nothing_is_overwritten(tmp_path):
    write_start(tmp_path, "road")
    write_start(tmp_path, "mechanism")  # equal schemas are shared
    (tmp_path / "drive.yaml").write_text("mine")
    (tmp_path / "car.yaml").unlink()
    with pytest.raises(InputError, match=r"drive\.yaml already, so nothing was written"):
        write_start(tmp_path, "road")
    assert not (tmp_path / "car.yaml").exists()
    assert (tmp_path / "drive.yaml").read_text() == "mine"
    (tmp_path / "system.schema.json").write_text("{}")
    with pytest.raises(InputError, match=r"has system\.schema\.json already"):
        (tmp_path / "drive.yaml").unlink()
        write_start(tmp_path, "road")
    with pytest.raises(InputError, match="cannot be written to"):
        write_start(tmp_path / "system.schema.json" / "below", "road")


def test_models_are_written_with_the_line_and_read_again(tmp_path):
    for model in ("iltis", str(ROOT / "systems" / "quarter_car.yaml")):
        text = run(["vehicledyn", "models", "show", model, "--yaml"], tmp_path)
        assert LINE.match(text)[1] == "system.schema.json"
        (tmp_path / "written.yaml").write_text(text, encoding="utf-8")
        assert run(["vehicledyn", "validate", "written.yaml"], tmp_path) == "written.yaml: ok\n"


def completed(*words, shell="bash"):
    settings = {
        "_VEHICLEDYN_COMPLETE": f"complete_{shell}",
        "COMP_WORDS": " ".join(("vehicledyn", *words)),
        "COMP_CWORD": str(len(words)),
    }
    done = call(["vehicledyn"], ROOT, **settings)
    assert done.stderr == ""
    return done.stdout.split()


def test_completion(folder):
    result = str(folder / "drive.h5")
    assert completed("re") == ["response", "report"]
    assert completed("eig", "il") == ["iltis"]
    assert completed("init", "--kind", "m") == ["mechanism"]
    yaw = completed("compare", "x.h5", result, "--channel", "chassis.ya")
    assert yaw == ["chassis.yaw", "chassis.yaw_rate"]
    assert completed("plot", result, "--only", "wh") == ["wheel_loads"]
    assert completed("plot", str(ROOT / "README.md"), "--only", "wh") == []
    assert completed("compare", "x.h5", "no.h5", "--channel", "ch") == []


def test_completion_can_be_installed():
    named = {"_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}  # none may run the tests
    script = run(["vehicledyn", "--show-completion", "bash"], ROOT, **named)
    assert "_VEHICLEDYN_COMPLETE=complete_bash" in script


def test_links_of_the_page_lead_to_files():
    links = re.findall(r"\]\(([^)#:]+)\)", PAGE)
    assert links
    assert [link for link in links if not (ROOT / "docs" / link).exists()] == []
