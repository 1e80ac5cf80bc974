"""Eigenmodes as tables and as a result file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from vehicledyn.results.store.consistency import Sizes, require_known
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

FORMAT = "vehicledyn-modes"
KINDS = ("free", "drift", "aperiodic", "oscillation")


@dataclass(frozen=True)
class ModeCase:
    """Modes about one reference motion; of a complex pair the one with Im λ > 0.

    ``eigenvalue`` (n_modes,) [1/s]; ``kind`` says "free", "drift", "aperiodic" or "oscillation";
    ``state_shape`` (n_modes, n_states) and ``channel_shape`` (n_modes, n_channels) are complex
    amplitudes, scaled together so that the coordinate that takes part most has amplitude 1;
    ``participation`` (n_modes, n_states) sums to 1 over the states. ``speed`` [m/s], ``setting``
    says what else was changed.
    """

    speed: float
    setting: str
    eigenvalue: Any
    kind: tuple[str, ...]
    state_shape: Any
    channel_shape: Any
    participation: Any

    @property
    def frequency(self) -> Any:
        """Undamped frequencies |λ|/2π, shape (n_modes,) [Hz]."""
        return np.abs(self.eigenvalue) / (2.0 * np.pi)

    @property
    def damping_ratio(self) -> Any:
        """Damping ratios -Re λ/|λ|, 0 for zeros, shape (n_modes,)."""
        size = np.abs(self.eigenvalue)
        return np.where(size > 0.0, -self.eigenvalue.real / np.where(size > 0.0, size, 1.0), 0.0)

    @property
    def label(self) -> str:
        """The case in words."""
        return ", ".join(filter(None, [(self.speed and f"{self.speed:g} m/s") or "", self.setting]))


@dataclass(frozen=True)
class ModeTable:
    """Modes of a model in several cases; ``coordinates`` are names among the channels."""

    title: str
    model: str
    states: tuple[Quantity, ...]
    channels: tuple[Quantity, ...]
    coordinates: tuple[str, ...]
    cases: tuple[ModeCase, ...]

    def columns(self, names: Sequence[str]) -> list[int]:
        """Return the places of channels."""
        places = {channel.name: k for k, channel in enumerate(self.channels)}
        return [places[name] for name in names]

    def shares(self, participation: Any) -> dict[str, float]:
        """Return the participation of coordinates, with that of their rates, by name."""
        shares: dict[str, float] = {}
        for state, share in zip(self.states, participation, strict=True):
            name = state.name.removesuffix("_rate")
            if name not in self.coordinates:
                name = state.name
            shares[name] = shares.get(name, 0.0) + float(share)
        return shares

    def ranked(self, case: ModeCase, mode: int) -> list[tuple[str, complex, float]]:
        """Return coordinates as (name, amplitude, participation), the leading ones first."""
        shares = self.shares(case.participation[mode])
        values = case.channel_shape[mode, self.columns(self.coordinates)]
        found = [
            (name, complex(value), shares.get(name, 0.0))
            for name, value in zip(self.coordinates, values, strict=True)
        ]
        return sorted(found, key=lambda item: (-round(item[2], 6), -abs(item[1])))


def write_modes(path: Path, table: ModeTable) -> None:
    """Write modes to a file, one group a case.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    head = {"title": table.title, "model": table.model, "cases": len(table.cases)}
    with new_file(path, FORMAT, head) as file:
        states = write_quantities(file, "state", table.states)
        channels = write_quantities(file, "channel", table.channels)
        write_texts(file, "coordinates", table.coordinates)
        for number, case in enumerate(table.cases, 1):
            _write_case(file.create_group(f"case_{number}"), case, states, channels)


def read_modes(path: Path) -> ModeTable:
    """Return the modes in a file.

    Raises
    ------
    InputError
        If the file cannot be read or holds something else.
    """
    with old_file(path, FORMAT) as file:
        groups = [file[f"case_{number}"] for number in range(1, int(file.attrs["cases"]) + 1)]
        states, channels = read_quantities(file, "state"), read_quantities(file, "channel")
        table = ModeTable(
            str(file.attrs["title"]),
            str(file.attrs["model"]),
            states,
            channels,
            tuple(read_texts(file, "coordinates")),
            tuple(_read_case(group, len(states), len(channels)) for group in groups),
        )
        _check(table)
        return table


def _check(table: ModeTable) -> None:
    """Raise ValueError for what no program of ours writes."""
    if not table.cases:
        raise ValueError("it holds no case")
    names = [channel.name for channel in table.channels]
    require_known("coordinates", table.coordinates, names)
    if len(set(names)) < len(names):
        raise ValueError("two channels have one name")
    columns = table.columns(table.coordinates)
    for case in table.cases:
        Sizes().fit("channel_shape", case.channel_shape[:, columns], "modes", "coordinates")


def _write_case(
    group: h5py.Group, case: ModeCase, states: h5py.Dataset, channels: h5py.Dataset
) -> None:
    group.attrs["speed"], group.attrs["setting"] = case.speed, case.setting
    modes = group.create_dataset("mode", data=np.arange(1, len(case.kind) + 1))
    modes.make_scale("mode")
    write_texts(group, "kind", case.kind).dims[0].attach_scale(modes)
    for name, values, scales, words in (
        ("eigenvalue", case.eigenvalue, (modes,), ("1/s", "Eigenvalue")),
        ("frequency", case.frequency, (modes,), ("Hz", "Undamped frequency")),
        ("damping_ratio", case.damping_ratio, (modes,), ("1", "Damping ratio")),
        ("state_shape", case.state_shape, (modes, states), ("as state", "Shape in the states")),
        (
            "channel_shape",
            case.channel_shape,
            (modes, channels),
            ("as channel", "Shape in all channels"),
        ),
        ("participation", case.participation, (modes, states), ("1", "Participation of states")),
    ):
        write_numbers(group, name, values, scales, words)


def _read_case(group: h5py.Group, n_states: int, n_channels: int) -> ModeCase:
    sizes = Sizes({"states": n_states, "channels": n_channels})
    kinds = tuple(read_texts(group, "kind"))
    require_known("kind", kinds, KINDS)
    sizes.count("kind", kinds, "modes")
    by_state, channel_shape = ("modes", "states"), read_complex(group, "channel_shape")
    return ModeCase(
        float(group.attrs["speed"]),
        str(group.attrs["setting"]),
        sizes.fit("eigenvalue", read_complex(group, "eigenvalue"), "modes"),
        kinds,
        sizes.fit("state_shape", read_complex(group, "state_shape"), *by_state),
        sizes.fit("channel_shape", channel_shape, "modes", "channels", gaps=True),
        sizes.fit("participation", group["participation"][()], *by_state),
    )
