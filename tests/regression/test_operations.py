"""Operation counts of generated equations, against those stored beside this file."""

import importlib
import sys
from pathlib import Path

import pytest

from vehicledyn.base.yaml import read_yaml
from vehicledyn.multibody import derive
from vehicledyn.solve.functions import count_operations

HERE = Path(__file__).parent
STORED = read_yaml(HERE / "operations.yaml").data
SLACK = 0.01  # versions of CasADi order sums differently


def chains():
    sys.path.insert(0, str(HERE.parents[1] / "benchmarks"))
    try:
        return importlib.import_module("chains")
    finally:
        sys.path.pop(0)


@pytest.mark.parametrize("name", STORED)
def test_operations_of_a_right_hand_side(name):
    """No more than stored; fewer are stored as well, so that they are kept."""
    module = chains()
    parent = module.binary if name.startswith("binary") else module.serial
    system = module.build(name, int(name.split()[-1]), parent)
    found = count_operations(derive(system))["rates"]
    assert found <= STORED[name] * (1.0 + SLACK), f"{name} needs {found} operations"
    assert found >= STORED[name] * (1.0 - SLACK), f"store {found} for {name}"
