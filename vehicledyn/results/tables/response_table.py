"""Frequency responses as a table and as a result file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.results.store.consistency import Sizes
from vehicledyn.results.store.linear_file import (
    Quantity,
    new_file,
    old_file,
    read_complex,
    read_quantities,
    write_axis,
    write_numbers,
    write_quantities,
)

FORMAT = "vehicledyn-response"


@dataclass(frozen=True)
class ResponseTable:
    """Complex responses of outputs to inputs.

    ``frequency`` (n_frequencies,) [Hz], ``response`` (n_frequencies, n_inputs, n_outputs) in
    units of the output by those of the input, SI, and ``static_gain`` (n_inputs, n_outputs),
    nan where the output does not settle. ``speed`` is that of the reference motion [m/s].
    """

    title: str
    model: str
    speed: float
    frequency: Any
    inputs: tuple[Quantity, ...]
    outputs: tuple[Quantity, ...]
    response: Any
    static_gain: Any

    @property
    def magnitude(self) -> Any:
        """Magnitudes, shaped like the response."""
        return np.abs(self.response)

    @property
    def phase(self) -> Any:
        """Phases without jumps along the frequency, positive where the output leads [rad]."""
        angles = np.angle(self.response)
        angles[~np.isfinite(self.response)] = np.nan
        phases = np.full(angles.shape, np.nan)
        for place in np.ndindex(angles.shape[1:]):
            column = angles[(slice(None), *place)]
            known = np.isfinite(column)
            phases[(known, *place)] = np.unwrap(column[known])
        return phases


def ratio_unit(output: str, given: str) -> str:
    """Return the unit of an output by an input.

    >>> ratio_unit("rad/s", "m"), ratio_unit("m", "m"), ratio_unit("m", "N/m")
    ('rad/s/m', '1', 'm/(N/m)')
    """
    if output == given:
        return "1"
    if given in ("1", ""):
        return output
    below = f"({given})" if any(sign in given for sign in "*/") else given
    return f"{output}/{below}"


def write_response(path: Path, table: ResponseTable) -> None:
    """Write responses to a file.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    head = {"title": table.title, "model": table.model, "speed": table.speed}
    with new_file(path, FORMAT, head) as file:
        values = np.asarray(table.frequency, dtype=float)
        frequency = write_axis(file, "frequency", values, ("Hz", "Frequency"))
        inputs = write_quantities(file, "input", table.inputs)
        outputs = write_quantities(file, "output", table.outputs)
        scales = (frequency, inputs, outputs)
        words = ("unit of output/unit of input", "Response, output by input")
        write_numbers(file, "response", table.response, scales, words)
        write_numbers(file, "magnitude", table.magnitude, scales, (words[0], "Magnitude"))
        write_numbers(file, "phase", table.phase, scales, ("rad", "Phase of output to input"))
        write_numbers(file, "static_gain", table.static_gain, scales[1:], (words[0], "At rest"))


def read_response(path: Path) -> ResponseTable:
    """Return the responses in a file.

    Raises
    ------
    InputError
        If the file cannot be read or holds something else.
    """
    with old_file(path, FORMAT) as file:
        inputs, outputs = read_quantities(file, "input"), read_quantities(file, "output")
        sizes = Sizes({"inputs": len(inputs), "outputs": len(outputs)})
        response = read_complex(file, "response")
        if not len(file["frequency"]):
            raise ValueError("it holds no frequency")
        return ResponseTable(
            str(file.attrs["title"]),
            str(file.attrs["model"]),
            float(file.attrs["speed"]),
            sizes.fit("frequency", file["frequency"][()], "frequencies"),
            inputs,
            outputs,
            sizes.fit("response", response, "frequencies", "inputs", "outputs", gaps=True),
            sizes.fit("static_gain", file["static_gain"][()], "inputs", "outputs", gaps=True),
        )
