"""Files of the cache that hold plain data, each whole and of its owner, or ignored."""

from __future__ import annotations

import hashlib
import json
import logging
import tempfile
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.limits import read_regular
from vehicledyn.base.files.ownership import writable_by_others
from vehicledyn.codegen.toolchain.cache import cache_folder, distrust

MOST_ENTRIES = 1000
"""Entries of a kind that are kept, the youngest."""

_LARGEST_ENTRY = 50_000_000
_log = logging.getLogger(__name__)


def read_entry(kind: str, key: str) -> dict[str, Any] | None:
    """Return what an entry holds, if it is whole and nobody else can have written it."""
    path = _path(kind, key)
    if distrust() or writable_by_others(path):
        return None
    try:
        content = json.loads(read_regular(path, _LARGEST_ENTRY))
        return content if _checksum(content) == content.pop("checksum") else None
    except (InputError, OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def write_entry(kind: str, key: str, content: dict[str, Any], most: int = MOST_ENTRIES) -> None:
    """Write an entry whole or not at all; a folder that cannot be written is no error.

    ``most`` entries of the kind are kept.
    """
    if distrust():
        return
    target = _path(kind, key)
    try:
        text = json.dumps(content | {"checksum": _checksum(content)})
        target.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        with tempfile.NamedTemporaryFile(
            "w", dir=target.parent, suffix=".part", delete=False, encoding="utf-8"
        ) as file:
            file.write(text)
        Path(file.name).replace(target)
        _forget_old(target.parent, most)
    except (OSError, TypeError) as error:
        _log.debug("what was prepared is not remembered: %s", error)


def _path(kind: str, key: str) -> Path:
    return cache_folder() / kind / f"{key}.json"


def _checksum(content: dict[str, Any]) -> str:
    plain = {k: v for k, v in content.items() if k != "checksum"}
    return hashlib.sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()


def _forget_old(folder: Path, most: int) -> None:
    entries = sorted(folder.glob("*.json"), key=lambda path: path.stat().st_mtime)
    for path in entries[:-most]:
        path.unlink(missing_ok=True)
