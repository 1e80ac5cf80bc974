"""YAML 1.2 files as plain data, with the line and column of every value."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.composer import Composer, ComposerError
from ruamel.yaml.error import MarkedYAMLError, YAMLStreamError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode
from ruamel.yaml.parser import Parser
from ruamel.yaml.reader import ReaderError
from ruamel.yaml.scanner import Scanner

from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.base.files.limits import UnreadableFileError, read_regular
from vehicledyn.base.problems import START, Mark, Place, Problem, dotted, refusal

LARGEST_FILE = 5_000_000
"""Bytes of the largest file that is read; tables belong in CSV or HDF5."""

_LARGEST_COUNT = 100_000
_LARGEST_KEPT, _MOST_KEPT = 100_000, 64
_MOST_SHOWN = 40
_NO_TEXT = re.compile("[\x00\ud800-\udfff]")
_OTHER_VERSION = re.compile(r"%YAML\s+(?!1\.2\b)")
_KNOWN_TAGS = {"null", "bool", "int", "float", "str", "map", "seq"}
_TEXT_TAGS = {"timestamp", "merge", "value"}


@dataclass
class Document:
    """Content of a YAML file.

    ``data`` holds plain mappings, lists, texts and numbers; ``values`` and ``keys`` the marks of
    each value and of each key by place; ``problems`` what is wrong although the file reads.
    """

    name: str
    text: str
    data: Any = None
    values: dict[Place, Mark] = field(default_factory=dict)
    keys: dict[Place, Mark] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)


_parsed: BoundedCache[tuple[str, str], Document] = BoundedCache(_MOST_KEPT)
_large: BoundedCache[tuple[str, str], Document] = BoundedCache(1)
"""The last text that is too long to keep many such, as a run reads its model several times."""

_remembered: ContextVar[dict[str, Document] | None] = ContextVar("remembered", default=None)


@contextmanager
def remembered_files(documents: dict[str, Document]) -> Iterator[None]:
    """Read each file only once inside the block, and those given by their names never.

    For work that reads the same files over and over, or where the files are not. ``documents``
    holds what was read afterwards.
    """
    token = _remembered.set(documents)
    try:
        yield
    finally:
        _remembered.reset(token)


def read_yaml(path: Path) -> Document:
    """Return the content of a YAML file with marks; duplicate keys are among its problems.

    Raises
    ------
    InputError
        If the file cannot be read or is no YAML; the text names file, line and column.
    """
    name, known = str(path), _remembered.get()
    if known is None:
        return parse_yaml(_decode(_read_bytes(path), name), name)
    if name not in known:
        known[name] = parse_yaml(_decode(_read_bytes(path), name), name)
    return replace(known[name], data=copied(known[name].data))


def copied(data: Any) -> Any:
    """Return a copy of what YAML holds: mappings, lists and values that do not change."""
    if isinstance(data, dict):
        return {key: copied(item) for key, item in data.items()}
    return [copied(item) for item in data] if isinstance(data, list) else data


def parse_yaml(text: str, name: str) -> Document:
    """Return the content of YAML text; ``name`` says in messages where it came from.

    A text that is read again costs a copy: variants of a model read the same files many times.

    Raises
    ------
    InputError
        If the text is no YAML.
    """
    known = _large if len(text) > _LARGEST_KEPT else _parsed
    kept = known.get((name, text), lambda: _parse(text, name))
    return replace(
        kept,
        data=copied(kept.data),
        values=dict(kept.values),
        keys=dict(kept.keys),
        problems=list(kept.problems),
    )


def _parse(text: str, name: str) -> Document:
    """Return the content of YAML text."""
    if _OTHER_VERSION.match(text):
        raise _syntax("only YAML 1.2 is read; take the %YAML line away", name, START)
    document = Document(name, text)
    reader = YAML(typ="safe", pure=True)
    reader.Composer, reader.Parser, reader.Scanner = _Composer, _Parser, _Scanner
    try:
        node = reader.compose(text)
        if node is not None:
            document.data = _Builder(document, reader).build(node, ())
    except MarkedYAMLError as error:
        raise _syntax(_syntax_words(error), name, _syntax_mark(error)) from None
    except ReaderError as error:
        character = f"U+{int(error.character):04X}"
        words = f"the character {character} is not allowed in YAML; is this a text file?"
        raise _syntax(words, name, _mark_at(text, error.position)) from None
    except YAMLStreamError as error:
        raise _syntax(str(error), name, START) from None
    except RecursionError:
        raise _syntax("nested too deeply", name, START) from None
    return document


def _part(name: str) -> Any:
    """Return a property that asks the loader for one of its parts once, not at every sign."""
    return cached_property(lambda reader: getattr(reader.loader, name))


class _Scanner(Scanner):
    """A scanner that looks for keys only where there may be some."""

    def need_more_tokens(self) -> bool:
        if self.tokens and not self.possible_simple_keys:
            return False
        return bool(super().need_more_tokens())


class _Parser(Parser):
    scanner = _part("scanner")


class _Composer(Composer):
    """Composes nodes until there are too many; reading a long file on would take minutes."""

    parser = _part("parser")
    count = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        self.count += 1
        if self.count > _LARGEST_COUNT:
            raise ComposerError(None, None, "too many values", self.parser.peek_event().start_mark)
        return super().compose_node(parent, index)


class _Builder:
    """Turns YAML nodes into plain data and notes marks and problems in a document."""

    def __init__(self, document: Document, reader: YAML) -> None:
        self.document = document
        self.constructor = reader.constructor
        self.count = 0
        self.size = 0
        self.open: set[int] = set()

    def build(self, node: Node, place: Place) -> Any:
        mark = _mark(node)
        self.document.values[place] = mark
        self.document.keys.setdefault(place, mark)
        self.count += 1
        if self.count > _LARGEST_COUNT or id(node) in self.open:
            words = "an alias repeats itself" if id(node) in self.open else "too many values"
            raise _syntax(words, self.document.name, mark)
        self.open.add(id(node))
        value = self._content(node, place)
        self.open.discard(id(node))
        return value

    def _content(self, node: Node, place: Place) -> Any:
        tag = str(node.tag).rpartition(":")[2]
        if tag not in _KNOWN_TAGS | _TEXT_TAGS:
            self._note(_mark(node), place, f"the tag '{tag}' is not allowed here")
            return None
        if isinstance(node, MappingNode):
            return self._mapping(node, place)
        if isinstance(node, SequenceNode):
            return [self.build(item, (*place, index)) for index, item in enumerate(node.value)]
        return self._scalar(node, tag, place) if isinstance(node, ScalarNode) else None

    def _mapping(self, node: MappingNode, place: Place) -> dict[str, Any]:
        content: dict[str, Any] = {}
        for key_node, value_node in node.value:
            if not isinstance(key_node, ScalarNode):
                self._note(_mark(key_node), place, "a key must be a text")
                continue
            key = str(key_node.value)
            inner = (*place, key)
            if key in content:
                first = self.document.keys[inner]
                self._note(
                    _mark(key_node), inner, f"given twice; the first is in line {first.line}"
                )
                continue
            self.document.keys[inner] = _mark(key_node)
            content[key] = self.build(value_node, inner)
        return content

    def _scalar(self, node: ScalarNode, tag: str, place: Place) -> Any:
        if tag in _TEXT_TAGS or tag == "str":
            return self._text(node, place)
        try:
            return self.constructor.construct_object(node)
        except (ValueError, KeyError):
            text = str(node.value)[:_MOST_SHOWN]
            words = (
                f"'{text}...' is too long a number" if text.isdigit() else f"'{text}' is no {tag}"
            )
            self._note(_mark(node), place, words)
            return text

    def _text(self, node: ScalarNode, place: Place) -> str:
        text = str(node.value)
        self.size += len(text)
        if self.size > LARGEST_FILE:
            raise _syntax("aliases repeat too much text", self.document.name, _mark(node))
        if _NO_TEXT.search(text):
            self._note(_mark(node), place, "the text holds a character that no file can store")
        return text

    def _note(self, mark: Mark, place: Place, message: str) -> None:
        self.document.problems.append(Problem(self.document.name, mark, dotted(place), message))


def _read_bytes(path: Path) -> bytes:
    try:
        return read_regular(path, LARGEST_FILE)
    except UnreadableFileError as error:
        raise refusal([Problem(str(path), START, "file", error.words)], str(path)) from None


def _decode(content: bytes, name: str) -> str:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start].decode("utf-8", errors="replace")
        words = f"the byte 0x{content[error.start]:02x} is not UTF-8; save the file as UTF-8 text"
        raise _syntax(words, name, _mark_at(before, len(before))) from None


def _syntax(words: str, name: str, mark: Mark) -> Exception:
    return refusal([Problem(name, mark, "syntax", words)], name)


_QUOTE = "put a text that holds { } [ ] or , or begins with * in quotation marks"


def _syntax_words(error: MarkedYAMLError) -> str:
    problem = re.sub(r"\s+", " ", str(error.problem or error.context or "not YAML"))
    if "'\\t'" in problem:
        return "a tab cannot indent YAML; use spaces"
    if "expected <block end>" in problem or "could not find expected ':'" in problem:
        return f"{problem}; check the indentation and the colons here and in the line above"
    context = re.sub(r"\s+", " ", str(error.context or ""))
    parts = [context, problem] if context.startswith("expected") else [problem, context]
    words = " ".join(filter(None, parts)) if error.problem else problem
    in_flow = "flow sequence" in words or "flow mapping" in words
    return f"{words}; {_QUOTE}" if in_flow or "alias" in words else words


def _syntax_mark(error: MarkedYAMLError) -> Mark:
    mark = error.problem_mark or error.context_mark
    return Mark(mark.line + 1, mark.column + 1) if mark else START


def _mark(node: Node) -> Mark:
    return Mark(node.start_mark.line + 1, node.start_mark.column + 1)


def _mark_at(text: str, position: int) -> Mark:
    before = text[:position]
    return Mark(before.count("\n") + 1, position - before.rfind("\n"))
