/* Steps of Newmark's family on residuals with multipliers; constrained_steps.py holds the same
   algorithm, change both together. Rows are velocities, then further states. Factors of the matrix
   come from Python: L and U by columns, the diagonal of L, which is one, first in each and that of U
   last. */
enum { MOST_CONSTRAINED = 12 };

static const double CLOSE_STATES = 1e-14, LEVER = 1e-2, SLOW_CONSTRAINED = 0.3;
static const double SAME = 1e-9, ROUNDING_STATES = 1e-8, COARSE = 1e-3;

/* Solve with the factors; b holds the right side, then what is found. */
static void solve_sparse(const struct constrained *c, long long size, double *b, double *y) {
  for (long long i = 0; i < size; i++) y[c->row_place[i]] = b[i];
  for (long long j = 0; j < size; j++) {
    const double own = y[j];
    if (own != 0.0)
      for (int k = c->l_starts[j] + 1; k < c->l_starts[j + 1]; k++)
        y[c->l_rows[k]] -= c->l_values[k] * own;
  }
  for (long long j = size - 1; j >= 0; j--) {
    const int last = c->u_starts[j + 1] - 1;
    const double own = y[j] /= c->u_values[last];
    if (own != 0.0)
      for (int k = c->u_starts[j]; k < last; k++) y[c->u_rows[k]] -= c->u_values[k] * own;
  }
  for (long long i = 0; i < size; i++) b[i] = y[c->column_place[i]];
}

/* Time, coordinates, speeds, accelerations, multipliers and further states of the place m->at. */
static void place_at(const struct run *m, double *point) {
  const struct constrained *c = &m->constrained;
  const struct place *at = &m->at;
  const long long n = m->n_pairs;
  double *q = point + 1, *v = q + n, *lift = v + n, *forces = lift + n;
  double *other = forces + c->n_multipliers;
  point[0] = at->time[0];
  for (long long i = 0; i < n; i++) {
    q[i] = at->x[m->positions[i]];
    v[i] = at->x[m->velocities[i]];
    lift[i] = at->rates[i];
  }
  memcpy(forces, at->forces, c->n_multipliers * sizeof(double));
  for (long long i = 0; i < c->n_others; i++) other[i] = at->x[m->rows[n + i]];
}

/* What is known of a step, and its unknowns. */
struct trial {
  double h, *position, *velocity, *acceleration, *other, *lag, *a, *r, *multiplier, *eta;
};

/* How fast a coordinate is corrected by η, with the mean arms of both ends of the step. */
static double pushed(const struct run *m, long long i, const double *eta) {
  const struct constrained *c = &m->constrained;
  const double *begin = c->arms, *now = begin + c->arm_starts[m->n_pairs];
  double moved = 0.0;
  for (int k = c->arm_starts[i]; k < c->arm_starts[i + 1]; k++)
    moved += (begin[k] + now[k]) * eta[c->arm_columns[k]];
  return 0.5 * c->lightness[i] * moved;
}

/* The same of the end of a step. */
static void place_point(const struct run *m, const struct trial *s, double end, double *point) {
  const struct constrained *c = &m->constrained;
  const long long n = m->n_pairs;
  const double h = s->h, by_a = (1.0 - m->alpha_m) / (1.0 - m->alpha_f);
  double *q = point + 1, *v = q + n, *lift = v + n, *forces = lift + n;
  double *other = forces + c->n_multipliers;
  point[0] = end;
  for (long long i = 0; i < n; i++) {
    q[i] = s->position[i] + h * h * m->beta * s->a[i];
    v[i] = s->velocity[i] + h * m->second_order_gamma * s->a[i];
    lift[i] = s->acceleration[i] + by_a * s->a[i];
  }
  if (c->is_stabilised)
    for (long long i = 0; i < n; i++) q[i] -= h * pushed(m, i, s->eta);
  memcpy(forces, s->multiplier, c->n_multipliers * sizeof(double));
  for (long long i = 0; i < c->n_others; i++)
    other[i] = s->other[i] + h * c->first_order_gamma * s->r[i];
}

/* Write the arms of the begin of a step. */
static void begin_arms(struct run *m, double *point) {
  const struct constrained *c = &m->constrained;
  const int count = c->arm_starts[m->n_pairs];
  place_at(m, point);
  c->spread(1, point, c->given, c->arms, 0);
  memcpy(c->arms + count, c->arms, count * sizeof(double));
}

/* Whether a step begins with other velocities than the last, of another size, ended with. */
static int is_resized(const struct run *m, double h) {
  const double size = m->at.size[0];
  const int may_be = !m->constrained.is_stabilised && m->constrained.n_multipliers;
  return may_be && size != 0.0 && fabs(h - size) > SAME * size;
}

/* Begin from the place m->at; a is guessed to change as it did in the step before. */
static void begin_trial(struct run *m, double end, struct trial *s, double *old) {
  const struct constrained *c = &m->constrained;
  const struct place *at = &m->at;
  const long long n = m->n_pairs, k = c->n_others;
  const double h = s->h = end - at->time[0], mass = c->first_order_mass;
  const double shift = m->alpha_m - m->alpha_f;
  const double ratio = at->size[0] != 0.0 ? h / at->size[0] : 0.0;
  const int is_carried = at->size[0] != 0.0 && h != at->size[0];
  for (long long i = 0; i < n + k; i++) {
    const double rate = at->rates[i];
    old[i] = is_carried ? rate + ratio * (at->auxiliary[i] - rate) : at->auxiliary[i];
  }
  const double missed = is_resized(m, h) ? 1.0 - ratio * ratio : 0.0;
  for (long long i = 0; i < n; i++) {
    const double q = at->x[m->positions[i]];
    double v = at->x[m->velocities[i]];
    if (at->size[0] == 0.0) {
      old[i] += h * shift * at->change[i];
      if (!c->is_stabilised) v += h * h * (1.0 / 6.0 - 0.5 * shift - m->beta) * at->change[i];
    }
    if (missed != 0.0) v += missed * c->back[i];
    s->position[i] = q + h * (v + h * (0.5 - m->beta) * old[i]);
    s->velocity[i] = v + h * (1.0 - m->second_order_gamma) * old[i];
    s->acceleration[i] = (m->alpha_m * old[i] - m->alpha_f * at->rates[i]) / (1.0 - m->alpha_f);
    s->a[i] = old[i] + ratio * at->change[i];
  }
  for (long long i = 0; i < k; i++) {
    s->r[i] = old[n + i];
    s->other[i] = at->x[m->rows[n + i]] + h * (1.0 - c->first_order_gamma) * s->r[i];
    s->lag[i] = (1.0 - mass) * s->r[i] - m->alpha_f * at->rates[n + i];
  }
  memcpy(s->multiplier, at->forces, 2 * c->n_multipliers * sizeof(double));
}

/* Take over what was found. */
static int accept_trial(struct run *m, const struct trial *s, double end, const double *point,
                        const double *old) {
  const struct constrained *c = &m->constrained;
  struct place *found = &m->found;
  const long long n = m->n_pairs;
  const double *other = point + 1 + 3 * n + c->n_multipliers;
  memcpy(found->x, m->at.x, m->n_states * sizeof(double));
  memcpy(found->z, m->at.z, m->n_unknowns * sizeof(double));
  for (long long i = 0; i < n; i++) {
    found->x[m->positions[i]] = point[1 + i];
    found->x[m->velocities[i]] = point[1 + n + i];
    found->rates[i] = point[1 + 2 * n + i];
    found->change[i] = s->a[i] - old[i];
  }
  for (long long i = 0; i < c->n_others; i++) {
    found->x[m->rows[n + i]] = other[i];
    found->rates[n + i] = (c->first_order_mass * s->r[i] + s->lag[i]) / (1.0 - m->alpha_f);
    found->change[n + i] = 0.0;
  }
  found->time[0] = end, found->size[0] = s->h;
  return TAKEN;
}

/* Sizes of a change of the unknowns: of the states, and of the multipliers. */
static void sizes_of(const struct run *m, const struct trial *s, const double *point,
                     const double *change, double *moved, double *forced) {
  const struct constrained *c = &m->constrained;
  const long long n = m->n_pairs, k = c->n_others;
  const double *other = point + 1 + 3 * n + c->n_multipliers;
  const double h = s->h, by_position = h * h * m->beta, by_velocity = h * m->second_order_gamma;
  double largest = 0.0, turned = 0.0;
  *moved = 0.0;
  for (long long i = 0; i < n; i++) {
    const double size = fabs(change[i]);
    double shift = by_position * size;
    if (c->is_stabilised)
      shift += h * c->lever * fabs(pushed(m, i, change + n + k + c->n_multipliers));
    *moved = fmax(*moved, shift / (1.0 + fabs(point[1 + i])));
    *moved = fmax(*moved, by_velocity * size / (1.0 + fabs(point[1 + n + i])));
  }
  for (long long i = 0; i < k; i++) {
    const double size = h * c->first_order_gamma * fabs(change[n + i]);
    *moved = fmax(*moved, size / (1.0 + fabs(other[i])));
  }
  for (long long i = 0; i < c->n_multipliers; i++) {
    largest = fmax(largest, fabs(point[1 + 3 * n + i]));
    turned = fmax(turned, fabs(change[n + k + i]) * c->scale * c->lead);
  }
  *forced = turned / (1.0 + largest);
}

/* What Newton's method may leave where no multipliers need their digits: a part of the local error
   of positions, for one plus their size. */
static double allowed_error(const struct run *m, const struct trial *s, const double *old,
                            const double *point) {
  const double shift = m->alpha_m - m->alpha_f;
  const double by_position = s->h * s->h * (1.0 / 6.0 - 0.5 * shift - m->beta);
  double largest = 0.0;
  for (long long i = 0; i < m->n_pairs; i++)
    largest = fmax(largest, fabs(by_position * (s->a[i] - old[i])) / (1.0 + fabs(point[1 + i])));
  return fmin(fmax(m->share * largest, CLOSE_STATES), COARSEST);
}

static int iterate_constrained(struct run *m, double end, int is_fresh) {
  const struct constrained *c = &m->constrained;
  const long long n = m->n_pairs, k = c->n_others, count = c->n_multipliers;
  const long long n_gaps = c->is_stabilised ? 2 * count : count, size = n + k + n_gaps;
  struct trial s;
  double *old = m->work, *right = old + n + k, *buffer = right + size, *values = buffer + size;
  double *point = values + n + 2 * count + k;
  s.position = point + 1 + 3 * n + count + k;
  s.velocity = s.position + n, s.acceleration = s.velocity + n;
  s.other = s.acceleration + n, s.lag = s.other + k;
  s.a = m->found.auxiliary, s.r = s.a + n;
  s.multiplier = m->found.forces, s.eta = s.multiplier + count;
  if (c->is_stabilised) begin_arms(m, point);
  begin_trial(m, end, &s, old);
  const double h = s.h;
  const double by_gap = c->scale / (m->beta * h * h);
  const double by_opening = c->scale / (m->second_order_gamma * h);
  const double rounding = CLOSE_STATES * (1.0 + m->second_order_gamma / (m->beta * h));
  double before = INFINITY;
  for (int iteration = 0; iteration < MOST_CONSTRAINED; iteration++) {
    place_point(m, &s, end, point);
    if (c->is_stabilised) {
      c->spread(1, point, c->given, c->arms + c->arm_starts[n], 0);
      place_point(m, &s, end, point);
    }
    c->residual(1, point, c->given, values, 0);
    m->counts[EVALUATIONS]++;
    double total = 0.0;
    for (long long i = 0; i < n + 2 * count + k; i++) total += values[i] - values[i];
    if (total != 0.0) return REFUSED; /* a residual is not a finite number */
    m->counts[ITERATIONS]++;
    const double *gap = values + n, *opening = gap + count, *other_rate = opening + count;
    for (long long i = 0; i < n; i++) right[i] = values[i] / c->lead;
    for (long long i = 0; i < k; i++)
      right[n + i] = c->first_order_mass * s.r[i] + s.lag[i] - (1.0 - m->alpha_f) * other_rate[i];
    for (long long i = 0; i < count; i++) right[n + k + i] = gap[i] * by_gap;
    if (c->is_stabilised)
      for (long long i = 0; i < count; i++) right[n + k + count + i] = opening[i] * by_opening;
    solve_sparse(c, size, right, buffer);
    total = 0.0;
    for (long long i = 0; i < n; i++) total += right[i] - right[i];
    if (total != 0.0) return REFUSED;
    for (long long i = 0; i < n; i++) s.a[i] -= right[i];
    for (long long i = 0; i < k; i++) s.r[i] -= right[n + i];
    for (long long i = 0; i < count; i++) s.multiplier[i] -= right[n + k + i] * c->scale * c->lead;
    if (c->is_stabilised)
      for (long long i = 0; i < count; i++) s.eta[i] -= right[n + k + count + i] * c->lever;
    double moved, forced;
    sizes_of(m, &s, point, right, &moved, &forced);
    const double change = fmax(moved, LEVER * forced);
    const int is_rounding = moved < ROUNDING_STATES && forced < COARSE;
    const double contraction = iteration ? change / before : 0.0;
    if (contraction > SLOW_CONSTRAINED && !is_rounding) m->matrix->is_stale = 1;
    const double left = contraction / fmax(1.0 - contraction, 1e-3);
    const double allowed = count ? c->close_states : allowed_error(m, &s, old, point);
    const int settled = iteration && moved * left < allowed && forced * left < c->close_forces;
    const int stays = contraction > 0.5 && is_rounding;
    if (stays && !is_fresh && moved > rounding) return REFUSED;
    if (settled || stays || change == 0.0) {
      place_point(m, &s, end, point);
      return accept_trial(m, &s, end, point, old);
    }
    if (contraction > 0.9 && iteration > 1) return REFUSED;
    before = change;
  }
  return REFUSED;
}

/* Take a step from m->at to m->found; Python finds Jacobian and factors for steps to m->wanted. */
static int constrained_step(struct run *m, double end) {
  const double h = end - m->at.time[0];
  const int fits = m->matrix->size != 0.0 && fabs(h - m->matrix->size) <= SAME * m->matrix->size;
  const int lacks_back = is_resized(m, h) && m->constrained.back_from != m->at.time[0];
  m->wanted = end;
  if (m->matrix->is_stale || !m->matrix->has_jacobian || !fits || lacks_back) return NEEDS_JACOBIAN;
  const int is_new = m->matrix->has_jacobian == FRESH;
  m->matrix->has_jacobian = KEPT;
  if (iterate_constrained(m, end, is_new) == TAKEN) return TAKEN;
  if (is_new) return REFUSED;
  m->matrix->is_stale = 1;
  return NEEDS_JACOBIAN;
}

/* Write the channels of the place m->at as the steps have it. */
static void show_place(struct run *m, double *values) {
  place_at(m, m->work);
  m->constrained.output(1, m->work, m->constrained.given, values, 0);
}
