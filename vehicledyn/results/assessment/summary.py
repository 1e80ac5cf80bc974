"""The worst figures of an assessment as lines of a run's summary."""

from __future__ import annotations

import math
from collections.abc import Iterator

from vehicledyn.results.assessment.assess import Assessment
from vehicledyn.results.assessment.comfort import Comfort
from vehicledyn.results.assessment.vibration import Vibration
from vehicledyn.results.store.layout import SummaryEntry


def summarise_assessment(found: Assessment) -> list[SummaryEntry]:
    """Return the worst wheel and axle of each kind, the comfort of each sensor, and the remarks."""
    entries = [*_safety(found), *_wear(found)]
    for one in found.behaviour:
        text = f"Largest {one.direction} acceleration, 0.4 to 10 Hz, 99.85 %"
        name = f"{one.name}.largest_{one.direction}"
        entries.append(SummaryEntry(name, abs(one.largest), "m/s^2", text))
    for comfort in found.comfort:
        entries.extend(_comfort(comfort))
    entries.extend(_transitions(found))
    if found.remarks:
        remarks = "; ".join(found.remarks)
        entries.append(SummaryEntry("assessment_remarks", remarks, "", ""))
    return [e for e in entries if not isinstance(e.value, float) or math.isfinite(e.value)]


def summarise_vibration(found: Vibration) -> Iterator[SummaryEntry]:
    """Yield the vibration at a seat by direction and altogether; what does not exist is left out.

    Parameters
    ----------
    found
        Vibration whose name begins those of the entries.
    """
    for direction, axis in found.axes.items():
        for key, value, unit, words in (
            ("weighted", axis.rms, "m/s^2", "Weighted {} acceleration, rms (ISO 2631-1:1997, 6.1)"),
            (
                "mtvv",
                axis.transient,
                "m/s^2",
                "Largest rms of 1 s, {} (ISO 2631-1:1997, 6.3.1)",
            ),
            ("vdv", axis.dose, "m/s^1.75", "Vibration dose value, {} (ISO 2631-1:1997, 6.3.2)"),
            ("crest_factor", axis.crest_factor, "1", "Crest factor, {} (ISO 2631-1:1997, 6.2.1)"),
        ):
            if math.isfinite(value):
                name = f"{found.name}.{key}_{direction}"
                yield SummaryEntry(name, value, unit, words.format(direction))
    if found.total is not None:
        words = "Vibration total value, rms of all directions (ISO 2631-1:1997, 6.5)"
        yield SummaryEntry(f"{found.name}.vibration_total", found.total, "m/s^2", words)
        words = "Likely reaction in public transport (ISO 2631-1:1997, C.2.3)"
        yield SummaryEntry(f"{found.name}.reaction", found.reaction, "", words)


def _safety(found: Assessment) -> Iterator[SummaryEntry]:
    if found.axles:
        axle = max(found.axles, key=lambda a: abs(a.track_shift) / a.limit)
        text = "Sum of Y over 2 m of a wheelset, 99.85 %, where nearest to its limit"
        yield SummaryEntry("largest_track_shift", abs(axle.track_shift), "N", text)
        yield SummaryEntry("track_shift_limit", axle.limit, "N", "Limit 10 kN + 2 Q0/3 of that sum")
        yield SummaryEntry("largest_track_shift_at", axle.name, "", "Wheelset with that sum")
    if found.stability:
        sways = max(found.stability, key=lambda a: a.rms / a.limit)
        text = "Largest rms of the sum of Y over 100 m, band of 4 Hz, where nearest to its limit"
        yield SummaryEntry("largest_instability", sways.rms, "N", text)
        yield SummaryEntry("instability_limit", sways.limit, "N", "Half the limit of the sum of Y")
        yield SummaryEntry("largest_instability_at", sways.name, "", "Wheelset with that rms")
        text = "Frequency at which the sum of Y of that wheelset oscillates most"
        yield SummaryEntry("instability_frequency", sways.frequency, "Hz", text)
    ratios = [wheel for wheel in found.wheels if wheel.derailment is not None]
    if ratios:
        wheel = max(ratios, key=lambda w: abs(w.derailment or 0.0))
        text = "Largest Y/Q over 2 m, 99.85 %; the limit is 0.8 for a flange of 70 deg"
        yield SummaryEntry("largest_y_over_q", abs(wheel.derailment or 0.0), "1", text)
        yield SummaryEntry("largest_y_over_q_at", wheel.name, "", "Wheel with that ratio")
    if not found.wheels:
        return
    wheel = max(found.wheels, key=lambda w: w.unloading)
    yield SummaryEntry("largest_unloading", wheel.unloading, "1", "Largest 1 - Q/Q0 of a wheel")
    yield SummaryEntry("largest_unloading_at", wheel.name, "", "Wheel with that unloading")
    lateral = max(abs(w.guiding_quasi_static) for w in found.wheels)
    yield SummaryEntry("largest_quasi_static_y", lateral, "N", "Largest median of Y of a wheel")
    vertical = max(w.vertical_quasi_static for w in found.wheels)
    yield SummaryEntry("largest_quasi_static_q", vertical, "N", "Largest median of Q of a wheel")
    peak = max(w.vertical_largest for w in found.wheels)
    yield SummaryEntry("largest_wheel_force", peak, "N", "Largest Q of a wheel, 99.85 %")


def _transitions(found: Assessment) -> Iterator[SummaryEntry]:
    for name in dict.fromkeys(one.name for one in found.transitions):
        own = [one for one in found.transitions if one.name == name]
        for word in ("standing", "seated"):
            text = f"Largest P_CT of EN 12299 on entering curves, {word}"
            value = max(getattr(one, word) for one in own)
            yield SummaryEntry(f"{name}.p_ct_{word}", value, "%", text)


def _wear(found: Assessment) -> Iterator[SummaryEntry]:
    if found.wear:
        mean, work = sum(w.mean for w in found.wear), sum(w.work for w in found.wear)
        text = "Mean wear number of all wheels together"
        yield SummaryEntry("wear_number", mean, "N", text)
        yield SummaryEntry("wear_work", work, "J", "Wear number summed over the way")


def _comfort(comfort: Comfort) -> Iterator[SummaryEntry]:
    if comfort.mean is not None:
        text = "Mean comfort of EN 12299; below 1.5 very comfortable, above 4.5 very uncomfortable"
        yield SummaryEntry(f"{comfort.name}.n_mv", comfort.mean, "1", text)
    for direction, value in comfort.sperling.items():
        text = f"Sperling's ride index, {direction}"
        yield SummaryEntry(f"{comfort.name}.wz_{direction}", value, "1", text)
