"""Channels that a system will have, known without solving its equations of motion.

The parts are asked for their outputs with accelerations and forces that are zero: what a channel
is called, and which there are, depends on the bodies and constraints only.
"""

from __future__ import annotations

from vehicledyn.multibody.equations.multipliers import may_take_multipliers
from vehicledyn.multibody.equations.outputs import DRIFT_CHANNELS, Exerted, Solved, observe
from vehicledyn.multibody.loops.loop_closure import Loops, close
from vehicledyn.multibody.loops.reactions import SolvedForces
from vehicledyn.multibody.model.symbols import Symbols, declare, motions
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.model.tree import unfold
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.quick_arithmetic import quick_arithmetic


@quick_arithmetic()
def outline_channels(system: System) -> list[Channel]:
    """Return the channels of the equations of a system, in their order.

    Where multipliers may serve that turn out not to, two channels of theirs are named in excess.

    Raises
    ------
    InputError
        If the system is not well formed.
    NumericalError
        If its loops cannot be assembled.
    """
    system.check()
    symbols = declare(system)
    loops = close(system, unfold(system.bodies), symbols, motions(system, symbols), None)
    solved = _unsolved(system, symbols, loops)
    kept = [row for row, _ in loops.closure.partition.pairs]
    none = dict.fromkeys(kept, ops.scalar(0.0))
    moving = solved.kinematics
    forces = SolvedForces(system, symbols, loops, kinematics=moving, wrenches=(), multipliers=none)
    exerted = Exerted({j.name: ops.scalar(0.0) for j in symbols.joints}, none, forces)
    found = [o.channel for o in observe(system, symbols, loops, solved, exerted)]
    return [*found, *DRIFT_CHANNELS] if may_take_multipliers(system, symbols, loops) else found


def _unsolved(system: System, symbols: Symbols, loops: Loops) -> Solved:
    """Return a motion without accelerations and loads."""
    rates = dict(symbols.rates)
    still = {j.name: ops.scalar(0.0) for j in symbols.joints}
    kinematics = loops.kinematics.with_rates(rates).with_accelerations(still)
    return Solved(kinematics, still, [], {}, rates, {}, ops.vector(*system.gravity))
