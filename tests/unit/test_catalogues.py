"""What every catalogue promises: descriptions, units, and tests that run over all its kinds."""

import inspect
import re
from pathlib import Path

import pytest

import vehicledyn.cams.cam_file
import vehicledyn.catalogue
import vehicledyn.studies  # noqa: F401
from vehicledyn.base.parameters import ParameterSet, field_family, field_unit
from vehicledyn.base.registry import families, find, kinds
from vehicledyn.files.system.kinds import load_kinds

load_kinds()
TESTS = Path(__file__).parents[1]
ENTRIES = [(family, kind) for family in families() for kind in kinds(family)]
SENTENCE_END = (".", ",", ":", ";")
FROM_PYTHON = {
    "creep", "joint_type", "deformation_type", "element_type", "sensor_type", "constraint_type"
}  # fmt: skip
"""Catalogues that models, or entries of another catalogue, are made from."""
OF_CAMS = {"motion_law", "cam_follower", "cam_outline"}
"""Catalogues of files of their own."""


def sets_of(entry):
    """Return the parameter sets of an entry, nested ones included."""
    waiting = [getattr(entry, "parameter_class", entry)]
    if not issubclass(waiting[0], ParameterSet):
        return []
    found = []
    while waiting:
        parameters = waiting.pop()
        if parameters in found:
            continue
        found.append(parameters)
        for field in parameters.model_fields.values():
            inner = [field.annotation, *getattr(field.annotation, "__args__", ())]
            waiting += [a for a in inner if inspect.isclass(a) and issubclass(a, ParameterSet)]
    return found


def undescribed(entry):
    """Return the fields without description, and those with a number but no unit."""
    faults = []
    for parameters in sets_of(entry):
        for name, field in parameters.model_fields.items():
            is_set = inspect.isclass(field.annotation) and issubclass(
                field.annotation, ParameterSet
            )
            if not field.description and not is_set:
                faults.append(f"{parameters.__name__}.{name} has no description")
            is_number = "float" in str(field.annotation)
            if is_number and field_unit(parameters, name) is None:
                faults.append(f"{parameters.__name__}.{name} has no unit")
    return faults


@pytest.mark.parametrize(("family", "kind"), ENTRIES)
def test_entry_says_what_it_is(family, kind):
    entry = find(family, kind)
    own = vars(entry).get("__doc__")
    assert own, f"{family} '{kind}' has no description"
    assert own.strip().partition("\n")[0].rstrip().endswith(SENTENCE_END)
    assert re.fullmatch(r"[a-z][a-z0-9_]*|[TR][123]", kind)
    assert inspect.getmodule(entry).__doc__


@pytest.mark.parametrize(("family", "kind"), ENTRIES)
def test_every_parameter_has_a_description_and_every_number_a_unit(family, kind):
    assert undescribed(find(family, kind)) == []


def test_a_parameter_without_description_or_unit_is_found():
    class Careless(ParameterSet):
        """A set as it should not be."""

        mass: float
        ratio: float = 1.0

    assert len(undescribed(Careless)) == 4


@pytest.mark.parametrize("family", families())
def test_tests_run_over_all_kinds_of_the_family(family):
    """A new entry is tested before anyone remembers to."""
    stem = family.removesuffix("_type")  # of classes that sets of system files are made from
    call = re.compile(rf"""\bkinds\(\s*["']{stem}(_type)?["']\s*\)""")
    assert any(call.search(path.read_text()) for path in TESTS.rglob("test_*.py")), (
        f"no test is parametrised over kinds({family!r})"
    )


def test_scenarios_reach_every_family():
    """Every catalogue but those of models stands behind a field of some set."""
    from vehicledyn.files.expressions.fields import fact
    from vehicledyn.files.scenario.sets import Scenario, Tyres
    from vehicledyn.files.system.sets import SystemFile
    from vehicledyn.studies import Study

    sets = {s for entry in ENTRIES for s in sets_of(find(*entry))}
    sets |= {Scenario, Study, Tyres, *sets_of(SystemFile)}
    reached = {field_family(s, name) for s in sets for name in s.model_fields}
    reached |= {fact(s, name, "section") for s in sets for name in s.model_fields}
    assert (reached - {None}) | {"model", "model_file"} | FROM_PYTHON | OF_CAMS == set(families())
