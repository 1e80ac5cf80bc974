"""Entangled constraints: loops of a chain are apart, meshes of a net are not."""

from vehicledyn.multibody.loops.coupling import most_entangled


def test_loops_in_a_row_are_not_entangled():
    """Each loop of two rows shares one coordinate with the next."""
    rows = [{2 * k, 2 * k + 1, 2 * k + 2} for k in range(20) for _ in range(2)]
    assert most_entangled(rows, ()) == 2


def test_a_ring_of_rows_is_entangled():
    rows = [{k, (k + 1) % 12} for k in range(12)]
    assert most_entangled(rows, ()) == 12


def test_fixed_coordinates_part_a_ring():
    rows = [{k, (k + 1) % 12} for k in range(12)]
    assert most_entangled(rows, {0}) == 1


def test_nothing_is_entangled_where_there_is_nothing():
    assert most_entangled([], ()) == 0
    assert most_entangled([set()], ()) == 0
