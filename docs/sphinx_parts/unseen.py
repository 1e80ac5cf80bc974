"""Leaves out what Sphinx does for every module and what no page shows: a third of a build.

It searches the tokens of a module for the lines of its definitions, which only listings of parts of
a module need, makes a record of each message for debugging, whether it is shown or not, makes a
dozen states for each nested text, which enters one or two of them, and looks for garbage among
everything that was ever read.
"""

from __future__ import annotations

import gc
import logging
from typing import Any

from docutils.statemachine import State, StateMachine
from sphinx.application import Sphinx
from sphinx.pycode.parser import DefinitionFinder
from sphinx.util.logging import NAMESPACE


class States(dict[str, State]):
    """The states of a machine by name, each made when it is first asked for."""

    def __init__(self, machine: StateMachine) -> None:
        super().__init__()
        self.machine = machine
        self.classes: dict[str, type[State]] = {}
        self.runs = False

    def __missing__(self, name: str) -> State:
        state = self[name] = self.classes[name](self.machine, self.machine.debug)
        if self.runs:
            state.runtime_init()
        return state


def _add_states(machine: StateMachine, classes: list[type[State]]) -> None:
    if not isinstance(machine.states, States):
        machine.states = States(machine)
    machine.states.classes.update({found.__name__: found for found in classes})


def _begin(machine: StateMachine) -> None:
    machine.states.runs = True
    for state in machine.states.values():
        state.runtime_init()


def setup(app: Sphinx) -> dict[str, Any]:
    """Search for no lines of definitions; log what is shown only; make states late."""
    DefinitionFinder.parse = lambda finder: None
    if app.verbosity <= 0:
        logging.getLogger(NAMESPACE).setLevel(logging.INFO)
    StateMachine.add_states, StateMachine.runtime_init = _add_states, _begin
    gc.set_threshold(100_000, 50, 1000)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
