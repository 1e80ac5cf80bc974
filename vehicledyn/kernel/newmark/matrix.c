/* The iteration matrix of a lane: differences of the compiled rates by colours, and sparse factors.
   A lane is handled by itself, so that its numbers do not depend on its neighbours; those of one
   Jacobian are found side by side. */

static const double PART = 3e-8, WEAKEST = 1e-3;

#if VD_LANES == 1
static vd_mask evaluate(struct run *m, vd_mask wanted, real t, const real *x, real *z,
                        const real *constants, real *rates, long long *counts) {
  (void)wanted;
  if (m->solve(t, x, z, constants, counts, m->figures)) return 0;
  counts[EVALUATIONS]++;
  m->rates_at(t, x, z, constants, rates);
  return 1;
}
#else
static vd_mask evaluate(struct run *m, vd_mask wanted, real t, const real *x, real *z,
                        const real *constants, real *rates, long long *counts) {
  int status[VD_LANES], where[VD_LANES] = {0};
  double residual[VD_LANES] = {0.0};
  real solved = vd_all(0.0);
  (void)counts;
  for (int lane = 0; lane < VD_LANES; lane++) status[lane] = VD_HOLDS(wanted, lane) ? SOLVED : EVENT;
  m->lane_rates(&t, x, z, constants, rates, status, where, residual);
  for (int lane = 0; lane < VD_LANES; lane++) ((double *)&solved)[lane] = status[lane] == SOLVED;
  return vd_true(solved);
}
#endif

/* Give a number of each row of a lane to all lanes. */
static void spread_lane(long long n, int lane, const real *from, real *to) {
  for (long long i = 0; i < n; i++) to[i] = vd_all(((const double *)(from + i))[lane]);
}

/* Find the derivatives of the rates of a lane at its place, along closed loops; zero where rates are
   no finite numbers there. The first pass has the rates of the place itself in its first lane. */
static int find_jacobian(struct run *m, int lane) {
  const struct pattern *p = &m->pattern;
  const real *state = m->at.x, *constants = m->constants, now = vd_all(m->at.time[lane]);
  real *x = m->work, *z = x + m->n_states, *rates = z + m->n_unknowns;
  double *jacobian = m->jacobian + lane * p->n_entries;
  long long uncounted[5] = {0};
  if (VD_LANES > 1) {
    spread_lane(m->n_constants, lane, m->constants, m->given);
    constants = m->given;
  }
  for (long long first = -1; first < p->n_colours; first += VD_LANES) {
    spread_lane(m->n_states, lane, state, x);
    spread_lane(m->n_unknowns, lane, m->at.z, z);
    for (int own = first < 0; own < VD_LANES && first + own < p->n_colours; own++)
      for (int k = p->colour_starts[first + own]; k < p->colour_starts[first + own + 1]; k++) {
        double *moved = (double *)(x + p->colour_columns[k]) + own;
        *moved += PART * (1.0 + fabs(*moved));
      }
    const vd_mask solved = evaluate(m, vd_every(1), now, x, z, constants, rates, uncounted);
    if (first < 0) {
      if (!VD_HOLDS(solved, 0)) return 0;
      for (long long i = 0; i < m->n_rows; i++) m->base[i] = VD_LANE(rates[m->rows[i]], 0);
    }
    for (int own = first < 0; own < VD_LANES && first + own < p->n_colours; own++) {
      if (!VD_HOLDS(solved, own)) return 0;
      for (int k = p->colour_starts[first + own]; k < p->colour_starts[first + own + 1]; k++) {
        const int column = p->colour_columns[k];
        const double moved = VD_LANE(x[column], own) - VD_LANE(state[column], lane);
        for (int e = p->starts[column]; e < p->starts[column + 1]; e++) {
          const double rate = VD_LANE(rates[m->rows[p->rows[e]]], own);
          jacobian[e] = (rate - m->base[p->rows[e]]) / moved;
          if (!isfinite(jacobian[e])) return 0;
        }
      }
    }
  }
  m->matrix[lane].is_stale = 0;
  m->matrix[lane].has_jacobian = FRESH;
  m->matrix[lane].size = 0.0;
  m->matrix[lane].fewest = m->matrix[lane].wasted = 0;
  return 1;
}

/* The matrix of a step of size h, by columns in the order of elimination. */
static void assemble(struct run *m, int lane, double h) {
  const struct pattern *p = &m->pattern;
  const double *jacobian = m->jacobian + lane * p->n_entries, part = 1.0 - m->alpha_f;
  const double levers[] = {part * m->beta * h * h, part * h * m->second_order_gamma,
                           part * h * m->first_order_gamma};
  const long long n = m->n_rows;
  memset(m->dense, 0, n * n * sizeof(double));
  for (long long k = 0; k < n; k++) m->dense[k + k * n] = m->new_mass[p->order[k]];
  for (long long e = 0; e < p->n_entries; e++)
    m->dense[p->places[e]] -= levers[p->levers[e]] * jacobian[e];
}

static void keep_triangle(struct run *m, int lane, const struct triangle *t, real *values) {
  for (long long j = 0; j < m->n_rows; j++)
    for (int e = t->starts[j]; e < t->starts[j + 1]; e++)
      ((double *)(values + e))[lane] = m->dense[t->rows[e] + j * m->n_rows];
}

/* Factorise without exchanging rows; zero where a pivot is too small beside those below it. */
static int eliminate(struct run *m) {
  const struct pattern *p = &m->pattern;
  const long long n = m->n_rows;
  double *a = m->dense;
  for (long long j = 0; j < n; j++) {
    const int *below = p->below.rows + p->below.starts[j];
    const int count = p->below.starts[j + 1] - p->below.starts[j];
    double *own = a + j * n, largest = 0.0;
    for (int k = 0; k < count; k++) largest = fmax(largest, fabs(own[below[k]]));
    if (!(fabs(own[j]) >= WEAKEST * largest) || own[j] == 0.0) return 0;
    const double scale = 1.0 / own[j];
    for (int k = 0; k < count; k++) own[below[k]] *= scale;
    for (int i = 0; i < count; i++) {
      double *other = a + below[i] * n;
      const double top = other[j];
      if (top != 0.0)
        for (int k = 0; k < count; k++) other[below[k]] -= own[below[k]] * top;
    }
  }
  return 1;
}

/* Factorise with the largest pivot of each column; ``from`` are the rows in their order. */
static void eliminate_fully(struct run *m, int *from) {
  const long long n = m->n_rows;
  double *a = m->dense;
  for (long long j = 0; j < n; j++) {
    double *restrict own = a + j * n;
    long long pivot = j;
    for (long long i = j + 1; i < n; i++)
      if (fabs(own[i]) > fabs(own[pivot])) pivot = i;
    if (pivot != j) {
      const int held = from[j];
      from[j] = from[pivot], from[pivot] = held;
      for (long long k = 0; k < n; k++) {
        const double number = a[j + k * n];
        a[j + k * n] = a[pivot + k * n], a[pivot + k * n] = number;
      }
    }
    const double scale = 1.0 / own[j];
    for (long long i = j + 1; i < n; i++) own[i] *= scale;
    for (long long k = j + 1; k < n; k++) {
      double *restrict other = a + k * n;
      const double top = other[j];
      if (top != 0.0)
        for (long long i = j + 1; i < n; i++) other[i] -= own[i] * top;
    }
  }
}

/* Find factors where they are of another size of step; zero where a lane would need full ones. */
static int prepare_factors(struct run *m, int lane, double h) {
  struct matrix *own = m->matrix + lane;
  if (own->size != 0.0 && fabs(h - own->size) <= 1e-9 * own->size) return 1;
  assemble(m, lane, h);
  own->is_full = !eliminate(m);
  own->size = h;
  memcpy(m->from_rows, m->pattern.order, m->n_rows * sizeof(int));
  if (!own->is_full) {
    keep_triangle(m, lane, &m->pattern.below, m->lower);
    keep_triangle(m, lane, &m->pattern.above, m->upper);
  } else {
    if (VD_LANES > 1) return 0;
    assemble(m, lane, h);
    eliminate_fully(m, m->from_rows);
  }
  for (long long j = 0; j < m->n_rows; j++)
    ((double *)(m->inverse + j))[lane] = 1.0 / m->dense[j + j * m->n_rows];
  return 1;
}

/* y less a column of a triangle times a number. */
VD_INLINE void take_away(const struct triangle *t, long long j, const real *restrict values,
                         real own, real *restrict y) {
  const real *restrict value = values + t->starts[j];
  for (int run = t->run_starts[j]; run < t->run_starts[j + 1]; run++) {
    real *restrict to = y + t->run_firsts[run];
    const int count = t->run_counts[run];
    for (int k = 0; k < count; k++) to[k] = vd_fnma(value[k], own, to[k]);
    value += count;
  }
}

#if VD_LANES == 1
static void solve_fully(const struct run *m, double *restrict y) {
  const long long n = m->n_rows;
  for (long long j = 0; j < n; j++)
    for (long long i = j + 1; i < n; i++) y[i] -= m->dense[i + j * n] * y[j];
  for (long long j = n - 1; j >= 0; j--) {
    y[j] *= m->inverse[j];
    for (long long i = 0; i < j; i++) y[i] -= m->dense[i + j * n] * y[j];
  }
}
#endif

/* Solve with the factors; b holds the right side, then what is found. */
static void solve_factored(const struct run *m, real *restrict b, real *restrict y) {
  const struct pattern *p = &m->pattern;
  const long long n = m->n_rows;
  for (long long k = 0; k < n; k++) y[k] = b[m->from_rows[k]];
#if VD_LANES == 1
  if (m->matrix->is_full) {
    solve_fully(m, y);
    for (long long k = 0; k < n; k++) b[p->order[k]] = y[k];
    return;
  }
#endif
  for (long long j = 0; j < n; j++) take_away(&p->below, j, m->lower, y[j], y);
  for (long long j = n - 1; j >= 0; j--) {
    y[j] = y[j] * m->inverse[j];
    take_away(&p->above, j, m->upper, y[j], y);
  }
  for (long long k = 0; k < n; k++) b[p->order[k]] = y[k];
}
