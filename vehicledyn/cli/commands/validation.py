"""The validation table of the project, computed anew from its references."""

from __future__ import annotations

import importlib.util
import tomllib
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError, MissingPartError
from vehicledyn.base.files.limits import read_regular
from vehicledyn.base.version import FOLDER, VERSION
from vehicledyn.cli.terminal import emit, show_progress

_LARGEST_PROJECT = 1_000_000
GENERATOR = Path("reports", "generate.py")
REFERENCES = Path("tests", "validation", "reference_cases")


def validate_again(folder: Path | None, *, quiet: bool) -> int:
    """Compute the table and its figures anew; return 0, or 1 if anything is out of its band.

    Parameters
    ----------
    folder
        Clone of the project; the one this program runs from, or the present folder, if None.
    quiet
        Whether to show no progress.

    Raises
    ------
    MissingPartError
        If no clone is there: an installed package has no reference data.
    InputError
        If ``folder`` is no clone of this version.
    """
    root = _root(folder)
    generator = _load(root / GENERATOR)
    with show_progress(quiet=quiet, verbose=not quiet) as progress:
        groups = generator.compute(progress)
        page = generator.write(groups)
    rows = [row for group in groups for row in group.rows]
    failures = [row for row in rows if not row.passes]
    lines = [f"{row.quantity}: {row.computed}, reference {row.reference}" for row in failures]
    emit("\n".join([f"{page}: {len(rows)} comparisons, {len(failures)} out of band", *lines]))
    return 1 if failures else 0


def _root(folder: Path | None) -> Path:
    if folder is not None:
        if not _is_clone(folder):
            raise InputError(
                f"{folder}: is no clone of vehicledyn {VERSION} with {GENERATOR} and {REFERENCES}"
            )
        return folder
    for place in (FOLDER.resolve().parent, Path()):
        if _is_clone(place):
            return place
    raise MissingPartError(
        "--validation: the reference data belong to the project's repository, not to the installed "
        f"package; clone version {VERSION} and give its folder: "
        "vehicledyn report --validation FOLDER"
    )


def _is_clone(folder: Path) -> bool:
    """Return whether a folder is a clone of this program in this version, data and all."""
    try:
        project = tomllib.loads(read_regular(folder / "pyproject.toml", _LARGEST_PROJECT).decode())
    except (InputError, ValueError):
        return False
    known = project.get("project", {})
    same = known.get("name") == "vehicledyn" and known.get("version") == VERSION
    return same and (folder / GENERATOR).is_file() and (folder / REFERENCES).is_dir()


def _load(path: Path) -> Any:
    specification = importlib.util.spec_from_file_location("vehicledyn_validation", path)
    if specification is None or specification.loader is None:
        raise InputError(f"{path}: cannot be read")
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module
