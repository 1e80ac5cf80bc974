"""Leaves out what Sphinx does for every module and what no page shows: a quarter of a build.

It searches the tokens of a module for the lines of its definitions, which only listings of parts of
a module need, makes a record of each message for debugging, whether it is shown or not, and looks
for garbage among everything that was ever read.
"""

from __future__ import annotations

import gc
import logging
from typing import Any

from sphinx.application import Sphinx
from sphinx.pycode.parser import DefinitionFinder
from sphinx.util.logging import NAMESPACE


def setup(app: Sphinx) -> dict[str, Any]:
    """Search for no lines of definitions; log what is shown only; seldom look for garbage."""
    DefinitionFinder.parse = lambda finder: None
    if app.verbosity <= 0:
        logging.getLogger(NAMESPACE).setLevel(logging.INFO)
    gc.set_threshold(100_000, 50, 1000)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
