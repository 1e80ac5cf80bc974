"""Plugins from Python."""

from __future__ import annotations

from pathlib import Path

import vehicledyn.catalogue
from vehicledyn.base import plugins
from vehicledyn.base.checked_arguments import checked


@checked
def load_plugin(path: str | Path) -> list[tuple[str, str]]:
    """Run a Python file that registers laws or parts; return family and name of each.

    Scenarios may name them afterwards, and the processes of studies load the file too.

    Parameters
    ----------
    path
        Python file, such as "my_tyre.py".

    Raises
    ------
    InputError
        If there is no such file, it fails, or it registers a name that is taken.
    """
    return plugins.load_plugin(path, vehicledyn.catalogue.counts)
