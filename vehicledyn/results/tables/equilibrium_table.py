"""An equilibrium as a table and as a result file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vehicledyn.results.store.consistency import Sizes
from vehicledyn.results.store.linear_file import (
    Quantity,
    new_file,
    old_file,
    read_quantities,
    write_numbers,
    write_quantities,
)

FORMAT = "vehicledyn-equilibrium"
_VALUES = (
    ("nominal", "Value in the nominal position"),
    ("equilibrium", "Value in the equilibrium"),
)


@dataclass(frozen=True)
class EquilibriumTable:
    """Coordinates, forces and other channels in the nominal position and in equilibrium.

    ``coordinate_values``, ``force_values`` and ``channel_values`` (2, n) hold both, in SI;
    ``residual`` is the largest unbalanced acceleration, ``speed`` in m/s, ``stability`` a word.
    """

    title: str
    model: str
    kind: str
    speed: float
    residual: float
    stability: str
    coordinates: tuple[Quantity, ...]
    coordinate_values: Any
    forces: tuple[Quantity, ...]
    force_values: Any
    channels: tuple[Quantity, ...] = ()
    channel_values: Any = ((), ())


def write_equilibrium(path: Path, table: EquilibriumTable) -> None:
    """Write an equilibrium to a file.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    head = {
        "title": table.title,
        "model": table.model,
        "kind": table.kind,
        "speed": table.speed,
        "residual": table.residual,
        "stability": table.stability,
    }
    with new_file(path, FORMAT, head) as file:
        for place, quantities, values in (
            ("coordinate", table.coordinates, table.coordinate_values),
            ("force", table.forces, table.force_values),
            ("channel", table.channels, table.channel_values),
        ):
            scale = write_quantities(file, place, quantities)
            for (name, words), row in zip(_VALUES, values, strict=True):
                write_numbers(file, f"{place}_{name}", row, (scale,), (f"as {place}", words))


def read_equilibrium(path: Path) -> EquilibriumTable:
    """Return the equilibrium in a file.

    Raises
    ------
    InputError
        If the file cannot be read or holds something else.
    """
    with old_file(path, FORMAT) as file:
        coordinates, forces = read_quantities(file, "coordinate"), read_quantities(file, "force")
        has_more = "channel" in file  # Files up to 2026 hold but coordinates and forces.
        channels = read_quantities(file, "channel") if has_more else ()
        counts = {"coordinate": len(coordinates), "force": len(forces), "channel": len(channels)}
        sizes = Sizes(counts)

        def rows(place: str) -> list[Any]:
            names = [f"{place}_{name}" for name, _ in _VALUES]
            return [sizes.fit(name, file[name][()], place, gaps=True) for name in names]

        return EquilibriumTable(
            str(file.attrs["title"]),
            str(file.attrs["model"]),
            str(file.attrs["kind"]),
            float(file.attrs["speed"]),
            float(file.attrs["residual"]),
            str(file.attrs["stability"]),
            coordinates,
            rows("coordinate"),
            forces,
            rows("force"),
            channels,
            rows("channel") if has_more else ((), ()),
        )
