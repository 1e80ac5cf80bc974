"""Channels of MDF files, which asammdf reads where it is installed."""

from __future__ import annotations

import gc
import logging
import struct
import sys
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.base.errors import InputError, MissingPartError
from vehicledyn.base.files.limits import open_regular
from vehicledyn.studies.identification.data_columns import (
    DataColumn,
    clean_unit,
    no_column,
    numbers_of,
)

_STARTS = (b"MDF     ", b"UnFinMF ")
_BROKEN = (
    ValueError,
    TypeError,
    LookupError,
    AttributeError,
    OSError,
    RuntimeError,
    OverflowError,
    MemoryError,
    struct.error,
    zlib.error,
)
"""What asammdf raises, besides its own error, on files that do not hold what they should."""


def is_mdf(path: Path) -> bool:
    """Return whether a file begins as an MDF file does.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    with open_regular(path) as file:
        return file.read(8) in _STARTS


def read_mdf(path: Path, names: Sequence[str]) -> list[DataColumn]:
    """Return channels with their units and times, of the second group as ``1/name``.

    Samples that the file marks as invalid are gaps.

    Raises
    ------
    InputError
        If the file is damaged, or a channel is missing, there more than once or holds no numbers.
    MissingPartError
        If asammdf is not installed.
    """
    if not is_mdf(path):
        raise InputError(f"{path}: is no MDF file")
    with _opened(path) as mdf:
        return [_channel(path, mdf, name) for name in names]


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """Give a file as asammdf reads it, which says nothing of its own meanwhile."""
    try:
        from asammdf import MDF
        from asammdf.blocks.utils import MdfException
    except ModuleNotFoundError:
        words = "MDF files need asammdf: pip install 'vehicledyn[mdf]'"
        raise MissingPartError(f"{path}: {words}") from None
    with _silenced(), open_regular(path) as file:
        try:
            with MDF(file) as mdf:
                yield mdf
                return
        except InputError:
            raise
        except (*_BROKEN, MdfException) as error:
            words = str(error) or type(error).__name__
        gc.collect()  # what is left of a damaged file complains when it goes
    raise InputError(f"{path}: cannot be read as an MDF file: {words}")


@contextmanager
def _silenced() -> Iterator[None]:
    """Let asammdf neither log nor complain of objects that it made only half."""
    log, hook = logging.getLogger("asammdf"), sys.unraisablehook
    was_silent, log.disabled = log.disabled, True
    sys.unraisablehook = lambda _: None
    try:
        yield
    finally:
        log.disabled, sys.unraisablehook = was_silent, hook


def _channel(path: Path, mdf: Any, name: str) -> DataColumn:
    """Return a channel by its name, or by the number of its group and its name."""
    known, first = mdf.channels_db, name.partition("/")
    own, group = name, None
    if name not in known and first[0].isdecimal() and first[2] in known:
        own, group = first[2], int(first[0])
    if own not in known:
        raise no_column(path, name, known)
    places = [place for place in known[own] if group in (None, place[0])]
    if len(places) != 1:
        groups = ", ".join(f"'{place[0]}/{own}'" for place in known[own][:4])
        words = f"'{own}' is there {len(known[own])} times; name one by its group: {groups}"
        raise InputError(f"{path}: {words}", about=(name,))
    signal = mdf.get(own, *places[0], ignore_invalidation_bits=True)
    values = numbers_of(path, name, signal.samples)
    bits = getattr(signal.invalidation_bits, "_data", signal.invalidation_bits)
    if bits is not None and np.shape(bits) == values.shape:
        values = np.where(np.asarray(bits, dtype=bool), np.nan, values)
    times = np.asarray(signal.timestamps, dtype=float)
    return DataColumn(name, values, clean_unit(signal.unit), times)
