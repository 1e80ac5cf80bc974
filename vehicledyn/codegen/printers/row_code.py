"""Print the Jacobian of the rows of a linear program as straight C.

The derivatives of each row by the sources that reach it are sums over the row's entries; most rows
are reached by few sources. Those that are wanted in one piece of the code only stay in registers.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from vehicledyn.codegen.passes.linear_program import LinearProgram

_PIECE = 100
"""Products a C function holds at most: what is kept between them stays near by."""


@dataclass
class _Value:
    """A derivative of a row: where it arises, and the last piece that reads it."""

    piece: int
    last: int = -1
    place: int = -1


@dataclass
class _Code:
    """Rows as they are printed: sums by (column, source), weights by number."""

    program: LinearProgram
    n_sources: int
    pieces: list[list[int]] = field(default_factory=list)
    reach: dict[int, list[int]] = field(default_factory=dict)
    values: dict[tuple[int, int], _Value] = field(default_factory=dict)

    def entries(self, k: int) -> list[tuple[int, int]]:
        """Return the entries (column, weight) of a row that sources reach."""
        p = self.program
        own = range(p.starts[k], p.starts[k + 1])
        found = [(int(p.columns[i]), int(p.which[i])) for i in own]
        return [item for item in found if item[0] in self.reach]


def print_jacobian(
    program: LinearProgram, n_sources: int, name: str
) -> tuple[str, list[tuple[int, int]]]:
    """Return C functions ``name(w, j)``, and which derivatives they write, in their order.

    These are pairs of a result and one of the first ``n_sources`` columns by which it is derived.
    """
    code = _Code(program, n_sources)
    code.reach.update({k: [k] for k in range(n_sources)})
    _cut(code, _needed(program))
    results = {int(column): k for k, column in enumerate(program.targets)}
    written: list[tuple[int, int]] = []
    firsts: list[tuple[int, int]] = []
    texts: list[str] = []
    free: list[int] = []
    size = 0
    ending: dict[int, list[int]] = {}
    for piece, rows in enumerate(code.pieces):
        lines = [f"static VD_APART void {name}_{piece}(const real *w, real *t, real *j) {{"]
        first = _middle([which for k in rows for _, which in code.entries(k)])
        firsts.append((first, len(written)))
        for k in rows:
            target, entries = int(program.out[k]), code.entries(k)
            used = [which - first for _, which in entries]
            lines += [f"  const real w{k}_{n} = w[{which}];" for n, which in enumerate(used)]
            for source in code.reach[target]:
                terms = [
                    (n, column)
                    for n, (column, _) in enumerate(entries)
                    if source in code.reach[column]
                ]
                lines.append(
                    f"  const real r{target}_{source} = {_sum(code, k, terms, source, piece)};"
                )
                value = code.values[target, source]
                if target in results:
                    place = len(written) - firsts[-1][1]
                    written.append((results[target], source))
                    lines.append(f"  j[{place}] = r{target}_{source};")
                if value.last > piece:
                    if not free:
                        free.append(size)
                        size += 1
                    value.place = free.pop()
                    ending.setdefault(value.last, []).append(value.place)
                    lines.append(f"  t[{value.place}] = r{target}_{source};")
        free += ending.pop(piece, [])
        texts.append("\n".join([*lines, "}"]))
    calls = "".join(
        f"\n  {name}_{piece}(w + {first}, t, j + {place});"
        for piece, (first, place) in enumerate(firsts)
    )
    texts.append(
        f"static void {name}(const real *w, real *j) {{\n  real t[{max(1, size)}];{calls}\n}}"
    )
    return "\n".join(texts), written


def _middle(places: list[int]) -> int:
    """Return a place from which most others are near, so that their addresses are short."""
    return sorted(places)[len(places) // 2] if places else 0


def _needed(program: LinearProgram) -> list[int]:
    """Return the rows that results need."""
    needed, rows = set(map(int, program.targets)), []
    for k in range(len(program.out) - 1, -1, -1):
        if int(program.out[k]) in needed:
            rows.append(k)
            needed.update(map(int, program.columns[program.starts[k] : program.starts[k + 1]]))
    return rows[::-1]


def _cut(code: _Code, rows: list[int]) -> None:
    """Find which sources reach each row, and cut the rows into pieces."""
    size = _PIECE
    for k in rows:
        entries = code.entries(k)
        sources = sorted({s for column, _ in entries for s in code.reach[column]})
        if not sources:
            continue
        if size >= _PIECE:
            code.pieces.append([])
            size = 0
        target, piece = int(code.program.out[k]), len(code.pieces) - 1
        code.pieces[-1].append(k)
        code.reach[target] = sources
        for column, _ in entries:
            for source in code.reach[column]:
                size += 1
                if column >= code.n_sources:
                    code.values[column, source].last = piece
        code.values.update({(target, source): _Value(piece) for source in sources})


def _sum(code: _Code, k: int, terms: list[tuple[int, int]], source: int, piece: int) -> str:
    """Return the derivative of a row by a source."""
    text = ""
    for n, column in sorted(terms, key=lambda item: item[1] >= code.n_sources):
        weight = f"w{k}_{n}"
        if column < code.n_sources:
            text = f"{text} + {weight}" if text else weight
            continue
        value = code.values[column, source]
        given = f"r{column}_{source}" if value.piece == piece else f"t[{value.place}]"
        text = f"vd_fma({weight}, {given}, {text})" if text else f"{weight} * {given}"
    return text
