"""The option --plugin: Python files with laws and parts of the user's own."""

from __future__ import annotations

from collections.abc import Iterable
from copy import copy
from pathlib import Path
from typing import Any

TAKE_PLUGINS = (
    "run", "sweep", "validate", "schema", "models", "equilibrium", "eig", "response", "hunt",
    "kinematics", "inverse", "export", "track", "doctor", "steady", "handling",
)  # fmt: skip
"""Verbs that load models or list catalogues."""

PLUGINS = "plugins"
PLUGIN_HELP = "Python file that registers your own laws or parts; may be repeated."


def load_plugins(files: Iterable[str | Path] | None) -> None:
    """Load plugins, in the order in which they are given."""
    if not files:
        return
    from vehicledyn.interface.plugins import load_plugin

    for path in files:
        load_plugin(path)


def take_plugins(group: Any, verb: Any) -> None:
    """Let a verb, and the verbs below it, take the option that a group has."""
    (known,) = (item for item in group.params if item.name == PLUGINS)
    for taker in (verb, *getattr(verb, "commands", {}).values()):
        if not any(item.name == PLUGINS for item in taker.params):
            option = copy(known)
            option.expose_value = False
            taker.params.append(option)
