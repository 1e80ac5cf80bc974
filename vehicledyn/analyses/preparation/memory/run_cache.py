"""Start of a scenario when it was last prepared, so that running it again derives nothing.

An entry holds the facts of the equations, the key of the compiled kernel and the point that the
run starts from. Its name is a digest of everything these follow from: the resolved scenario
with all parameters, the files it names, the program's own files, the version of CasADi and the
compiler. A missing, old or damaged entry is ignored. The channels that a scenario will have
are kept likewise, for what validates it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from vehicledyn.analyses.preparation.memory.entries import read_entry, write_entry
from vehicledyn.analyses.preparation.memory.origins import key_of
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.symbolic.equations import Channel

_RUNS, _CHANNELS = "runs", "channels"


@dataclass(frozen=True)
class Memory:
    """Facts of the equations, key of the kernel, look, and start: states, unknowns, parameters."""

    facts: dict[str, Any]
    kernel: str
    state: list[float]
    unknowns: list[float]
    residual: float
    remark: str
    parameters: list[float]
    look: dict[str, Any]


def key_of_run(loaded: LoadedScenario) -> str | None:
    """Return the name of a scenario's entry; None where it cannot be known to be the same."""
    return key_of(loaded)


def recall(key: str) -> Memory | None:
    """Return an entry, if there is a whole one that nobody else can have written."""
    content = read_entry(_RUNS, key)
    try:
        return None if content is None else Memory(**content)
    except TypeError:
        return None


def remember(key: str, memory: Memory) -> None:
    """Write an entry whole or not at all; a folder that cannot be written is no error."""
    write_entry(_RUNS, key, dict(vars(memory)))


def recall_channels(key: str) -> list[Channel] | None:
    """Return the channels that a scenario was found to have, or None."""
    content = read_entry(_CHANNELS, key)
    try:
        return None if content is None else [Channel(**item) for item in content["channels"]]
    except (KeyError, TypeError):
        return None


def remember_channels(key: str, channels: Sequence[Channel]) -> None:
    """Keep the channels that a scenario will have, as :func:`remember` does."""
    write_entry(_CHANNELS, key, {"channels": [asdict(channel) for channel in channels]})
