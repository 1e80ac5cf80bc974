"""How many constraints are entangled, and not one after the other as the loops of a chain."""

from __future__ import annotations

from collections.abc import Collection, Sequence


def most_entangled(structure: Sequence[set[int]], fixed: Collection[int]) -> int:
    """Return the largest number of constraints that no single coordinate links together.

    In the graph of constraints and coordinates it is that of the constraints in a biconnected
    component (Hopcroft, Tarjan (1973), Communications of the ACM 16): loops in a row, each of
    which shares one coordinate with the next, are components of their own; the meshes of a net
    are one.

    Parameters
    ----------
    structure
        Coordinates that each constraint depends on.
    fixed
        Coordinates that do not count, as driven ones.
    """
    links: dict[int, list[int]] = {}
    for row, columns in enumerate(structure):
        ends = [-1 - column for column in columns if column not in fixed]
        links[row] = ends
        for end in ends:
            links.setdefault(end, []).append(row)
    depth: dict[int, int] = {}
    low: dict[int, int] = {}
    return max((_from(root, links, depth, low) for root in links if root not in depth), default=0)


def _from(
    root: int, links: dict[int, list[int]], depth: dict[int, int], low: dict[int, int]
) -> int:
    """Return the most constraints in a component that is reached from a node.

    Constraints are numbered from zero, coordinates below it.
    """
    largest, edges = 0, list[tuple[int, int]]()
    depth[root] = low[root] = 0
    path = [(root, root, iter(links[root]))]
    while path:
        node, before, rest = path[-1]
        found = next(rest, None)
        if found is None:
            path.pop()
            if path:
                low[before] = min(low[before], low[node])
                if low[node] >= depth[before]:
                    largest = max(largest, _count(edges, (before, node)))
        elif found not in depth:
            depth[found] = low[found] = depth[node] + 1
            edges.append((node, found))
            path.append((found, node, iter(links[found])))
        elif found != before and depth[found] < depth[node]:
            edges.append((node, found))
            low[node] = min(low[node], depth[found])
    return largest


def _count(edges: list[tuple[int, int]], last: tuple[int, int]) -> int:
    """Take the edges of a component off the pile and return the number of its constraints."""
    nodes: set[int] = set()
    while True:
        edge = edges.pop()
        nodes.update(edge)
        if edge == last:
            return sum(node >= 0 for node in nodes)
