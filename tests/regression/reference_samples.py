"""Print the changes that make the result of a system's scenario small enough to keep.

``python tests/regression/reference_samples.py scenarios/systems/four_bar.yaml`` prints words for
the command line of ``vehicledyn run``: at most twenty samples, energies and six coordinates.
"""

from __future__ import annotations

import sys
from pathlib import Path

MOST_SAMPLES = 20
MOST_COORDINATES = 6
OWN_INTERVAL = ("four_bar_chain",)
"""Scenarios that pass singular configurations, where a sample's place moves the result a little.

Of these the reference holds the beginning, sample by sample.
"""
WITHOUT_ENERGY = ("coach_flexible_body",)
"""Scenarios whose energy is that of the travel: of 47 MJ hardly anything changes.

What a micrometre a second adds to it is as large as the tolerance of the comparison.
"""


def overrides(path: Path) -> list[str]:
    """Return "key=value" of interval and channels for a scenario of a system."""
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.analyses.preparation.build_model import build_subject
    from vehicledyn.base.units import to_si
    from vehicledyn.files.scenario import load_scenario

    loaded = load_scenario(path)
    s = loaded.scenario
    brief = _brief().get(path.stem)
    duration = s.duration if brief is None else to_si(brief, "s")
    count = round(duration / s.output.interval)
    samples = max(n for n in range(1, MOST_SAMPLES + 1) if count % n == 0)
    system = build_subject(loaded).system
    names = [joint.name for joint in system.joints() if joint.role != "driven"]
    stride = -(-len(names) // MOST_COORDINATES)
    energies = [] if path.stem in WITHOUT_ENERGY else ["energy.*"]
    channels = [*names[::stride], *energies]
    chosen = f"output.channels=[{', '.join(channels)}]"
    if path.stem in OWN_INTERVAL:
        return [f"duration={2 * MOST_SAMPLES * s.output.interval:.12g} s", chosen]
    changes = [f"output.interval={s.output.interval * (count // samples):.12g} s", chosen]
    return changes if brief is None else [*changes, f"duration={brief}"]


def _brief() -> dict[str, str]:
    """Return how long the references of scenarios are that are too long to run whole."""
    lines = Path(__file__).with_name("brief.txt").read_text(encoding="utf-8").splitlines()
    found = {}
    for line in lines:
        if not line.startswith("#"):
            name, duration = line.split(maxsplit=1)
            found[name] = duration
    return found


if __name__ == "__main__":
    sys.stdout.write("\n".join(overrides(Path(sys.argv[1]))) + "\n")
