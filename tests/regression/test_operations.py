"""Operation counts of generated equations, against those stored beside this file."""

import importlib
import sys
from pathlib import Path

import pytest

import vehicledyn.vehicles  # noqa: F401
from vehicledyn.base.registry import find
from vehicledyn.base.yaml import read_yaml
from vehicledyn.codegen.passes.kernel_functions import count_operations
from vehicledyn.files.building.construct import build_system
from vehicledyn.files.system.read import read_system
from vehicledyn.multibody import derive

HERE = Path(__file__).parent
STORED = read_yaml(HERE / "operations.yaml").data
SLACK = 0.01  # versions of CasADi order sums differently


def imported(folder, name):
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.pop(0)


def model(name):
    """A vehicle of the catalogue with the parts that it usually has."""
    found = find("model", name)
    parameters = found.parameter_class.model_validate(found.default_parameters())
    return found.build(parameters, found.standard_options()).system


def written(path):
    """A system of a file."""
    found, problems = read_system(HERE.parents[1] / path)
    assert not problems
    return build_system(found)


def system_of(name):
    if name.endswith(".yaml"):
        return written(name)
    kind, _, rest = name.partition(" ")
    if kind == "arm":
        return imported(HERE.parent / "validation", "test_arms_and_chains").ARMS[rest]()
    if kind == "model":
        return model(rest)
    module = imported(HERE.parents[1] / "benchmarks", "chains")
    parent = module.binary if kind == "binary" else module.serial
    return module.build(name, int(name.split()[-1]), parent)


@pytest.mark.parametrize("name", STORED)
def test_operations_of_a_right_hand_side(name):
    """No more than stored; fewer are stored as well, so that they are kept."""
    found = count_operations(derive(system_of(name)))["rates"]
    assert found <= STORED[name] * (1.0 + SLACK), f"{name} needs {found} operations"
    assert found >= STORED[name] * (1.0 - SLACK), f"store {found} for {name}"
