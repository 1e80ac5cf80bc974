"""Reference data: CSV files with comment lines, and YAML."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from ruamel.yaml import YAML

DATA = Path(__file__).parents[1] / "data"


def read_rows(name):
    """Return the rows of a table as mappings of texts."""
    lines = (DATA / name).read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def read_columns(name):
    """Return the columns of a table of numbers, each of shape (n_rows,)."""
    rows = read_rows(name)
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


def read_figures(name):
    """Return the content of a YAML file."""
    return YAML(typ="safe", pure=True).load((DATA / name).read_text(encoding="utf-8"))
