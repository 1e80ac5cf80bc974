"""Which pieces of a function its results need, so that those of others can be left out."""

from __future__ import annotations

from vehicledyn.codegen.passes.scheduling import Step, operands_of
from vehicledyn.codegen.printers.function_body import FunctionBody
from vehicledyn.codegen.printers.function_splitting import Places

MOST_PIECES = 64
"""Pieces that the bits of a number can name."""


def pieces_needed(body: FunctionBody, pieces: list[list[Step]], places: Places) -> list[int]:
    """Return for each element of the first result the pieces that it needs, as bits.

    A piece is computed whole, so it needs all pieces that it reads from. Elements that are inputs
    or constants need none.

    Parameters
    ----------
    body
        A function without calls in loops.
    pieces
        Its steps by piece, at most ``MOST_PIECES``.
    places
        In which piece each value arises.
    """
    needed: list[int] = []
    for number, steps in enumerate(pieces):
        bits = 1 << number
        for step in steps:
            for value in operands_of(body.values, step):
                source = places.piece_of.get(value, number)
                if source != number:
                    bits |= needed[source]
        needed.append(bits)
    first = {element: value for output, element, value in body.lowered.results if output == 0}
    return [
        needed[places.piece_of[value]] if value in places.piece_of else 0
        for _, value in sorted(first.items())
    ]
