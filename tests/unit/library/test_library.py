"""Files of the library are found by name, listed with their titles, and copied whole."""

import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import kinds
from vehicledyn.base.yaml import read_yaml
from vehicledyn.cli.commands.analyses import read_target
from vehicledyn.files.scenario import LoadedModel, known_models, load_model, load_scenario
from vehicledyn.library import entries, find_entry, library_folder, locate
from vehicledyn.library.copying import copy_entry, referenced

FROM_FILES = [entry for entry in entries() if entry.kind != "profile"]


def test_every_shipped_file_has_a_name():
    found = {entry.path for entry in entries()}
    folders = ("scenarios", "systems", "profiles")
    shipped = [path for folder in folders for path in (library_folder() / folder).rglob("*.*")]
    assert found == {path for path in shipped if path.suffix in (".yaml", ".csv")}


@pytest.mark.parametrize("kind", ["scenario", "study", "system", "profile"])
def test_names_of_one_kind_are_unique(kind):
    names = [entry.name for entry in entries(kind)]
    assert len(set(names)) == len(names) > 0


def test_no_system_has_the_name_of_a_vehicle():
    assert not {entry.name for entry in entries("system")} & set(kinds("model"))


@pytest.mark.parametrize("entry", FROM_FILES, ids=lambda entry: entry.place)
def test_the_sentence_of_a_file_is_its_title(entry):
    assert entry.sentence() == read_yaml(entry.path).data["title"]


def test_profiles_are_listed_with_their_source():
    assert all(entry.sentence() for entry in entries("profile"))


def test_the_order_of_kinds_decides_between_a_scenario_and_its_system():
    assert find_entry("bicycle", ("scenario", "system")).place == "scenarios/systems/bicycle"
    assert find_entry("bicycle", ("system", "scenario")).place == "systems/bicycle"
    assert find_entry("systems/bicycle", ("scenario", "system")).kind == "system"


def test_files_of_the_user_win_over_the_library(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert locate("iltis_slalom", ("scenario",)) == library_folder() / "scenarios/iltis_slalom.yaml"
    (tmp_path / "iltis_slalom").mkdir()
    assert locate("iltis_slalom", ("scenario",)).parent == library_folder() / "scenarios"
    (tmp_path / "iltis_slalom.yaml").touch()
    assert str(locate("iltis_slalom", ("scenario",))) == "iltis_slalom.yaml"
    assert str(locate("iltis_slalom.yaml", ("scenario",))) == "iltis_slalom.yaml"


def test_a_file_of_the_user_wins_over_a_vehicle(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert read_target("iltis", None).name == "iltis"
    system = find_entry("double_pendulum", ("system",)).path.read_text(encoding="utf-8")
    (tmp_path / "iltis.yaml").write_text(system.replace("title: A", "title: My"))
    assert "My double pendulum" in read_target("iltis", None).written.text


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("iltis_slalm", "'iltis_slalm' is not a file; no scenario .*did you mean 'iltis_slalom'"),
        ("elsewhere/iltis_slalom.yaml", "no such file; the library has one of this name: write"),
    ],
)
def test_mistakes_in_names(name, words):
    with pytest.raises(InputError, match=words):
        locate(name, ("scenario",))


def test_other_missing_files_are_left_to_their_reader():
    assert str(locate("mine.yaml", ("scenario",))) == "mine.yaml"


def test_a_model_of_the_library_is_loaded_by_name():
    model = load_model("bicycle", ["parameters.forward_speed=4 m/s"])
    assert isinstance(model, LoadedModel)
    assert model.written.path == library_folder() / "systems" / "bicycle.yaml"
    assert {"iltis", "bicycle", "tram2000"} <= set(known_models())
    with pytest.raises(InputError, match="did you mean 'bicycle'"):
        load_model("bicycel")


def test_a_scenario_names_a_model_of_the_library(tmp_path):
    text = "model: double_pendulum\nduration: 1 s\nsolver: {kind: rk4, step: 1 ms}\n"
    scenario = tmp_path / "mine.yaml"
    scenario.write_text(f"title: Mine\n{text}output: {{interval: 10 ms}}\n")
    loaded = load_scenario(scenario, ["parameters.length=2 m"])
    assert loaded.written.path == library_folder() / "systems" / "double_pendulum.yaml"
    assert loaded.resolved["parameters"]["length"] == 2.0
    scenario.write_text(scenario.read_text().replace("double_pendulum", "double_pendulm"))
    with pytest.raises(InputError, match=r"mine.yaml:2:.*did you mean 'double_pendulum'"):
        load_scenario(scenario)


@pytest.mark.parametrize("entry", entries("scenario", "study"), ids=lambda entry: entry.place)
def test_what_a_file_refers_to_is_in_the_library(entry):
    data = read_yaml(entry.path).data
    named = [data[key] for key in ("model", "scenario") if str(data.get(key)).endswith(".yaml")]
    found = referenced(entry.path)
    assert found[0] == entry.path.resolve()
    assert all((entry.path.parent / name).resolve() in found for name in named)


def test_copies_keep_their_places_and_overwrite_nothing(tmp_path):
    copies = copy_entry(find_entry("bicycle", ("scenario",)), tmp_path / "new")
    places = [path.relative_to(tmp_path / "new").as_posix() for path in copies]
    assert places == ["scenarios/systems/bicycle.yaml", "systems/bicycle.yaml"]
    loaded = load_scenario(copies[0])
    assert loaded.written.path.resolve() == copies[1]
    copies[0].unlink()
    with pytest.raises(InputError, match=r"systems/bicycle.yaml exists already, so nothing"):
        copy_entry(find_entry("bicycle", ("scenario",)), tmp_path / "new")
    assert not copies[0].exists()
    truck = copy_entry(find_entry("truck_flexible_frame", ("scenario",)), tmp_path / "truck")
    frame = truck[-1].relative_to(tmp_path / "truck")
    assert frame.as_posix() == "systems/truck_frame.npz"
    assert truck[-1].read_bytes() == (library_folder() / frame).read_bytes()
    (alone,) = copy_entry(find_entry("iltis_slalom", ("scenario",)), tmp_path)
    assert alone == tmp_path / "iltis_slalom.yaml"
