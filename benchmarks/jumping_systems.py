"""Random masses on forces that jump with place, speed or time, as scenarios with their systems."""

from __future__ import annotations

from pathlib import Path

import numpy as np

_SYSTEM = """title: A mass on a force that jumps
bodies:
  block: {{joints: [{{kind: T1, name: x, start: {place:.4f} m}}], mass: 1 kg}}
forces:
  spring: {{coordinate: block.x, force: "-{stiffness:.1f} N/m * position - {damping:.3f} N*s/m * rate"}}
  jump: {{coordinate: block.x, force: "{jump}"}}
initial: {{block.x_rate: {speed:.3f} m/s}}
"""  # noqa: E501
_SCENARIO = """title: A mass runs under a force that jumps
model: {name}.system.yaml
duration: 2 s
solver: {{kind: rk4, step: 0.1 ms}}
output: {{interval: 10 ms}}
"""


def jumping_systems(folder: Path, number: int, seed: int) -> list[str]:
    """Write so many systems and scenarios; return the scenarios without their ending."""
    random = np.random.default_rng(seed)
    found = []
    for k in range(number):
        facts = {
            "place": random.uniform(-0.05, 0.0),
            "speed": random.uniform(0.0, 0.5),
            "stiffness": random.choice([0.0, 0.0, random.uniform(20.0, 400.0)]),
            "damping": random.choice([0.0, random.uniform(0.1, 2.0)]),
            "jump": _jump(random),
        }
        name = f"jump_{k}"
        (folder / f"{name}.system.yaml").write_text(_SYSTEM.format(**facts))
        (folder / f"{name}.yaml").write_text(_SCENARIO.format(name=name))
        found.append(str(folder / name))
    return found


def _jump(random: np.random.Generator) -> str:
    """Return a force in words."""
    size, place = random.uniform(2.0, 20.0), random.uniform(0.0, 0.02)
    begin, length = random.uniform(0.05, 1.5), 10.0 ** random.uniform(-3.0, -1.0)
    return (
        f"where(position > {place:.5f} m, -{size:.2f} N, {size:.2f} N)",
        f"where(rate > 0 m/s, -{0.2 * size:.3f} N, {0.2 * size:.3f} N)",
        f"where(time > {begin:.5f} s, {size:.2f} N, -{0.5 * size:.2f} N)",
        f"where(time > {begin:.5f} s, where(time < {begin + length:.5f} s, "
        f"{0.5 / length:.2f} N, 0 N), 0 N)",
        f"where(position > {place:.5f} m, where(position < {place + 0.1 * length:.5f} m, "
        f"{10.0 * size:.2f} N, 0 N), 0 N)",
    )[random.integers(5)]
