"""The page reports/speed.md, from what peers.py has measured."""

from __future__ import annotations

import datetime
import platform

import own
import speed

import vehicledyn


def page(peers, rows, bars, cars, slalom, *, error, duration):
    """Return the text of the report."""
    today = datetime.datetime.now(datetime.UTC).date()
    names = [f"{peer.name} {peer.version}" for peer in peers]
    lines = [
        "# Speed",
        "",
        "This page is generated. To make it anew, with the package installed:",
        "",
        "    python benchmarks/peers.py --peers FOLDER --install",
        "",
        f"{today}, {own.processor()}, {platform.system()}, Python {platform.python_version()}, "
        f"vehicledyn {vehicledyn.__version__}"
        + (", " + ", ".join(names) if names else "; no other engine was at hand")
        + ". Medians; candidates take turns; processor time unless wall time is said. On a "
        "machine with other work all times grow, the ratios stay.",
        "",
        "## Forward dynamics",
        "",
        "Turning joints with oblique frames and full inertias, numbers as parameters at run time; "
        "all engines on the same system. vehicledyn: one right-hand side inside the compiled "
        "Runge-Kutta loop, alone, and one of several side by side, each with numbers of its own, "
        "in the lanes of the processor; behind each engine how many times as long it takes as "
        "either. pinocchio: `aba` called from Python, less the call of a model with one "
        "joint. MuJoCo: `mj_forward` called from Python without contacts, less a call that reads "
        "one number. EXUDYN: a step of explicit Euler on its kinematic tree, the difference of two "
        "runs. The last column is the largest difference of accelerations over the largest "
        "acceleration.",
        "",
    ]
    lanes = f"in {rows[0].lanes} lanes" if rows else "in lanes"
    head = ["system", "vehicledyn", lanes, *[peer.name for peer in peers], "difference"]
    lines += ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for row in rows:
        cells = [row.system, f"{row.own:.0f} ns", f"{row.in_lanes:.0f} ns"]
        for value in row.others.values():
            times = f"{value / row.own:.1f} and {value / row.in_lanes:.1f} times"
            cells.append(f"{value:.0f} ns, {times}")
        cells.append(f"{max(row.differences.values()):.0e}" if row.differences else "")
        lines.append("| " + " | ".join(cells) + " |")
    lines += [
        "",
        "## Chain of twenty four-bar linkages",
        "",
        f"A02 of the IFToMM benchmark library, {duration:g} s, through four configurations in "
        "which every loop is singular. Error: the largest of the position of B0 at all samples, "
        f"against the exact motion; at most {error:g} m was asked for.",
        "",
        "| engine | method | error | processor time | wall time | ratio |",
        "|---|---|---|---|---|---|",
    ]
    for name, words, reached, cpu, wall in bars:
        ratio = f"{cpu / bars[0][3]:.1f}"
        lines.append(
            f"| {name} | {words} | {reached:.1e} m | {cpu:.3f} s | {wall:.3f} s | {ratio} |"
        )
    lines += ["", "## Iltis", "", "| quantity | operations | time | operations a cycle |"]
    lines.append("|---|---|---|---|")
    lines += [f"| {name} | {n} | {time:.0f} ns | {rate} |" for name, n, time, rate in cars]
    lines += [
        "",
        f"Slalom of {speed.DURATION:g} s, RK4 at 1 ms: {slalom:.3f} s, "
        f"{speed.DURATION / slalom:.0f} times real time.",
    ]
    return "\n".join(lines) + "\n"
