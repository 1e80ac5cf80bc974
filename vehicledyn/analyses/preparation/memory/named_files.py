"""The files that a scenario names, and theirs, so that a change of one of them is noticed."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator
from pathlib import Path

from vehicledyn.base.files.limits import TooLargeError, UnreadableFileError, read_regular
from vehicledyn.base.nested import leaves
from vehicledyn.files.scenario.target import Target

_NAMING = (".yaml", ".yml", ".crg")
_END_OF_HEADER = b"\n$$$$"
_SUFFIX = re.compile(r"\.[A-Za-z0-9]{1,8}$")
_QUOTED = re.compile(r"\"([^\"\n]+)\"|'([^'\n]+)'")
_BARE = re.compile(r"[^\s\[\]{},\"']+")
_LONGEST = 250
LARGEST_FILE = 200_000_000
"""Bytes of the largest file whose content counts; of larger ones size and time do."""


def named_files(target: Target) -> dict[str, str]:
    """Return digests of the contents of all files that a scenario or model names, by their paths.

    Every text of the scenario, of its system and of the YAML files and OpenCRG headers found is
    tried as the name of a file, relative to the file that holds it, since fields say nothing of
    whether they may name one.
    """
    found: dict[str, str] = {}
    waiting = [
        (text, target.origin.parent) for text in leaves(target.resolved) if isinstance(text, str)
    ]
    folder = Path(target.written.path).parent
    waiting += [(text, folder) for text in _words(target.written.text)]
    while waiting:
        name, folder = waiting.pop()
        path = folder / name
        content = None if str(path) in found or not _may_be_file(name) else _content(path)
        if content is None:
            continue
        found[str(path)] = hashlib.sha256(content).hexdigest()
        if path.suffix.lower() in _NAMING:
            text = content.split(_END_OF_HEADER)[0] if path.suffix.lower() == ".crg" else content
            words = _words(text.decode("utf-8", errors="replace"))
            waiting += [(word, path.parent) for word in words]
    return dict(sorted(found.items()))


def _may_be_file(name: str) -> bool:
    return len(name) <= _LONGEST and "\n" not in name and _SUFFIX.search(name) is not None


def _content(path: Path) -> bytes | None:
    try:
        return read_regular(path, LARGEST_FILE)
    except TooLargeError:
        facts = path.stat()
        return f"{facts.st_size} {facts.st_mtime_ns}".encode()
    except UnreadableFileError:
        return None


def _words(text: str) -> Iterator[str]:
    """Yield what may be a value in the text of a YAML file: quoted, a whole line or one word."""
    for line in text.splitlines():
        value = line.split(" #")[0].partition(": ")[2].strip() or line.strip().removeprefix("- ")
        yield value
        for match in _QUOTED.finditer(line):
            yield match[1] or match[2]
        yield from _BARE.findall(line)
