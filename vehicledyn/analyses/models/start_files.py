"""A model and a scenario to begin with, and the schemas that editors check them by."""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.files.limits import read_regular
from vehicledyn.base.files.whole_file import folder_for_files, write_whole
from vehicledyn.base.schema_line import FileKind, schema_line, schema_name
from vehicledyn.files.scenario import scenario_schema
from vehicledyn.files.system.schema import system_schema

STARTS: dict[str, tuple[str, str]] = {
    "road": ("car.yaml", "drive.yaml"),
    "mechanism": ("mechanism.yaml", "turn.yaml"),
    "wheelset": ("wheelset.yaml", "push.yaml"),
}
"""Names of model and scenario by what one begins with."""

_SCHEMAS: dict[FileKind, Callable[[], dict[str, Any]]] = {
    "system": system_schema,
    "scenario": scenario_schema,
}


def write_start(folder: Path, kind: str) -> list[Path]:
    """Write model, scenario and schemas into a folder, made if missing; return them in that order.

    Raises
    ------
    InputError
        If there is no such kind to begin with, a file is there already (then nothing is
        written), or one cannot be written.
    """
    if kind not in STARTS:
        raise InputError(unknown_name("start", kind, STARTS))
    texts = {folder / name: text for name, text in _texts(kind).items()}
    taken = [path for path, text in texts.items() if _differs(path, text)]
    if taken:
        names = ", ".join(path.name for path in taken)
        raise InputError(f"{folder}: has {names} already, so nothing was written; name another")
    try:
        with folder_for_files(folder):
            for path, text in texts.items():
                write_whole(path, text)
    except OSError as error:
        raise InputError(f"{folder}: cannot be written to: {error.strerror}") from None
    return list(texts)


def _texts(kind: str) -> dict[str, str]:
    """Return the texts of all files by name."""
    model, scenario = STARTS[kind]
    return {
        model: _starter(kind, "model", "system"),
        scenario: _starter(kind, "scenario", "scenario"),
        **{
            schema_name(name): json.dumps(schema(), indent=2, ensure_ascii=False) + "\n"
            for name, schema in _SCHEMAS.items()
        },
    }


def _starter(kind: str, role: str, schema: FileKind) -> str:
    package = resources.files("vehicledyn.analyses.models.templates")
    text = package.joinpath(f"{kind}_{role}.yaml").read_text(encoding="utf-8")
    return schema_line(schema_name(schema)) + text


def _differs(path: Path, text: str) -> bool:
    """Return whether something else is in the place of a file; equal schemas may be shared."""
    if not path.exists() and not path.is_symlink():
        return False
    try:
        same = path.suffix == ".json" and read_regular(path, 4 * len(text)) == text.encode()
    except InputError:
        return True
    return not same
