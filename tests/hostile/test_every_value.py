"""Each value of each kind of study replaced by one of another shape: the form is refused."""

import copy
import json

import mechanism_cases
import pytest
import yaml_cases

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.base.yaml import parse_yaml
from vehicledyn.studies.identification.study import load_identification
from vehicledyn.studies.load import load_study
from vehicledyn.studies.manoeuvre_optimisation.file import load_manoeuvre
from vehicledyn.studies.optimisation.file import load_optimisation
from vehicledyn.studies.uncertainty.study import load_uncertainty

pytestmark = pytest.mark.long

VALUES = [{}, [], {"kind": []}, [{}], "nonsense", float("inf")]
MANOEUVRES = yaml_cases.ROOT / "benchmarks" / "manoeuvres"
LOADERS = {
    "optimise": load_optimisation,
    "identify": load_identification,
    "uncertainty": load_uncertainty,
    "optimise-manoeuvre": load_manoeuvre,
}
STUDIES = [
    *((LOADERS[verb], text) for verb, text in mechanism_cases.VARIANTS),
    *((load_study, text) for text in (yaml_cases.STUDY, yaml_cases.GRID, yaml_cases.LISTED)),
    *((load_manoeuvre, path.read_text("utf-8")) for path in sorted(MANOEUVRES.glob("*.yaml"))),
]


def places(data, place=()):
    """Yield the place of every value, outer ones first."""
    yield place
    if isinstance(data, dict | list):
        for key in data if isinstance(data, dict) else range(len(data)):
            yield from places(data[key], (*place, key))


def put(data, place, value):
    """Return data with another value at a place."""
    if not place:
        return value
    changed = copy.deepcopy(data)
    inner = changed
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    return changed


@pytest.mark.parametrize(("load", "text"), STUDIES)
def test_a_value_of_another_shape_is_refused_or_read(load, text, tmp_path):
    for name, content in yaml_cases.around({}).items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    (tmp_path / "measured.csv").write_text(mechanism_cases.MEASURED, encoding="utf-8")
    data, refused = parse_yaml(text, "study.yaml").data, 0
    cases = [(place, value) for place in places(data) for value in VALUES]
    for place, value in cases:
        study = tmp_path / "study.yaml"
        study.write_text(json.dumps(put(data, place, value)), encoding="utf-8")
        try:
            load(study)
        except (InputError, NumericalError):
            refused += 1
    assert refused > len(cases) // 3
