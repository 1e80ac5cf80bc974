/* One step of Newmark's family, in all lanes that want it. */

enum { MOST_ITERATIONS = 20, MOST_TO_THE_END = 60 };

static const double CLOSE = 1e-13, COARSEST = 1e-6, SLOW = 0.3, ROUNDING = 1e-10,
                    SMALL_SHARE = 1e-3, ROOM = 0.08;

/* The state at the end of a step by Newmark's formulas. */
static void move(const struct run *m, real h, const real *old, const real *new, real *x) {
  const real *from = m->at.x;
  for (long long k = 0; k < m->n_rows; k++) {
    const double gamma = m->gamma[k];
    x[m->rows[k]] = from[m->rows[k]] + h * ((1.0 - gamma) * old[k] + gamma * new[k]);
  }
  for (long long k = 0; k < m->n_pairs; k++) {
    const int pair = m->pairs[k];
    const real bend = (0.5 - m->beta) * old[pair] + m->beta * new[pair];
    x[m->positions[k]] = from[m->positions[k]] + h * (from[m->velocities[k]] + h * bend);
  }
}

/* One number of each lane. */
static real abreast(const double *numbers) {
  real all = vd_all(0.0);
  memcpy(&all, numbers, sizeof(real));
  return all;
}

/* The size of a step of h in parts of that which led to a place, in each lane; zero at a start. */
static real size_ratio(const struct place *at, real h) {
  real ratio = vd_all(0.0);
  for (int lane = 0; lane < VD_LANES; lane++)
    if (at->size[lane] != 0.0) ((double *)&ratio)[lane] = VD_LANE(h, lane) / at->size[lane];
  return ratio;
}

/* The largest local error of a step to x about, in which auxiliary rates change so, for one plus the
   size of each state. */
static real local_error(const struct run *m, real h, const real *change, const real *x) {
  const double shift = m->alpha_m - m->alpha_f, gamma = m->second_order_gamma;
  const double missed = (1.0 - gamma) * shift * shift + gamma * (1.0 + shift) * (1.0 + shift);
  const real ratio = size_ratio(&m->at, h), zero = vd_all(0.0);
  const real by_rate = h * (0.5 - shift - gamma);
  const real by_bend = vd_select(vd_lt(zero, ratio), h * (1.0 / 6.0 - 0.5 * missed), zero);
  const real by_position = h * h * (1.0 / 6.0 - 0.5 * shift - m->beta);
  real largest = vd_all(0.0);
  for (long long k = 0; k < m->n_watched; k++) {
    const real bend = change[k] - ratio * m->at.change[k];
    const real error = vd_abs(by_rate * change[k] + by_bend * bend);
    largest = vd_larger(error / (1.0 + vd_abs(x[m->rows[k]])), largest);
  }
  for (long long k = 0; k < m->n_pairs; k++) {
    const real error = vd_abs(by_position * change[m->pairs[k]]);
    largest = vd_larger(error / (1.0 + vd_abs(x[m->positions[k]])), largest);
  }
  return largest;
}

static void mark_stale(struct run *m, vd_mask lanes) {
  for (int lane = 0; lane < VD_LANES; lane++)
    if (VD_HOLDS(lanes, lane)) m->matrix[lane].is_stale = 1;
}

/* A Jacobian that has cost more evaluations than a new one takes is found anew. */
static void count_waste(struct run *m, struct matrix *own, long long evaluations) {
  if (!own->fewest || evaluations < own->fewest) own->fewest = evaluations;
  own->wasted += evaluations - own->fewest;
  if (own->wasted > m->pattern.n_colours) own->is_stale = 1;
}

/* Iterate from auxiliary rates and unknowns that change as in the step before, in some lanes; the
   end is in m->found. Rates at the end are those that the step demands. Returns the lanes that
   converge, each until the error left is a small part of the step's own. */
static vd_mask iterate(struct run *m, real end, vd_mask open) {
  const long long n = m->n_rows;
  struct place *at = &m->at, *found = &m->found;
  real *old = m->work, *known = old + n, *residual = known + n, *buffer = residual + n;
  real *next = buffer + n, *x = next + m->n_states, *rates = x + m->n_states;
  real *z = rates + m->n_states, *new = z + m->n_unknowns, *held;
  const double part = 1.0 - m->alpha_f;
  const real h = end - abreast(at->time);
  const real further = size_ratio(at, h);
  const real ratio = vd_select(vd_lt(vd_all(0.0), further), further, vd_all(1.0));
  vd_mask taken = vd_every(0);
  for (long long k = 0; k < n; k++) {
    const real rate = at->rates[m->rows[k]];
    old[k] = rate + ratio * (at->auxiliary[k] - rate);
    known[k] = (1.0 - m->new_mass[k]) * old[k] - m->alpha_f * rate;
    new[k] = old[k] + further * at->change[k];
  }
  for (long long k = 0; k < m->n_unknowns; k++) z[k] = at->z[k] + further * at->drift[k];
  memcpy(x, at->x, m->n_states * sizeof(real));
  memcpy(next, at->x, m->n_states * sizeof(real));
  move(m, h, old, new, x);
  real before = vd_all(INFINITY);
  const int most = m->share < SMALL_SHARE ? MOST_TO_THE_END : MOST_ITERATIONS;
  for (int iteration = 0; iteration < most; iteration++) {
    open = vd_and(open, evaluate(m, open, end, x, z, m->constants, rates, m->counts));
    if (!vd_any(open)) break;
    for (long long k = 0; k < n; k++)
      residual[k] = m->new_mass[k] * new[k] + known[k] - part * rates[m->rows[k]];
    solve_factored(m, residual, buffer);
    for (long long k = 0; k < n; k++) new[k] = new[k] - residual[k];
    move(m, h, old, new, next);
    real size = vd_all(0.0), total = size;
    for (long long i = 0; i < m->n_states; i++) {
      const real moved = vd_abs(next[i] - x[i]) / (1.0 + vd_abs(x[i]));
      total += moved;
      size = vd_larger(moved, size);
    }
    open = vd_and(open, vd_finite(total));
    held = x, x = next, next = held;
    for (long long k = 0; k < n; k++) residual[k] = new[k] - old[k];
    const real contraction = size / before; /* None at first, since it was infinite before. */
    mark_stale(m, vd_and(open, vd_and(vd_lt(vd_all(SLOW), contraction),
                                      vd_lt(vd_all(ROUNDING), size))));
    const real left = size * contraction / vd_larger(1.0 - contraction, vd_all(1e-3));
    const real own = m->share * local_error(m, h, residual, x);
    const real allowed = vd_lesser(vd_larger(own, vd_all(CLOSE)), vd_all(COARSEST));
    vd_mask done = vd_eq(size, vd_all(0.0));
    if (iteration) done = vd_or(done, vd_lt(left, allowed));
    done = vd_or(done, vd_and(vd_lt(vd_all(0.5), contraction), vd_lt(size, vd_all(ROUNDING))));
    done = vd_and(done, open);
    if (vd_any(done)) {
      for (long long k = 0; k < n; k++) {
        real *rate = found->rates + m->rows[k];
        *rate = VD_TAKE(done, (m->new_mass[k] * new[k] + known[k]) / part, *rate);
        found->auxiliary[k] = VD_TAKE(done, new[k], found->auxiliary[k]);
        found->change[k] = VD_TAKE(done, residual[k], found->change[k]);
      }
      for (long long i = 0; i < m->n_states; i++) found->x[i] = VD_TAKE(done, x[i], found->x[i]);
      for (long long k = 0; k < m->n_unknowns; k++) {
        found->z[k] = VD_TAKE(done, z[k], found->z[k]);
        found->drift[k] = VD_TAKE(done, z[k] - at->z[k], found->drift[k]);
      }
      for (int lane = 0; lane < VD_LANES; lane++)
        if (VD_HOLDS(done, lane)) {
          found->time[lane] = VD_LANE(end, lane);
          found->size[lane] = VD_LANE(h, lane);
          count_waste(m, m->matrix + lane, iteration + 1);
        }
      taken = vd_or(taken, done);
    }
    open = vd_and(vd_and(open, vd_not(done)), vd_le(contraction, vd_all(0.9)));
    if (!vd_any(open)) break;
    before = size;
  }
  return taken;
}
