"""Write the equations of a system to files in a language."""

from __future__ import annotations

from pathlib import Path

from vehicledyn.base.errors import InputError
from vehicledyn.export import c, matlab, python
from vehicledyn.export.document import Start, write_document
from vehicledyn.export.languages import MATLAB, PYTHON, C, safe_name
from vehicledyn.multibody.ingredients import Ingredients

SUFFIXES = {"c": ".c", "python": ".py", "matlab": ".m"}
"""Ending of the file by language."""


def file_name(model: str, suffix: str) -> str:
    """Return the name of the file that a model is exported to."""
    return f"{safe_name(model)}{suffix}"


def export_text(
    ingredients: Ingredients, language: str, start: Start | None = None
) -> dict[str, str]:
    """Return the texts of the files that a system is exported to, by their endings.

    Parameters
    ----------
    ingredients
        The equations and what they are made of.
    language
        "c", "python" or "matlab".
    start
        Parameters, states and unknowns to carry along; the equations' own if None.

    Raises
    ------
    MissingPartError
        If an operation has no translation.
    """
    if language == "c":
        document = write_document(ingredients, C, start)
        return {".c": c.c_source(document), ".h": c.c_header(document)}
    if language == "python":
        return {".py": python.python_module(write_document(ingredients, PYTHON, start))}
    return {".m": matlab.matlab_function(write_document(ingredients, MATLAB, start))}


def export_files(
    ingredients: Ingredients, language: str, folder: Path, start: Start | None = None
) -> list[Path]:
    """Write a system to a folder, files named after the model; return their paths.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    paths = []
    for suffix, text in export_text(ingredients, language, start).items():
        path = folder / file_name(ingredients.equations.name, suffix)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        except OSError as error:
            raise InputError(f"{path}: cannot be written: {error.strerror}") from None
        paths.append(path)
    return paths
