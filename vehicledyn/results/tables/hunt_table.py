"""Hunting studies as a table and as a result file: eigenvalues, cycles, simulated cycles."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.base.argument_names import argument
from vehicledyn.results.hdf5.output import is_being_written
from vehicledyn.results.store.consistency import Sizes, require_known
from vehicledyn.results.store.dimensions import attach, bare_dimension
from vehicledyn.results.store.linear_file import (
    Quantity,
    new_file,
    old_file,
    read_complex,
    read_quantities,
    read_texts,
    write_numbers,
    write_quantities,
    write_texts,
)

FORMAT = "vehicledyn-hunt"
SETTLED = "settled"
KINDS = ("", "fold", "period_doubling", "torus", "branch_point")
"""What a limit cycle may be besides one."""

RUNNING, INTERRUPTED = "running", "interrupted"
STATUSES = ("ok", "partial", "failed", RUNNING, INTERRUPTED)
FIGURE_MEANINGS = {
    "linear_critical": "linear critical value (an oscillation begins to grow)",
    "linear_critical_frequency": "its frequency",
    "oscillation_ceases": "an oscillation ceases to grow",
    "oscillation_ceases_frequency": "its frequency",
    "divergence_begins": "a motion begins to grow without oscillation",
    "divergence_ceases": "a motion ceases to grow without oscillation",
    "nonlinear_critical": "lowest stable limit cycle found in this range",
    "simulated_lowering": "lowest one by simulation, lowered step by step",
    "simulated_raising": "linear one by simulation, a small disturbance grows",
    "largest_difference_amplitude": "largest difference of amplitude, simulated",
    "largest_difference_period": "largest difference of period, simulated",
    "simulated_seconds": "motion simulated for these",
}

_ORIGIN, _MEANS = "origin_of_branch_", "means_of_"
_DIRECTION = "cycle_direction"
_DIRECTION_MEANS = "Way of the branch: changes of parameter, period and amplitudes, of any length"
_SIMULATED = "value", "amplitude", "period", "spread", "seconds"


@dataclass(frozen=True)
class CycleRow:
    """One limit cycle: parameter, period [s], stability, and the range of each channel.

    ``kind`` is "" or "fold", "period_doubling", "torus", "branch_point"; ``trivial`` and
    ``largest`` are the trivial Floquet multiplier and the largest magnitude of the others;
    ``smallest``, ``greatest`` (n_channels,) and ``motion`` (n_phases, n_channels) are in SI.
    ``direction`` (2 + n_channels,) is the way of the branch there, of any length and sign: changes
    of parameter, period and amplitudes; None where it is unknown.
    """

    branch: int
    value: float
    period: float
    stable: bool
    kind: str
    trivial: float
    multipliers: Any
    smallest: Any
    greatest: Any
    motion: Any
    direction: Any = None

    @property
    def amplitude(self) -> Any:
        """Half the range of each channel, shape (n_channels,)."""
        return 0.5 * (np.asarray(self.greatest) - np.asarray(self.smallest))


@dataclass(frozen=True)
class SimulatedRow:
    """A motion that simulation reached: parameter, amplitude of the first channel, period [s].

    ``spread`` is by what part of itself the amplitude varies where it has not settled, ``seconds``
    how long it was simulated [s]; ``ending`` says whether it settled.
    """

    value: float
    amplitude: float
    period: float
    spread: float = 0.0
    seconds: float = 0.0
    ending: str = SETTLED


@dataclass(frozen=True)
class HuntTable:
    """A hunting study: the parameter, what was watched, and what was found.

    ``locus_values`` (n,) and ``eigenvalues`` (n, n_states) belong to the equilibria;
    ``simulated`` are motions that simulation reached; ``figures`` are the critical values by name;
    ``origins`` say by number where branches branch off others, ``means`` by name how figures were
    found, ``identity`` is equal for studies that find the same. ``status`` is "ok", "partial",
    "failed", "interrupted" or, while it is computed, "running".
    """

    title: str
    model: str
    parameter: Quantity
    channels: tuple[Quantity, ...]
    locus_values: Any
    eigenvalues: Any
    cycles: tuple[CycleRow, ...]
    simulated: tuple[SimulatedRow, ...]
    figures: dict[str, float]
    status: str
    message: str
    origins: dict[int, str] = field(default_factory=dict)
    means: dict[str, str] = field(default_factory=dict)
    identity: str = ""

    @property
    def is_finished(self) -> bool:
        """Whether the study reached its end, complete or not."""
        return self.status not in (RUNNING, INTERRUPTED)

    def branch(self, number: int) -> list[CycleRow]:
        """Return the cycles of a branch, in its order."""
        return [row for row in self.cycles if row.branch == number]

    def figure_unit(self, name: str) -> str:
        """Return the unit of a critical value."""
        if name.startswith("largest_difference"):
            return "1"
        if name == "simulated_seconds":
            return "s"
        return "Hz" if name.endswith("frequency") else self.parameter.unit

    @property
    def branches(self) -> list[int]:
        """Numbers of the branches."""
        return sorted({row.branch for row in self.cycles})


def write_hunt(path: Path, table: HuntTable) -> None:
    """Write a study to a file, which keeps what it held until all is written.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    head = {
        "title": table.title,
        "model": table.model,
        "status": table.status,
        "message": table.message,
        "identity": table.identity,
        **{f"figure_{name}": value for name, value in table.figures.items()},
        **{f"{_ORIGIN}{number}": words for number, words in table.origins.items()},
        **{f"{_MEANS}{name}": words for name, words in table.means.items()},
    }
    unit, name = table.parameter.unit, table.parameter.description or table.parameter.name
    with new_file(path, FORMAT, head) as file:
        write_quantities(file, "parameter", [table.parameter])
        channels = write_quantities(file, "channel", table.channels)
        cycle = bare_dimension(file, "cycle", len(table.cycles))
        simulated = bare_dimension(file, "simulated_motion", len(table.simulated))
        equilibrium = bare_dimension(file, "equilibrium", len(table.locus_values))
        locus = (equilibrium,)
        write_numbers(file, "equilibrium_parameter", table.locus_values, locus, (unit, name))
        write_numbers(file, "eigenvalue", table.eigenvalues, locus, ("1/s", "Eigenvalues"))
        columns: dict[str, tuple[Any, str, str]] = {
            "cycle_parameter": ([r.value for r in table.cycles], unit, name),
            "cycle_branch": ([r.branch for r in table.cycles], "1", "Number of the branch"),
            "cycle_period": ([r.period for r in table.cycles], "s", "Period"),
            "cycle_stable": ([r.stable for r in table.cycles], "1", "1 where it is stable"),
            "cycle_trivial": ([r.trivial for r in table.cycles], "1", "Trivial multiplier"),
        }
        for place, (values, units, words) in columns.items():
            write_numbers(file, place, values, (cycle,), (units, words))
        attach(write_texts(file, "cycle_kind", [row.kind for row in table.cycles]), [cycle])
        shape, by_channel = (len(table.cycles), len(table.channels)), (cycle, channels)
        for place, pick in (("smallest", "smallest"), ("greatest", "greatest")):
            values = [getattr(row, pick) for row in table.cycles]
            stacked = np.array(values, dtype=float).reshape(shape)
            write_numbers(file, f"cycle_{place}", stacked, by_channel, ("SI", f"{pick} value"))
        multipliers = [row.multipliers for row in table.cycles]
        write_numbers(file, "cycle_multiplier", _rows(multipliers), (cycle,), ("1", "Multipliers"))
        motion = [row.motion for row in table.cycles]
        whole = np.array(motion, dtype=float) if motion else np.zeros((0, 0, len(table.channels)))
        write_numbers(file, "cycle_motion", whole, (cycle,), ("SI", "One period, equally sampled"))
        write_numbers(file, _DIRECTION, _directions(table), (cycle,), ("SI", _DIRECTION_MEANS))
        numbers = [[getattr(row, name) for name in _SIMULATED] for row in table.simulated]
        columns_of = np.array(numbers, dtype=float).reshape(-1, len(_SIMULATED))
        write_numbers(file, "simulated", columns_of, (simulated,), ("SI", ", ".join(_SIMULATED)))
        endings = write_texts(file, "simulated_ending", [row.ending for row in table.simulated])
        attach(endings, [simulated])
        channels.attrs["long_name"] = "Channels watched"


def read_hunt(path: Path) -> HuntTable:
    """Return the study in a file.

    Raises
    ------
    InputError
        If the file cannot be read or holds something else.
    """
    with old_file(path, FORMAT) as file:
        parameter, channels = read_quantities(file, "parameter"), read_quantities(file, "channel")
        sizes = Sizes({"channels": len(channels), "components": 2 + len(channels)})
        if len(parameter) != 1:
            raise ValueError("it has no single parameter")
        columns = {
            name: sizes.fit(name, file[f"cycle_{name}"][()], "cycles", gaps=name == "trivial")
            for name in ("parameter", "branch", "period", "stable", "trivial")
        }
        kinds = read_texts(file, "cycle_kind")
        require_known("cycle_kind", kinds, KINDS)
        sizes.count("cycle_kind", kinds, "cycles")
        multipliers = read_complex(file, "cycle_multiplier")
        sizes.fit("cycle_multiplier", multipliers, "cycles", "multipliers", gaps=True)
        smallest, greatest = (
            sizes.fit(name, file[name][()], "cycles", "channels")
            for name in ("cycle_smallest", "cycle_greatest")
        )
        motion = sizes.fit("cycle_motion", file["cycle_motion"][()], "cycles", "phases", "channels")
        locus = sizes.fit("equilibrium_parameter", file["equilibrium_parameter"][()], "equilibria")
        eigenvalues = read_complex(file, "eigenvalue")
        if len(locus) or eigenvalues.size:
            sizes.fit("eigenvalue", eigenvalues, "equilibria", "states")
        directions = _read_directions(file, sizes, len(kinds))
        cycles = tuple(
            CycleRow(
                int(columns["branch"][k]),
                float(columns["parameter"][k]),
                float(columns["period"][k]),
                bool(columns["stable"][k]),
                kinds[k],
                float(columns["trivial"][k]),
                multipliers[k],
                smallest[k],
                greatest[k],
                motion[k],
                directions[k],
            )
            for k in range(len(kinds))
        )
        prefix = "figure_"
        return HuntTable(
            str(file.attrs["title"]),
            str(file.attrs["model"]),
            parameter[0],
            channels,
            locus,
            eigenvalues,
            cycles,
            tuple(
                SimulatedRow(**dict(zip(_SIMULATED, numbers, strict=True)), ending=ending)
                for numbers, ending in zip(
                    file["simulated"][()].tolist(),
                    read_texts(file, "simulated_ending"),
                    strict=True,
                )
            ),
            {
                key.removeprefix(prefix): float(value)
                for key, value in file.attrs.items()
                if key.startswith(prefix)
            },
            *_status(path, str(file.attrs["status"]), str(file.attrs["message"])),
            {
                int(key.removeprefix(_ORIGIN)): str(words)
                for key, words in file.attrs.items()
                if key.startswith(_ORIGIN)
            },
            {
                key.removeprefix(_MEANS): str(words)
                for key, words in file.attrs.items()
                if key.startswith(_MEANS)
            },
            str(file.attrs.get("identity", "")),
        )


def _directions(table: HuntTable) -> Any:
    """Return the directions of all cycles, not a number where they are unknown."""
    unknown = np.full(2 + len(table.channels), np.nan)
    rows = [unknown if row.direction is None else row.direction for row in table.cycles]
    return np.array(rows, dtype=float).reshape(len(rows), len(unknown))


def _read_directions(file: Any, sizes: Sizes, count: int) -> list[Any]:
    """Return the direction of each cycle; files of earlier versions hold none."""
    if _DIRECTION not in file:
        return [None] * count
    found = sizes.fit(_DIRECTION, file[_DIRECTION][()], "cycles", "components", gaps=True)
    return [row if np.isfinite(row).all() else None for row in found]


def _status(path: Path, status: str, message: str) -> tuple[str, str]:
    """Return status and message; what runs no more, and never said how it ended, was killed."""
    require_known("status", [status], STATUSES)
    if status != RUNNING or is_being_written(path.resolve()):
        return status, message
    words = (
        f"the program was terminated; 'hunt {argument('resume')}' continues with the same options"
    )
    return INTERRUPTED, "; ".join(filter(None, (message, words)))


def _rows(values: list[Any]) -> Any:
    return np.array(values, dtype=complex) if values else np.zeros((0, 0), dtype=complex)
