"""IPOPT, which ships with CasADi, for programs that are computed outside of CasADi.

Source: Wächter, Biegler (2006), Mathematical Programming 106, 25-57.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.interrupts import Interrupts, undisturbed

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_PIVOTS = 1e-2
"""Least pivots of the linear solver over the largest element of their column.

Smaller ones, which are usual, miscount the signs of stiff models' eigenvalues: the search stops.
"""

_OPTIONS: dict[str, Any] = {
    "ipopt.print_level": 0,
    "print_time": False,
    "show_eval_warnings": False,
    "ipopt.sb": "yes",
    "ipopt.linear_solver": "mumps",
    "ipopt.mumps_pivtol": _PIVOTS,
    "error_on_fail": False,
    "no_nlp_grad": True,
    "iteration_callback_ignore_errors": False,
}


@dataclass(frozen=True)
class Pattern:
    """Places of the entries of a sparse matrix, by compressed columns."""

    rows: Indices
    starts: Indices


@dataclass(frozen=True)
class NonlinearProgram:
    """f(x) to be least where x and g(x) keep their bounds, with n variables and m constraints.

    ``bounds`` and ``limits`` are pairs of lower and upper ones, (n,) and (m,). ``values`` returns f
    and g (m,), ``slopes`` the gradient (n,) and the entries of ∂g/∂x in ``pattern``. ``hessian``
    returns those of λ_f ∂²f/∂x² + λ_g . ∂²g/∂x² in ``bends``, an upper triangle, at x, λ_f and
    λ_g (m,); without it second derivatives are limited-memory estimates. What they raise ends the
    search and is raised again.
    """

    bounds: tuple[Floats, Floats]
    limits: tuple[Floats, Floats]
    values: Callable[[Floats], tuple[float, Floats]]
    slopes: Callable[[Floats], tuple[Floats, Floats]]
    pattern: Pattern
    hessian: Callable[[Floats, float, Floats], Floats] | None = None
    bends: Pattern | None = None

    def gap(self, x: Floats, constraints: Floats, multipliers: tuple[Floats, Floats]) -> float:
        """Return by how much bounds that do not act yet keep the objective from its least.

        To first order: the products of multipliers, those of the variables (n,) and of the
        constraints (m,), and distances to the bounds.
        """
        total = 0.0
        pairs = (x, self.bounds, multipliers[0]), (constraints, self.limits, multipliers[1])
        for values, (low, high), multiplier in pairs:
            distance = np.where(multiplier > 0.0, high - values, values - low)
            acts = np.isfinite(distance) & (high > low)
            total += float(np.abs(multiplier[acts]) @ np.maximum(distance[acts], 0.0))
        return total

    @property
    def n_gaps(self) -> int:
        """Number of bounds."""
        pairs = self.bounds, self.limits
        return sum(int((np.isfinite(end) & (p[0] < p[1])).sum()) for p in pairs for end in p)

    def violation(self, constraints: Floats) -> float:
        """Return the largest violation of a constraint."""
        low, high = self.limits
        missed = np.maximum(low - constraints, constraints - high)
        return float(missed.max(initial=0.0))


@dataclass(frozen=True)
class SearchEnd:
    """Where a search ended: variables, objective, constraints, IPOPT's words and iterations."""

    variables: Floats
    objective: float
    constraints: Floats
    status: str
    is_optimal: bool
    iterations: int


Seen = Callable[[int, Floats, float, Floats, float], object]
"""Called after each iteration with its number, variables, objective, constraints and gap."""


def minimise(
    program: NonlinearProgram, start: Floats, options: dict[str, Any], seen: Seen | None = None
) -> SearchEnd:
    """Search the least of a program.

    Parameters
    ----------
    program
        What to minimise.
    start
        Where to begin, shape (n,).
    options
        Of IPOPT, without its name before them.
    seen
        Called after each iteration; what it raises ends the search and is raised again.
    """
    import casadi

    guard = _Guard()
    functions = _functions(program, guard)
    own = {f"ipopt.{name}": value for name, value in options.items()}
    if "hess_lag" not in functions:
        own["ipopt.hessian_approximation"] = "limited-memory"
    observer = _observer(program, guard, seen)
    nlp = functions.pop("nlp")
    settings = _OPTIONS | own | functions | {"iteration_callback": observer}
    (low, high), (least, most) = program.bounds, program.limits
    with undisturbed() as guard.interrupts:  # CasADi takes Ctrl-C for a search that failed
        solver = casadi.nlpsol("optimum", "ipopt", nlp, settings)
        found = solver(x0=start, lbx=low, ubx=high, lbg=least, ubg=most)
    if guard.interrupts.is_pressed:
        raise KeyboardInterrupt
    if guard.error is not None:
        raise guard.error
    stats = solver.stats()
    return SearchEnd(
        np.array(found["x"]).ravel(),
        float(found["f"]),
        np.array(found["g"]).ravel(),
        str(stats["return_status"]),
        bool(stats["success"]),
        int(stats["iter_count"]),
    )


@dataclass
class _Guard:
    """Keeps what an evaluation raised, which must not cross C++ code; from then on none is made.

    Nor after Ctrl-C. The last evaluation of each kind is kept as well, as several functions ask for
    the same.
    """

    error: BaseException | None = None
    interrupts: Interrupts = field(default_factory=Interrupts)
    _known: dict[int, tuple[bytes, Any]] = field(default_factory=dict)

    @property
    def stops(self) -> bool:
        """Whether the search must end."""
        return self.error is not None or self.interrupts.is_pressed

    def call(self, evaluate: Any, x: Floats, empty: Any, *more: Any) -> Any:
        """Return an evaluation at x, ``empty`` where one has failed."""
        key, kind = x.tobytes(), id(evaluate)
        known = self._known.get(kind)
        if known is not None and known[0] == key and not more:
            return known[1]
        if not self.stops:
            try:
                with self.interrupts.let_through():
                    found = evaluate(x, *more)
            except BaseException as error:
                self.error = error
            else:
                self._known[kind] = key, found
                return found
        return empty


def _functions(program: NonlinearProgram, guard: _Guard) -> dict[str, Any]:
    """Return the functions of variables x, no parameters p, and multipliers, by their options."""
    import casadi

    p, dense = program, casadi.Sparsity.dense
    n, m = p.bounds[0].size, p.limits[0].size
    slopes_in = casadi.Sparsity(m, n, p.pattern.starts.tolist(), p.pattern.rows.tolist())
    values, slopes = p.values, p.slopes
    none = np.full(n, np.nan), np.full(p.pattern.rows.size, np.nan)
    given = {"x": dense(n, 1), "p": dense(0, 1)}
    f, g = {"f": dense(1, 1)}, {"g": dense(m, 1)}

    def at(x: Floats) -> tuple[Floats, Floats]:
        found, constraints = guard.call(values, x, (np.nan, np.full(m, np.nan)))
        return np.array([found]), constraints

    def slopes_at(x: Floats) -> tuple[Floats, Floats]:
        gradient, entries = guard.call(slopes, x, none)
        return gradient, entries

    found = {
        "nlp": _callback("nlp", given, f | g, lambda x, _: at(x)),
        "grad_f": _callback(
            "nlp_grad_f",
            given,
            f | {"grad_f_x": dense(n, 1)},
            lambda x, _: (at(x)[0], slopes_at(x)[0]),
        ),
        "jac_g": _callback(
            "nlp_jac_g", given, g | {"jac_g_x": slopes_in}, lambda x, _: (at(x)[1], slopes_at(x)[1])
        ),
    }
    hessian, bends = p.hessian, p.bends
    if hessian is not None and bends is not None:
        pattern = casadi.Sparsity(n, n, bends.starts.tolist(), bends.rows.tolist())
        no_bends = np.full(bends.rows.size, np.nan)
        multipliers = {"lam_f": f["f"], "lam_g": g["g"]}
        found["hess_lag"] = _callback(
            "nlp_hess_l",
            given | multipliers,
            {"triu_hess_gamma_x_x": pattern},
            lambda x, _, of, og: [guard.call(hessian, x, no_bends, float(of[0]), og)],
        )
    return found


def _observer(program: NonlinearProgram, guard: _Guard, seen: Seen | None) -> Any:
    """Return what IPOPT calls after each iteration."""
    import casadi

    n, m = program.bounds[0].size, program.limits[0].size
    sizes = {"f": 1, "x": n, "lam_x": n, "g": m, "lam_g": m}
    names = casadi.nlpsol_out()
    count = iter(range(10**9))

    def observe(*given: Floats) -> list[Floats]:
        if seen is not None and not guard.stops:
            at = dict(zip(names, given, strict=True))
            try:
                gap = program.gap(at["x"], at["g"], (at["lam_x"], at["lam_g"]))
                seen(next(count), at["x"], float(at["f"][0]), at["g"], gap)
            except (Exception, KeyboardInterrupt) as error:  # crosses C++ code
                guard.error = error
        return [np.array([float(guard.stops)])]

    dense = casadi.Sparsity.dense
    inputs = {name: dense(sizes.get(name, 0), 1) for name in names}
    return _callback("observer", inputs, {"stops": dense(1, 1)}, observe)


def _callback(
    name: str,
    inputs: dict[str, Any],
    outputs: dict[str, Any],
    evaluate: Callable[..., Sequence[Floats]],
) -> Any:
    """Return a CasADi function that calls one of Python with the numbers of its inputs.

    ``inputs`` and ``outputs`` are patterns by name.
    """
    import casadi

    names_in, names_out = list(inputs), list(outputs)
    patterns_in, patterns_out = list(inputs.values()), list(outputs.values())

    class Evaluation(casadi.Callback):
        """Call the function."""

        def __init__(self) -> None:
            casadi.Callback.__init__(self)
            self.construct(name, {})

        def get_n_in(self) -> int:
            return len(names_in)

        def get_n_out(self) -> int:
            return len(names_out)

        def get_name_in(self, index: int) -> str:
            return names_in[index]

        def get_name_out(self, index: int) -> str:
            return names_out[index]

        def get_sparsity_in(self, index: int) -> Any:
            return patterns_in[index]

        def get_sparsity_out(self, index: int) -> Any:
            return patterns_out[index]

        def eval(self, given: Any) -> list[Any]:
            found = evaluate(*[np.array(item.nonzeros()) for item in given])
            return [casadi.DM(s, v) for s, v in zip(patterns_out, found, strict=True)]

    return Evaluation()
