"""Write the equations of a system to files in a language, or as an FMU."""

from __future__ import annotations

from pathlib import Path

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.whole_file import folder_for_files, write_whole
from vehicledyn.codegen.printers.operations import MATLAB, PYTHON, C
from vehicledyn.export import c, matlab, python
from vehicledyn.export.document import ExportedStart, write_document
from vehicledyn.export.identifiers import safe_name
from vehicledyn.multibody.equations.equation_terms import Ingredients

SUFFIXES = {"c": ".c", "python": ".py", "matlab": ".m", "fmu": ".fmu", "cuda": ".cu"}
"""Ending of the file by what a system is exported to."""


def file_of(path: Path | None, name: str, suffix: str) -> Path:
    """Return the file to write: a path that ends so, or one in that folder, named as asked."""
    if path is not None and path.suffix == suffix and not path.is_dir():
        return path
    return (path or Path()) / f"{safe_name(name)}{suffix}"


def export_text(
    ingredients: Ingredients, language: str, name: str, start: ExportedStart | None = None
) -> dict[str, str]:
    """Return the texts of the files that a system is exported to, by their endings.

    Parameters
    ----------
    ingredients
        The equations and what they are made of.
    language
        "c", "python" or "matlab".
    name
        Identifier of the model, which is the name of the files too.
    start
        Parameters, states and unknowns to carry along; the equations' own if None.

    Raises
    ------
    MissingPartError
        If an operation has no translation.
    """
    if language == "c":
        document = write_document(ingredients, C, name, start)
        return {".c": c.c_source(document), ".h": c.c_header(document)}
    if language == "python":
        return {".py": python.python_module(write_document(ingredients, PYTHON, name, start))}
    return {".m": matlab.matlab_function(write_document(ingredients, MATLAB, name, start))}


def export_files(
    ingredients: Ingredients, language: str, path: Path, start: ExportedStart | None = None
) -> list[Path]:
    """Write a system to a file, and for C to a header beside it; return their paths.

    Raises
    ------
    InputError
        If the name is no identifier or a file cannot be written.
    """
    if safe_name(path.stem) != path.stem:
        raise InputError(
            f"{path}: the functions are named after the file, and '{path.stem}' is no name in all "
            f"languages; '{safe_name(path.stem)}' is"
        )
    paths = []
    for suffix, text in export_text(ingredients, language, path.stem, start).items():
        paths.append(write_text(path.with_suffix(suffix), text))
    return paths


def write_text(file: Path, text: str) -> Path:
    """Write a text to a file, with the folders that it needs; return its path.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    try:
        with folder_for_files(file.parent):
            write_whole(file, text)
    except OSError as error:
        raise InputError(f"{file}: cannot be written: {error.strerror}") from None
    return file
