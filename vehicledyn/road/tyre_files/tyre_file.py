"""A tyre property file (.tir) that is read: version, side and coefficients in SI units."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.problems import Mark, Problem, refusal
from vehicledyn.road.tyre_files.lines import Assignment, read_lines
from vehicledyn.road.tyre_files.magnitudes import implausible
from vehicledyn.road.tyre_files.names import ALIASES, Coefficient, coefficients
from vehicledyn.road.tyre_files.units import factor, read_units
from vehicledyn.road.tyre_files.use_mode import USUAL, UseMode, use_mode

VERSIONS = {5: "5.2", 6: "5.2", 21: "5.2", 51: "5.2", 52: "5.2", 60: "6.1", 61: "6.1", 62: "6.2"}
"""Version of the Magic Formula by FITTYP."""

_FORMATS = {"PAC2002": "pac2002", "MF_05": "pac2002"}
_SIDES = ("LEFT", "RIGHT", "SYMMETRIC", "UNKNOWN")
_POSITIVE = (
    *("FNOMIN", "UNLOADED_RADIUS", "LONGVL", "NOMPRES", "INFLPRES", "IP", "IP_NOM", "LFZO"),
    *("PCX1", "PDX1", "PKX1", "PCY1", "LCX", "LCY", "LMUX", "LMUY", "LKY"),
)
_NOT_ZERO = ("PKY1", "PKY2", "PDY1")
TURNED = ("PDY1", "PDY2", "RVY1", "RVY2", "RVY3", "QBZ10")
"""Coefficients that change sign with the lateral friction; the formula is the same then."""
_RANGES = {
    "load": ("FZMIN", "FZMAX", "N"),
    "longitudinal_slip": ("KPUMIN", "KPUMAX", "1"),
    "slip_angle": ("ALPMIN", "ALPMAX", "rad"),
    "camber": ("CAMMIN", "CAMMAX", "rad"),
    "pressure": ("PRESMIN", "PRESMAX", "Pa"),
}


@dataclass(frozen=True)
class ValidRange:
    """Values of a quantity for which the file holds, in SI units."""

    lowest: float
    highest: float
    unit: str


@dataclass(frozen=True)
class TyreFile:
    """The content of a tyre property file in SI units.

    Attributes
    ----------
    path
        The file.
    version
        "pac2002", "5.2", "6.1" or "6.2".
    side
        Side of the car that the tyre was measured for: "left", "right", "symmetric" or
        "unknown".
    values
        Coefficients by name, defaults included; those without default are absent.
    given
        Names that the file itself has.
    unknown
        Names in the file that no law knows; they have no effect.
    texts
        Entries of the file that are words.
    turned
        Whether the file has a negative lateral friction, as old programs write it; ``values`` have
        the coefficients :data:`TURNED` with the other sign.
    """

    path: Path
    version: str
    side: str
    values: Mapping[str, float]
    given: frozenset[str]
    unknown: tuple[str, ...] = ()
    texts: Mapping[str, str] = field(default_factory=dict)
    turned: bool = False

    @property
    def has_pressure(self) -> bool:
        """Whether the file says for which inflation pressure it holds."""
        return not self.given.isdisjoint(("NOMPRES", "INFLPRES", "IP_NOM", "IP"))

    @property
    def has_combined(self) -> bool:
        """Whether the file has coefficients by which slips weaken each other's forces."""
        pairs = (("RBX1", "RCX1"), ("RBY1", "RCY1"))
        return any(self.values[factor] * self.values[shape] != 0.0 for factor, shape in pairs)

    @property
    def asked(self) -> UseMode:
        """What the file asks for by USE_MODE."""
        number = self.values.get("USE_MODE")
        return USUAL if number is None else use_mode(number) or USUAL

    @property
    def ranges(self) -> dict[str, ValidRange]:
        """Return the ranges in which the file holds; a quantity without both ends is absent."""
        return {
            name: ValidRange(self.values[low], self.values[high], unit)
            for name, (low, high, unit) in _RANGES.items()
            if low in self.values and high in self.values
        }


def read_tyre_file(path: Path) -> TyreFile:
    """Return the content of a tyre property file; a file that did not change is read once.

    Raises
    ------
    InputError
        If it cannot be read; otherwise all problems of the file at once, with their lines.
    """
    try:
        facts = path.stat()
    except (OSError, ValueError):
        raise InputError(f"{path}: there is no such file") from None
    return _read(path, facts.st_mtime_ns, facts.st_size)


@lru_cache(maxsize=16)
def _read(path: Path, changed: int, size: int) -> TyreFile:
    source = str(path)
    entries, problems = read_lines(path)
    factors, wrong = read_units(entries, source)
    problems += wrong
    texts = {e.name: e.text for e in entries if e.section in ("MDI_HEADER", "MODEL")}
    version = _version(entries, source, problems)
    side = texts.get("TYRESIDE", "UNKNOWN").upper() or "UNKNOWN"
    if side not in _SIDES:
        words = unknown_name("side", side, _SIDES)
        problems.append(_at(entries, source, "TYRESIDE", words))
    found, unknown = _numbers(entries, factors, source, problems)
    values = _complete(found, entries, source, problems)
    _check(values, entries, source, problems)
    problems += implausible(found, {e.name: e for e in entries}, source) if not wrong else []
    if problems:
        raise refusal(problems, source)
    turned = values["PDY1"] < 0.0
    values |= {name: -values[name] for name in TURNED} if turned else {}
    given = frozenset(found)
    return TyreFile(path, version, side.lower(), values, given, unknown, texts, turned)


def _version(entries: list[Assignment], source: str, problems: list[Problem]) -> str:
    """Return the version of the Magic Formula that the section [MODEL] names."""
    texts = {e.name: e.text for e in entries if e.section in ("MDI_HEADER", "MODEL")}
    kind = texts.get("FILE_TYPE", "tir").lower()
    if kind != "tir":
        words = f"expected 'tir', found {kind!r}; this is no tyre property file"
        problems.append(_at(entries, source, "FILE_TYPE", words))
    form = texts.get("PROPERTY_FILE_FORMAT", "").upper()
    if form in _FORMATS:
        return _FORMATS[form]
    fit = texts.get("FITTYP", "")
    known = f"known: {', '.join(map(str, VERSIONS))}, or PROPERTY_FILE_FORMAT = 'PAC2002'"
    try:
        return VERSIONS[int(float(fit))]
    except (KeyError, ValueError, OverflowError):
        given = f"no Magic Formula of version '{fit}' (format '{form}')" if fit else "missing"
        problems.append(_at(entries, source, "FITTYP", f"{given}; {known}"))
        return "6.1"


_HEADS = ("UNITS", "MDI_HEADER")
"""Sections without coefficients."""


def _numbers(
    entries: list[Assignment], factors: dict[str, float], source: str, problems: list[Problem]
) -> tuple[dict[str, float], tuple[str, ...]]:
    """Return the numbers of the file in SI units, and the names that are unknown."""
    known, found, lines = coefficients(), {}, dict[str, Assignment]()
    unknown = []
    for entry in entries:
        name = ALIASES.get(entry.name, entry.name)
        if entry.section in _HEADS:
            if name in known and entry.section == "MDI_HEADER":
                words = f"is in [{entry.section}]; it belongs in [{known[name].section}]"
                problems.append(_problem(source, entry, words))
            continue
        if name in lines:
            words = f"appears twice; it was given in line {lines[name].line}"
            problems.append(_problem(source, entry, words))
            continue
        lines[name] = entry
        if name not in known:
            unknown.append(name)
            continue
        number = _number(entry.text)
        if number is None:
            words = f"expected a number, found {entry.text[:30]!r}"
            problems.append(_problem(source, entry, words))
        else:
            found[name] = number * factor(known[name].dimension, factors)
    texts = {"PROPERTY_FILE_FORMAT", "TYRESIDE", "MESSAGES", "CONTACT_MODEL", "FE_METHOD"}
    return found, tuple(name for name in unknown if name not in texts)


def _number(text: str) -> float | None:
    try:
        number = float(text.lower().replace("d", "e"))
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def _complete(
    found: dict[str, float], entries: list[Assignment], source: str, problems: list[Problem]
) -> dict[str, float]:
    """Return the numbers with the defaults of those that the file leaves out."""
    values = {}
    written = {ALIASES.get(e.name, e.name) for e in entries if e.section not in _HEADS}
    for name, coefficient in coefficients().items():
        if name in found:
            values[name] = found[name]
        elif name in written:
            continue  # not a number, which is a problem already
        elif coefficient.default == "required":
            problems.append(Problem(source, None, name, _missing(coefficient, entries)))
        elif coefficient.default != "none":
            values[name] = float(coefficient.default)
    if "QCZ1" not in written and (values.get("QDZ1"), values.get("QDZ2")) == (0.0, 0.0):
        values["QCZ1"] = 1.0  # of a pneumatic trail of zero, whose shape has no effect
    elif "QCZ1" not in written:
        problems.append(Problem(source, None, "QCZ1", _missing(coefficients()["QCZ1"], entries)))
    pressure = found.get("NOMPRES", found.get("IP_NOM", found.get("INFLPRES", found.get("IP"))))
    values["NOMPRES"] = 1.0 if pressure is None else pressure
    values["INFLPRES"] = found.get("INFLPRES", found.get("IP", values["NOMPRES"]))
    return values


def _missing(coefficient: Coefficient, entries: list[Assignment]) -> str:
    sections = {e.section: e.line for e in entries}
    where = f"[{coefficient.section}]"
    line = sections.get(coefficient.section)
    at = f"{where}, which ends in line {line}" if line else f"{where}, which the file lacks"
    return f"missing: {coefficient.meaning}; add it to {at}"


def _check(
    values: dict[str, float], entries: list[Assignment], source: str, problems: list[Problem]
) -> None:
    """Add what is wrong with single values and with the order of ranges."""
    for name in _POSITIVE:
        if name in values and values[name] <= 0.0:
            problems.append(_at(entries, source, name, f"must be above zero: {values[name]:g}"))
    for name in _NOT_ZERO:
        if values.get(name) == 0.0:
            problems.append(_at(entries, source, name, "must not be zero"))
    if use_mode(values.get("USE_MODE", USUAL.number)) is None:
        words = f"no mode {values['USE_MODE']:g}; the last digit is 0 to 5, tens are 0 to 3"
        problems.append(_at(entries, source, "USE_MODE", words))
    if values.get("PKY1", -1.0) * values.get("PKY2", 1.0) > 0.0:
        words = "is positive with PKY2: side forces would push the wheel aside; change its sign"
        problems.append(_at(entries, source, "PKY1", words))
    for low, high, _ in _RANGES.values():
        if low in values and high in values and values[low] >= values[high]:
            words = f"the range is turned round: {low} {values[low]:g}, {high} {values[high]:g}"
            problems.append(_at(entries, source, low, words))


def _at(entries: list[Assignment], source: str, name: str, words: str) -> Problem:
    """Return a problem of a name at its line, if the file has it."""
    for entry in entries:
        if ALIASES.get(entry.name, entry.name) == name:
            return _problem(source, entry, words)
    return Problem(source, None, name, words)


def _problem(source: str, entry: Assignment, words: str) -> Problem:
    return Problem(source, Mark(entry.line, 1), entry.name, words)
