"""Writes a tyre property file anew with fitted coefficients in it."""

from __future__ import annotations

import re
from pathlib import Path

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.whole_file import write_whole
from vehicledyn.results.hdf5.output import write_failed
from vehicledyn.road.tyre_files.lines import read_lines, read_text
from vehicledyn.road.tyre_files.names import ALIASES, coefficients


def write_fitted(source: Path, values: dict[str, float], target: Path) -> None:
    """Write the source's text with values replaced; those that it lacks follow in their section.

    Raises
    ------
    InputError
        If the target has another ending than .tir or cannot be written.
    """
    if target.suffix != ".tir":
        raise InputError(f"{target}: a fitted tyre is a tyre property file; end its name in .tir")
    entries, _ = read_lines(source)
    lines = read_text(source).splitlines()
    missing = dict(values)
    for entry in entries:
        name = ALIASES.get(entry.name, entry.name)
        if name in missing:
            line = lines[entry.line - 1]
            head, _, rest = line.partition("=")
            comment = re.search(r"[$!].*", rest)
            kept = f" {comment[0]}" if comment else ""
            lines[entry.line - 1] = f"{head.rstrip()} = {missing.pop(name):.10g}{kept}"
    for name, value in missing.items():
        known = coefficients()[name]
        lines += [f"[{known.section}]", f"{name} = {value:.10g} $ {known.meaning}"]
    try:
        write_whole(target, "\n".join(["$ fitted to measured forces", *lines, ""]))
    except OSError as error:
        raise write_failed(target, error) from error
