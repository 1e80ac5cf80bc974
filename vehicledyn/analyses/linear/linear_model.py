"""Linearised models to take elsewhere: matrices with names, as MATLAB's, NumPy's or control's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.analyse.gradients.state_space_slopes import StateSpaceSlopes
from vehicledyn.analyse.state_space import StateSpace, proper, reduced
from vehicledyn.analyses.linear.input_names import ModelInput, hint
from vehicledyn.analyses.linear.linear_inputs import PREFIX
from vehicledyn.analyses.linear.linear_slopes import differentiable, matrix_slopes
from vehicledyn.analyses.linear.response import (
    Linearised,
    chosen_rows,
    linearise_with_inputs,
    transfer_system,
)
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.base.errors import InputError, MissingPartError
from vehicledyn.base.files.whole_file import whole_file
from vehicledyn.files.scenario.target import Target
from vehicledyn.results.store.linear_file import Quantity

_SUFFIXES = (".mat", ".npz")


@dataclass(frozen=True)
class LinearModel:
    """A linearised model: its system, names of states, inputs and outputs with SI units.

    The states are those of the model, moved so that only the inputs themselves act. Where an
    output feels the rate or acceleration of an input directly, this is the input, and the input
    a state. Those of a reduced model have no names of their own.

    ``slopes`` are derivatives of the matrices by ``parameters``, where they were asked for;
    ``remarks`` say what makes the reference motion doubtful.
    """

    title: str
    system: StateSpace
    states: tuple[str, ...]
    inputs: tuple[Quantity, ...]
    outputs: tuple[Quantity, ...]
    speed: float
    full_order: int
    parameters: tuple[Quantity, ...] = ()
    slopes: StateSpaceSlopes | None = None
    remarks: tuple[str, ...] = ()

    @property
    def messages(self) -> tuple[str, ...]:
        """Remarks."""
        return self.remarks

    def as_text(self) -> str:
        """Return the size of the model, its eigenvalues and what a reduction may miss."""
        order = len(self.states)
        lines = [f"{self.title}: {order} states of {self.full_order}"]
        lines += [f"  input   {item.name} [{item.unit}]" for item in self.inputs]
        lines += [f"  output  {item.name} [{item.unit}]" for item in self.outputs]
        for value in sorted(np.linalg.eigvals(self.system.a), key=lambda v: -v.real):
            if value.imag >= 0.0:
                lines.append(f"  eigenvalue  {value.real:+.6g} {value.imag:+.6g}i 1/s")
        if order < self.full_order:
            lines.append(f"  gains differ from the full model's by at most {self.system.error:.3g}")
        if self.slopes is not None:
            lines.append(f"  derivatives of A, B, C and D by {len(self.parameters)} parameters")
        return "\n".join([*lines, *self.remarks])

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data, in SI."""
        return {key: _plain(value) for key, value in self._items().items()}

    def _items(self) -> dict[str, Any]:
        items: dict[str, Any] = {
            "title": self.title,
            "A": self.system.a,
            "B": self.system.b,
            "C": self.system.c,
            "D": self.system.d,
            "states": list(self.states),
            "inputs": [item.name for item in self.inputs],
            "input_units": [item.unit for item in self.inputs],
            "outputs": [item.name for item in self.outputs],
            "output_units": [item.unit for item in self.outputs],
            "hankel_singular_values": self.system.hankel,
            "error_bound": self.system.error,
            "speed": self.speed,
            "remarks": list(self.remarks),
        }
        if self.slopes is not None:
            items["parameters"] = [item.name for item in self.parameters]
            items["parameter_units"] = [item.unit for item in self.parameters]
            for letter in "abcd":
                items[f"d{letter.upper()}"] = getattr(self.slopes, letter)
        return items

    def save(self, path: str | Path) -> Path:
        """Write matrices and names to a MATLAB (.mat) or NumPy file (.npz).

        Raises
        ------
        InputError
            If the ending is another one, or the file cannot be written.
        """
        place = Path(path)
        if place.suffix not in _SUFFIXES:
            raise InputError(f"{place}: expected a file that ends in {' or '.join(_SUFFIXES)}")
        items = self._items()
        try:
            with whole_file(place) as scratch, scratch.open("wb") as file:
                if place.suffix == ".npz":
                    arrays: dict[str, Any] = {key: np.asarray(v) for key, v in items.items()}
                    np.savez(file, **arrays)
                else:
                    from scipy.io import savemat

                    texts = {k: np.array(v, dtype=object) for k, v in items.items() if _is_texts(v)}
                    savemat(file, items | texts)
        except OSError as error:
            raise InputError(f"{place}: cannot be written: {error.strerror or error}") from None
        return place

    def to_control(self) -> Any:
        """Return a ``control.StateSpace`` with the names of states, inputs and outputs.

        Their dots become underscores, as python-control allows no dots in names.

        Raises
        ------
        MissingPartError
            If python-control is not installed.
        """
        try:
            import control
        except ImportError:
            raise MissingPartError(
                "linear models for python-control need it; install it with 'pip install control'"
            ) from None
        s = self.system
        return control.ss(
            s.a,
            s.b,
            s.c,
            s.d,
            states=_without_dots(self.states),
            inputs=_without_dots([item.name for item in self.inputs]),
            outputs=_without_dots([item.name for item in self.outputs]),
        )


def _without_dots(names: Sequence[str]) -> list[str]:
    return [name.replace(".", "_") for name in names]


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else value


def _is_texts(value: Any) -> bool:
    return isinstance(value, list)


_DERIVATIVES = (("", ""), (".rate", "/s"), (".acceleration", "/s^2"))
"""Endings of names and units of an input's derivatives."""


def _derived(item: ModelInput, order: int) -> Quantity:
    """Return an input, or its derivative of an order."""
    name, unit = _DERIVATIVES[order]
    return Quantity(item.name + name, item.unit + unit, item.description)


def _input_states(inputs: Sequence[ModelInput], orders: Sequence[int]) -> list[str]:
    """Return the names of the states that inputs have become."""
    return [
        _derived(item, k).name
        for item, order in zip(inputs, orders, strict=True)
        for k in range(order)
    ]


def find_linear_model(
    target: Target,
    *,
    inputs: Sequence[str],
    outputs: Sequence[str],
    speed: float | None,
    order: int | None,
    progress: Progress,
    to: Sequence[str] = (),
) -> LinearModel:
    """Return a model linearised about its reference motion, in state space.

    Parameters
    ----------
    target
        A scenario or a model.
    inputs, outputs
        As of frequency responses.
    speed
        Forward speed [m/s]; None for the scenario's, or standstill.
    order
        States to keep, by balanced truncation; all if None.
    progress
        Called with what is being done.
    to
        Patterns of parameters that the matrices are to be differentiated by.

    Raises
    ------
    InputError
        If an input, output, order or pattern is not usable, or an input acts with a delay.
    NumericalError
        If there is no such reference motion.
    """
    if to and order is not None:
        raise InputError("a reduced model has no derivatives here; leave the order or the patterns")
    model = linearise_with_inputs(
        target, inputs=inputs, speed=speed, progress=progress, outputs=outputs
    )
    rows = chosen_rows(model.prepared, outputs)
    system, orders = proper(transfer_system(model, rows))
    names: Sequence[str] = [*model.linear.names, *_input_states(model.inputs, orders)]
    full_order = len(names)
    if order is not None:
        progress("reducing the model", None)
        system = reduced(system, order)
        names = [f"reduced_{k + 1}" for k in range(len(system.a))]
    e = model.prepared.equations
    channels = [e.channels[k] for k in rows]
    parameters, slopes = _slopes(model, rows, orders, to=to, target=target, progress=progress)
    return LinearModel(
        target.title,
        system,
        tuple(names),
        tuple(_derived(i, order) for i, order in zip(model.inputs, orders, strict=True)),
        tuple(Quantity(c.name, c.unit, c.description) for c in channels),
        model.speed,
        full_order,
        parameters,
        slopes,
        model.remarks,
    )


def _slopes(
    model: Linearised,
    rows: list[int],
    orders: list[int],
    *,
    to: Sequence[str],
    target: Target,
    progress: Progress,
) -> tuple[tuple[Quantity, ...], StateSpaceSlopes | None]:
    """Return the parameters that patterns name, and the derivatives of the matrices by them."""
    if not to:
        return (), None
    e = model.prepared.equations
    own = [(k, p) for k, p in enumerate(e.parameters) if not p.name.startswith(f"{PREFIX}.")]
    patterns = [pattern.removeprefix("parameters.") for pattern in to]
    for pattern in patterns:
        if not any(fnmatchcase(p.name, pattern) for _, p in own):
            known = [p.name for _, p in own]
            raise InputError(
                f"'{pattern}' matches no parameter of '{e.name}'{hint(pattern, known)}"
            )
    chosen = [(k, p) for k, p in own if any(fnmatchcase(p.name, item) for item in patterns)]
    progress("differentiating the matrices", None)
    found = matrix_slopes(differentiable(model, rows, target), orders, [k for k, _ in chosen])
    return tuple(Quantity(p.name, p.unit, p.description) for _, p in chosen), found
