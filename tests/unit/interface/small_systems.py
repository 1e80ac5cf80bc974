"""Small systems built in Python for the tests of the front door."""

import vehicledyn as vd


def pendulum(angle=0.5):
    """Return a rod of 1 m and 1 kg that swings about one end."""
    table = vd.ParameterTable()
    length = table.add("length", 1.0, "m", "Length of the rod")
    across = length * length / 12.0
    rod = vd.Body(
        "rod", vd.GROUND, (0.0, 0.0, 0.0), (vd.Joint("R2", "rod.angle", start=angle),),
        mass=1.0, com=(0.0, 0.0, -length / 2.0), inertia=(across, across, 0.0),
    )  # fmt: skip
    return vd.System("pendulum", table, (rod,))
