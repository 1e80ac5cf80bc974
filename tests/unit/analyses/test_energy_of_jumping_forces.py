"""The balance of the energy counts the work of forces that jump to the instant of the jump."""

import pytest

import vehicledyn as vd

PUSHED = """title: A mass is pushed, and let go
gravity: [0, 0, 0]
parameters: {pause: 0.5 s}
bodies:
  mass: {joints: [T1 x], mass: 2 kg}
springs:
  held: {coordinate: mass.x, law: {kind: spring_damper, stiffness: 100 N/m}}
wrenches:
  push: {body: mass, force: ["where(time <= pause, 8 N, where(time < 0.7 s, -2 N, 0 N))", 0, 0]}
"""
RUN = """title: A push
model: pushed.yaml
duration: 1 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 20 ms, animation: false}
"""


@pytest.mark.parametrize("pause", ["0.5 s", "0.503 s"])
def test_jumps_between_samples(tmp_path, pause):
    """Splines through the samples alone miss 2 to 10 % of the work."""
    (tmp_path / "pushed.yaml").write_text(PUSHED)
    (tmp_path / "run.yaml").write_text(RUN)
    run = vd.simulate(
        vd.load(tmp_path / "run.yaml"), backend="interpreted", parameters={"pause": pause}
    )
    work = run["energy.kinetic"].values.max()
    assert run.summary["energy_drift"].value < 5e-5 * work


@pytest.mark.parametrize(
    ("pause", "more", "told"),
    [
        ("0.5034 s", "", True),
        ("0.503 s", "", False),
        ("0.5034 s", "events:\n  jump: {when: time - pause}\n", False),
    ],
)
def test_jumps_within_steps_are_told(tmp_path, pause, more, told):
    """A step that passes over one is off; an event ends a step there."""
    (tmp_path / "pushed.yaml").write_text(PUSHED + more)
    (tmp_path / "run.yaml").write_text(RUN)
    run = vd.simulate(
        vd.load(tmp_path / "run.yaml"), backend="interpreted", parameters={"pause": pause}
    )
    words = "'push' jumps at t = 0.5034 s, within a step of 0.001 s"
    assert [words in note for note in run.notes if "jumps" in note] == [True] * told
