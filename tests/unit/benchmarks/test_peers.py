"""The comparison with other engines: what is handed to them, and engines that are missing."""

import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def benchmarks():
    """The modules of the folder, which is no package."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT / "benchmarks"))
        import chains
        import own
        import peers

        yield chains, own, peers
    for name in ("chains", "own", "peers", "speed"):
        sys.modules.pop(name, None)


def test_missing_engines_are_told(benchmarks, tmp_path, capsys):
    _, _, peers = benchmarks
    assert peers.find_peers(tmp_path, install=False) == []
    assert str(tmp_path) in capsys.readouterr().out


def test_engine_that_is_not_installed_is_named(benchmarks, tmp_path, capsys):
    _, _, peers = benchmarks
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "python").symlink_to(sys.executable)
    found = peers.find_peers(tmp_path, install=False)
    for peer in found:
        peer.close()
    known = {peer.name for peer in found}
    told = capsys.readouterr().out
    assert all(name in known or f"{name} is left out" in told for name in peers.PACKAGES)


def test_numbers_for_other_engines_give_the_same_potential_energy(benchmarks):
    """Frames, masses and centres of mass, put together here by hand."""
    chains, own, _ = benchmarks
    system = chains.build("chain of 2", 2, chains.serial)
    model = own.describe(system, chains.serial)
    angles = np.array([0.3, -0.4])

    def energy(q):
        place, turn, total = np.zeros(3), np.eye(3), 0.0
        for body, angle in zip(model["bodies"], q, strict=True):
            place = place + turn @ body["at"]
            axis = np.eye(3)[body["axis"]]
            cross = np.cross(np.eye(3), axis)
            spin = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
            turn = turn @ np.array(body["rotation"]) @ spin
            total -= body["mass"] * np.dot(model["gravity"], place + turn @ body["com"])
        return total

    from vehicledyn.kernel.make_kernel import compile_kernel
    from vehicledyn.multibody import derive

    kernel = compile_kernel(derive(system), backend="interpreted")
    names = [channel.name for channel in kernel.equations.channels]
    gravity = names.index("energy.gravity")

    def told(q):
        return kernel.outputs(0.0, own.state_of(kernel, q, np.zeros(2)), np.zeros(0))[gravity]

    for moved in (np.array([1.2, 0.1]), np.array([-0.4, 2.0])):
        assert energy(moved) - energy(angles) == pytest.approx(
            told(moved) - told(angles), rel=1e-10
        )
