"""Order the rows of a linear program so that few values are needed at a time.

Rows are written when a result demands them, and all that can be written then follow at once: what
one part of a model has, such as a corner of a car, is made and used up before the next is begun.
"""

from __future__ import annotations

from collections.abc import Iterator

from vehicledyn.codegen.passes.vertex_elimination import LinearRows


def by_parts(rows: LinearRows) -> LinearRows:
    """Return the rows that results need, part by part."""
    count, n = len(rows.starts) - 1, rows.n_sources
    own = [rows.columns[rows.starts[k] : rows.starts[k + 1]] for k in range(count)]
    needed = [sorted({column - n for column in columns if column >= n}) for columns in own]
    users: list[list[int]] = [[] for _ in needed]
    for k, others in enumerate(needed):
        for other in others:
            users[other].append(k)
    missing = list(map(len, needed))
    place: dict[int, int] = {}

    def write(first: int) -> None:
        ready = [first]
        while ready:
            k = ready.pop()
            if k in place:
                continue
            place[k] = len(place)
            for user in reversed(users[k]):
                missing[user] -= 1
                if not missing[user]:
                    ready.append(user)

    for target in rows.targets:
        way: list[tuple[int, Iterator[int]]] = []
        if target >= n:
            way.append((target - n, iter(needed[target - n])))
        while way:
            row, before = way[-1]
            missed = next((item for item in before if item not in place), None)
            if missed is not None:
                way.append((missed, iter(needed[missed])))
                continue
            write(row)
            way.pop()
    return _ordered(rows, place)


def _ordered(rows: LinearRows, place: dict[int, int]) -> LinearRows:
    """Return rows in the order of their places."""
    n = rows.n_sources

    def renamed(column: int) -> int:
        return column if column < n else n + place[column - n]

    starts, columns, weights = [0], list[int](), []
    for k in place:
        own = slice(rows.starts[k], rows.starts[k + 1])
        columns += map(renamed, rows.columns[own])
        weights += rows.weights[own]
        starts.append(len(columns))
    return LinearRows(n, starts, columns, weights, list(map(renamed, rows.targets)))
