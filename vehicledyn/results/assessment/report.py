"""The assessment of a result file, for people and for programs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.results.assessment.assess import Assessment, assess
from vehicledyn.results.assessment.comfort import DIRECTIONS, Comfort
from vehicledyn.results.assessment.subjects import find_subjects
from vehicledyn.results.store.reader import ENDS, open_result

_KILO = 1e-3


@dataclass(frozen=True)
class AssessmentReport:
    """An assessment with the file it is of."""

    path: str
    title: str
    state_of_run: str
    whole: bool
    assessment: Assessment

    def as_dict(self) -> dict[str, Any]:
        """Return plain data that JSON can hold, in SI."""
        head = {"result": self.path, "title": self.title, "state_of_run": self.state_of_run}
        return head | asdict(self.assessment)

    def as_text(self) -> str:
        """Return tables for a person; a partial file says so first."""
        tables = (
            _wheels(self.assessment),
            _axles(self.assessment),
            _stability(self.assessment),
            _wear(self.assessment),
            _behaviour(self.assessment),
            _comfort(self.assessment.comfort),
            _vibration(self.assessment),
            _transitions(self.assessment),
            _remarks(self.assessment),
        )
        return "\n".join([*self._heading(), *(line for table in tables for line in table)])

    def _heading(self) -> Iterator[str]:
        found = self.assessment
        if not self.whole:
            yield self.state_of_run.replace("partial", "PARTIAL RESULT", 1)
            yield ""
        way = "" if found.way is None else f", {found.way:.5g} m"
        yield f"{self.path}: {self.title}"
        yield f"  {found.begin:.6g} to {found.end:.6g} s{way}, {found.rate:.4g} samples a second"


def assess_result(
    path: str | Path, *, begin: float | None = None, end: float | None = None
) -> AssessmentReport:
    """Return the assessment of a result file.

    Parameters
    ----------
    path
        Result of a run.
    begin, end
        Limits of the section to assess; the whole run if absent [s].

    Raises
    ------
    InputError
        If the file cannot be read, has nothing to assess, or no samples in the section.
    """
    with open_result(path, ENDS) as result:
        if not result.is_timed:
            raise InputError(f"{path}: has nothing to assess: its samples are not taken in time")
        units = result.units
        subjects = find_subjects(units)
        if not subjects.axles and not subjects.sensors:
            raise InputError(
                f"{path}: has nothing to assess: neither forces of wheels on rails, such as "
                "'front.left.Q', nor an accelerometer; keep them with output.channels"
            )
        return AssessmentReport(
            path=str(path),
            title=result.title,
            state_of_run=result.state_of_run,
            whole=result.is_whole,
            assessment=assess(
                result.column("time"),
                {name: result.column(name) for name in subjects.channels(units)},
                units,
                begin=begin,
                end=end,
                vibration=True,
            ),
        )


def _wheels(found: Assessment) -> list[str]:
    head = ("Q0 kN", "Q qst kN", "Q max kN", "Q min kN", "unloading", "Y qst kN", "Y/Q 2 m")
    rows = [
        (
            wheel.name,
            _kilo(wheel.static),
            _kilo(wheel.vertical_quasi_static),
            _kilo(wheel.vertical_largest),
            _kilo(wheel.vertical_smallest),
            f"{wheel.unloading:.3f}",
            _kilo(wheel.guiding_quasi_static),
            "-" if wheel.derailment is None else f"{wheel.derailment:.3f}",
        )
        for wheel in found.wheels
    ]
    return _table("Wheels", head, rows)


def _axles(found: Assessment) -> list[str]:
    rows = [
        (
            axle.name,
            _kilo(axle.track_shift),
            _kilo(axle.limit),
            f"{100.0 * abs(axle.track_shift) / axle.limit:.1f}",
        )
        for axle in found.axles
    ]
    return _table("Sum of Y over 2 m", ("kN", "limit kN", "% of it"), rows)


def _stability(found: Assessment) -> list[str]:
    rows = [
        (
            axle.name,
            _kilo(axle.rms),
            _kilo(axle.limit),
            f"{100.0 * axle.rms / axle.limit:.1f}",
            f"{axle.frequency:.2f}",
        )
        for axle in found.stability
    ]
    head = ("kN", "limit kN", "% of it", "at Hz")
    return _table("Instability: rms of the sum of Y over 100 m", head, rows)


def _wear(found: Assessment) -> list[str]:
    rows = [
        (wear.name, f"{wear.mean:.4g}", f"{wear.largest:.4g}", f"{wear.work:.4g}")
        for wear in found.wear
    ]
    return _table("Wear number", ("mean N", "largest N", "sum J"), rows)


def _behaviour(found: Assessment) -> list[str]:
    rows = [
        (
            f"{one.name}.{one.direction}",
            f"{one.largest:.3f}",
            f"{one.rms:.3f}",
            f"{one.quasi_static:.3f}",
        )
        for one in found.behaviour
    ]
    head = ("99.85 %", "rms", "quasi-static")
    return _table("Accelerations, 0.4 to 10 Hz, m/s^2", head, rows)


def _comfort(comfort: Sequence[Comfort]) -> list[str]:
    head = ("N_MV", *(f"C_C {d}" for d in DIRECTIONS), "Wz lateral", "Wz vertical")
    rows = [
        (
            one.name,
            _or_dash(one.mean, 3),
            *(
                _or_dash(float(one.continuous[d].max()) if d in one.continuous else None, 4)
                for d in DIRECTIONS
            ),
            *(_or_dash(one.sperling.get(d), 3) for d in ("lateral", "vertical")),
        )
        for one in comfort
    ]
    return _table("Comfort (C_C: largest of 5 s, m/s^2)", head, rows)


def _vibration(found: Assessment) -> list[str]:
    rows = [
        (
            f"{one.name}.{direction}",
            *(f"{v:.4g}" for v in (axis.rms, axis.transient, axis.dose, axis.crest_factor)),
        )
        for one in found.vibration
        for direction, axis in one.axes.items()
    ]
    rows += [(f"{v.name}, total", f"{v.total:.4g}", "", "", "") for v in found.vibration if v.total]
    head = ("a_w m/s^2", "MTVV m/s^2", "VDV m/s^1.75", "crest factor")
    return _table("Vibration, ISO 2631-1", head, rows)


def _transitions(found: Assessment) -> list[str]:
    rows = [
        (
            f"{one.name}, {one.begin:.1f} to {one.end:.1f} s",
            f"{one.acceleration:.3f}",
            f"{one.jerk:.3f}",
            f"{one.roll_rate:.4f}",
            f"{one.standing:.1f}",
            f"{one.seated:.1f}",
        )
        for one in found.transitions
    ]
    head = ("m/s^2", "m/s^3", "rad/s", "standing %", "seated %")
    return _table("Comfort on curve transitions, P_CT", head, rows)


def _remarks(found: Assessment) -> list[str]:
    return ["", "Remarks", *(f"  {text}" for text in found.remarks)] if found.remarks else []


def _kilo(force: float) -> str:
    return f"{_KILO * force:.2f}"


def _or_dash(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def _table(title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    if not rows:
        return []
    columns = list(zip((title, *head), *rows, strict=True))
    widths = [max(map(len, column)) for column in columns]
    widths[0] = max(widths[0] - 2, *(len(row[0]) for row in rows))
    lines = [f"{title:<{widths[0] + 2}}"]
    lines += [f"  {row[0]:<{widths[0]}}" for row in rows]
    for column, width in zip(columns[1:], widths[1:], strict=True):
        lines = [f"{line}  {cell:>{width}}" for line, cell in zip(lines, column, strict=True)]
    return ["", *lines]
