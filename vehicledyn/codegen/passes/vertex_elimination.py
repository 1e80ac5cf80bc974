"""Shorten the graph of a function's derivatives by eliminating nodes.

A node without which the graph has no more edges is taken out: the derivatives along the ways
through it are multiplied once, for all directions together. What is left is a sparse linear
program, row after row, that carries tangents forward and, transposed, adjoints back.

Griewank and Walther (2008), Evaluating Derivatives, chapter 9 (vertex elimination).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from vehicledyn.codegen.passes.local_slopes import SlopeGraph


@dataclass(frozen=True)
class LinearRows:
    """Rows that follow from each other: row k is Σ weight · (source or earlier row).

    ``starts`` (n_rows + 1,) part the ``columns`` and ``weights`` of the rows; columns count the
    sources first, then the rows. ``targets`` are the columns of the results.
    """

    n_sources: int
    starts: list[int]
    columns: list[int]
    weights: list[Any]
    targets: list[int]


def eliminated(graph: SlopeGraph, sources: Sequence[tuple[int, int]], slack: int = 0) -> LinearRows:
    """Return the rows that give the tangents of the graph's targets.

    Parameters
    ----------
    graph
        The derivatives of all operations; its edges are changed in place.
    sources
        Inputs (input, element) in the order in which their tangents are given.
    slack
        How many edges more a node may leave behind when it is taken out.
    """
    before = graph.before
    after = _successors(graph)
    fixed = {*graph.sources.values(), *graph.targets}
    _drop_dead(before, after, fixed)
    todo = [v for v in range(len(before)) if v not in fixed and before[v]]
    while todo:
        changed: set[int] = set()
        for v in todo:
            if before[v] and after[v] and _growth(v, before, after) <= slack:
                changed |= _take_out(v, before, after)
        todo = sorted(v for v in changed if v not in fixed and before[v])
    return _rows(graph, sources)


def _successors(graph: SlopeGraph) -> list[set[int]]:
    after: list[set[int]] = [set() for _ in graph.before]
    for node, edges in enumerate(graph.before):
        for item in edges:
            after[item].add(node)
    return after


def _drop_dead(before: list[dict[int, Any]], after: list[set[int]], fixed: set[int]) -> None:
    """Take out what no target needs."""
    for node in range(len(before) - 1, -1, -1):
        if not after[node] and node not in fixed:
            for item in before[node]:
                after[item].discard(node)
            before[node] = {}


def _growth(v: int, before: list[dict[int, Any]], after: list[set[int]]) -> int:
    """Return by how many the edges grow if a node is taken out."""
    own = before[v]
    new = sum(item not in before[w] for w in after[v] for item in own)
    return new - len(own) - len(after[v])


def _take_out(v: int, before: list[dict[int, Any]], after: list[set[int]]) -> set[int]:
    """Take a node out; return its neighbours."""
    neighbours = {*before[v], *after[v]}
    for w in after[v]:
        edges = before[w]
        outer = edges.pop(v)
        for item, inner in before[v].items():
            product = _product(outer, inner)
            edges[item] = edges[item] + product if item in edges else product
            after[item].add(w)
    for item in before[v]:
        after[item].discard(v)
    before[v] = {}
    after[v] = set()
    return neighbours


def _product(outer: Any, inner: Any) -> Any:
    """Return a product; signs and ones cost nothing."""
    if outer.is_one():
        return inner
    if inner.is_one():
        return outer
    if outer.is_minus_one() or inner.is_minus_one():
        return -(inner if outer.is_minus_one() else outer)
    return outer * inner


def _rows(graph: SlopeGraph, sources: Sequence[tuple[int, int]]) -> LinearRows:
    place = {graph.sources[item]: k for k, item in enumerate(sources) if item in graph.sources}
    starts, columns, weights = [0], [], []
    ends = set(graph.targets)
    for node, edges in enumerate(graph.before):
        if not edges and node not in ends:
            continue
        place[node] = len(sources) + len(starts) - 1
        for item, weight in edges.items():
            columns.append(place[item])
            weights.append(weight)
        starts.append(len(columns))
    return LinearRows(len(sources), starts, columns, weights, [place[k] for k in graph.targets])
