"""All catalogues at once: importing this module registers every part that a scenario may name."""

from __future__ import annotations

import vehicledyn.files.system
import vehicledyn.integrate
import vehicledyn.rail
import vehicledyn.road
import vehicledyn.road.manoeuvres.kinds
import vehicledyn.vehicles  # noqa: F401
from vehicledyn.base.plugins import load_installed
from vehicledyn.base.registry import families, find, kinds


def first_lines(family: str) -> dict[str, str]:
    """Return the first line of the description of each entry of a catalogue, by name."""
    descriptions = {name: find(family, name).__doc__ or "" for name in kinds(family)}
    return {name: text.strip().partition("\n")[0] for name, text in descriptions.items()}


def counts() -> dict[str, int]:
    """Return the number of entries of each catalogue, by family."""
    import vehicledyn.cams.followers
    import vehicledyn.cams.laws
    import vehicledyn.cams.outlines  # noqa: F401
    from vehicledyn.files.system.kinds import load_kinds

    load_kinds()
    return {family: len(kinds(family)) for family in families()}


load_installed(counts)  # last, since plugins may use all that is above
