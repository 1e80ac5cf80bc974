"""The verb "response": outputs of a linearised model to sines of its inputs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vehicledyn.analyse.linearise import Linearisation, linearise
from vehicledyn.analyse.modes import eigenmodes
from vehicledyn.analyse.response_figures import key_figures
from vehicledyn.analyse.transfer import InputTerm, TransferSystem
from vehicledyn.analyses.linear.frequency_grid import FrequencyGrid
from vehicledyn.analyses.linear.held_speed import held_speed_point
from vehicledyn.analyses.linear.input_names import InputPart, ModelInput, hint
from vehicledyn.analyses.linear.linear_inputs import Excited
from vehicledyn.analyses.linear.response_report import ResponseReport
from vehicledyn.analyses.preparation.own_speed import at_speed, refuse_idle_speed
from vehicledyn.analyses.preparation.prepare import AssembledPoint, prepare
from vehicledyn.analyses.preparation.prepared import Derived, Prepared, Progress
from vehicledyn.analyses.preparation.runnable import Subject
from vehicledyn.analyses.preparation.steadiness import unsteadiness
from vehicledyn.analyses.preparation.validity.points import beam_warnings
from vehicledyn.base.argument_names import argument, given
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario.target import Target
from vehicledyn.kernel.derivatives import Derivatives
from vehicledyn.multibody.model.system import System
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.response_table import ResponseTable
from vehicledyn.symbolic import ops

_MOVES = 1e-12
_GROWS = 1e-6
"""Real part above which a mode counts as growing [1/s]."""

_UNDAMPED = 1e-9


@dataclass(frozen=True)
class Linearised:
    """A model with inputs, linearised about a reference motion at a speed [m/s]."""

    prepared: Prepared
    point: AssembledPoint
    linear: Linearisation
    inputs: tuple[ModelInput, ...]
    columns: dict[str, int]
    speed: float

    @property
    def remarks(self) -> tuple[str, ...]:
        """What makes the reference motion doubtful."""
        point = self.prepared, self.point
        return tuple(filter(None, (unsteadiness(*point), *beam_warnings(*point))))


def find_response(
    target: Target,
    *,
    inputs: Sequence[str],
    outputs: Sequence[str],
    grid: FrequencyGrid,
    at: Sequence[float] = (),
    speed: float | None = None,
    progress: Progress,
) -> ResponseReport:
    """Return the frequency responses of outputs to inputs about a reference motion.

    Parameters
    ----------
    target
        A scenario or a model.
    inputs
        Names of inputs, see :meth:`~vehicledyn.analyses.linear.linear_inputs.Excited.add`.
    outputs
        Names of channels.
    grid
        Frequencies.
    at
        Frequencies to report magnitude and phase at [Hz].
    speed
        Forward speed [m/s]; None for the scenario's, or standstill.
    progress
        Called with what is being done.

    Raises
    ------
    InputError
        If an input, output or frequency is not usable.
    NumericalError
        If there is no such reference motion.
    """
    model = linearise_with_inputs(
        target, inputs=inputs, speed=speed, progress=progress, outputs=outputs
    )
    chosen = chosen_rows(model.prepared, outputs)
    progress("computing the response", None)
    system = transfer_system(model, chosen)
    channels = model.prepared.equations.channels
    table = ResponseTable(
        title=target.title,
        model=model.prepared.equations.name,
        speed=model.speed,
        frequency=grid.frequencies(),
        inputs=tuple(Quantity(i.name, i.unit, i.description) for i in model.inputs),
        outputs=tuple(
            Quantity(channels[k].name, channels[k].unit, channels[k].description) for k in chosen
        ),
        response=system.response(grid.frequencies()),
        static_gain=system.static_gain(),
    )
    return _report(model, system, table, at)


def linearise_with_inputs(
    target: Target,
    *,
    inputs: Sequence[str],
    speed: float | None,
    progress: Progress,
    outputs: Sequence[str] = (),
) -> Linearised:
    """Return a model linearised about its reference motion, with derivatives by inputs.

    Inputs, then ``outputs`` that there are not, are refused before anything takes long.
    """
    taken: list[Excited] = []
    target, speed = at_speed(target, speed)
    scenario = target.choices
    wanted = speed if speed is not None else (scenario.speed or 0.0 if scenario else 0.0)

    def excite(subject: Subject) -> Subject:
        excited = Excited(subject)
        for name in dict.fromkeys(inputs):
            excited.add(name)
        _check_moving(excited, wanted)
        excited.add_thrust()
        taken.append(excited)
        return excited.subject

    def check(derived: Derived) -> None:
        if speed:
            refuse_idle_speed(derived)
        chosen_rows(derived, outputs)

    prepared = prepare(
        target,
        backend="interpreted",
        progress=progress,
        change=excite,
        check=check,
        varies_states=True,
    )
    found = taken[0].inputs
    names = list(dict.fromkeys(n for i in found for p in i.parts for n in p.parameters))
    derivatives = Derivatives(prepared.equations, names)
    prepared = prepared.with_derivatives(derivatives)
    progress("finding the reference motion", None)
    point = held_speed_point(prepared, wanted, scenario.start if scenario else None)
    linear = linearise(
        prepared.equations,
        prepared.kernel.parameters,
        prepared.subject.balance_time,
        point.state,
        point.unknowns,
        derivatives=derivatives,
    )
    columns = {name: k for k, name in enumerate(names)}
    model = Linearised(prepared, point, linear, tuple(found), columns, wanted)
    _check_parameters(model)
    return model


def transfer_system(model: Linearised, rows: Sequence[int]) -> TransferSystem:
    """Return the transfer system of chosen channels."""
    linear = model.linear
    terms = tuple(tuple(_term(model, part, rows) for part in item.parts) for item in model.inputs)
    return TransferSystem(linear.matrix, linear.output_matrix[list(rows)], terms)


def _term(model: Linearised, part: InputPart, rows: Sequence[int]) -> InputTerm:
    linear = model.linear
    state = np.zeros((3, len(linear.names)))
    output = np.zeros((3, len(rows)))
    for power, name in enumerate(part.parameters):
        column = model.columns[name]
        state[power] = linear.input_matrix[:, column]
        output[power] = linear.feedthrough[list(rows), column]
    return InputTerm(state, output, _delay(model, part), _gain(model, part))


def _gain(model: Linearised, part: InputPart) -> float:
    """Return the value of a gain that parameters give."""
    system: System = model.prepared.subject.system
    symbols = ops.column([entry.symbol for entry in system.table.entries])
    value = ops.numeric([symbols], ops.column([ops.scalar(part.gain)]))
    return float(np.ravel(value(model.prepared.kernel.parameters))[0])


def _delay(model: Linearised, part: InputPart) -> float:
    """Return how much later than the foremost a wheel runs over a place of the road [s]."""
    if not part.wheel:
        return 0.0
    channels = {c.name: k for k, c in enumerate(model.prepared.equations.channels)}
    values = model.prepared.kernel.outputs(
        model.prepared.subject.balance_time, model.point.state, model.point.unknowns
    )
    wheels = {p.wheel for i in model.inputs for p in i.parts if p.wheel}
    places = {wheel: values[channels[f"{wheel}.contact_x"]] for wheel in wheels}
    return float(max(places.values()) - places[part.wheel]) / model.speed


def _check_parameters(model: Linearised) -> None:
    """Refuse parameters that close the loops elsewhere: the velocity of that would be missing."""
    dependent = len(model.prepared.equations.structure.get("dependent", ()))
    for item in model.inputs:
        if item.is_parameter:
            moved = model.linear.unknowns_by_input[
                :dependent, model.columns[item.parts[0].parameters[0]]
            ]
            if np.abs(moved).max(initial=0.0) > _MOVES:
                raise InputError(
                    f"{given('inputs', item.name)}: the parameter changes the loops, and "
                    "their velocity "
                    "would not follow; put a joint of role 'driven' there and move that"
                )


def _check_moving(excited: Excited, speed: float) -> None:
    """Refuse roads as inputs of a vehicle that stands."""
    for item in excited.inputs:
        if speed <= 0.0 and any(part.wheel for part in item.parts):
            raise InputError(
                f"{given('inputs', item.name)}: a road is run over at a speed; give "
                f"{argument('speed')}"
            )


def chosen_rows(prepared: Derived | Prepared, outputs: Sequence[str]) -> list[int]:
    """Return the numbers of channels by name.

    Raises
    ------
    InputError
        If there is none of a name.
    """
    names = {channel.name: k for k, channel in enumerate(prepared.equations.channels)}
    for name in outputs:
        if name not in names:
            raise InputError(
                f"{given('outputs', name)}: there is no such channel{hint(name, list(names))}"
            )
    return [names[name] for name in dict.fromkeys(outputs)]


def _report(
    model: Linearised, system: TransferSystem, table: ResponseTable, at: Sequence[float]
) -> ResponseReport:
    modes = eigenmodes(model.linear.matrix, model.linear.names)
    turning = [m for m in modes if m.is_oscillation]
    poles = [abs(m.eigenvalue.imag) / (2.0 * math.pi) for m in turning]
    undamped = [m.frequency for m in turning if abs(m.damping_ratio) < _UNDAMPED]
    figures = {}
    for i in range(len(table.inputs)):
        for k in range(len(table.outputs)):
            part = TransferSystem(system.matrix, system.output[[k]], (_only(system.inputs[i], k),))

            def magnitude(f: float, part: TransferSystem = part) -> float:
                return float(np.abs(part.response(f))[0, 0, 0])

            gain = float(table.static_gain[i, k])
            figures[i, k] = key_figures(magnitude, table.frequency, gain, poles)
    return ResponseReport(
        table=table,
        figures=figures,
        at=tuple(at),
        response_at=system.response(np.array(at)) if len(at) else np.zeros((0, 0, 0)),
        growing=sum(m.eigenvalue.real > _GROWS for m in modes),
        undamped=tuple(f for f in undamped if table.frequency[0] <= f <= table.frequency[-1]),
        remark="\n".join(model.remarks),
    )


def _only(terms: tuple[InputTerm, ...], row: int) -> tuple[InputTerm, ...]:
    return tuple(InputTerm(t.state, t.output[:, [row]], t.delay, t.factor) for t in terms)
