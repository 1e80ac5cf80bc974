/* Cases side by side, whose whole steps end together; each lane halves its own where Newton's method
   or the error asks for it. A lane in which an event fires, or that needs full factors or other
   derivatives, stops with EVENT: it is run by itself. */

static vd_mask going(const struct run *m) {
  real open = vd_all(0.0);
  for (int lane = 0; lane < VD_LANES; lane++)
    ((double *)&open)[lane] = m->lane_status[lane] == SOLVED;
  return vd_true(open);
}

static void leave(struct run *m, int lane) {
  m->lane_status[lane] = EVENT;
  m->lane_where[lane] = 0;
  m->lane_residual[lane] = 0.0;
}

/* Try a step of some lanes to m->found, each to an end of its own; return those that take it. A lane
   that has failed with an old Jacobian tries again with a new one. */
static vd_mask try_step(struct run *m, real end, vd_mask wanted) {
  vd_mask taken = vd_every(0);
  for (int attempt = 0; attempt < 2 && vd_any(wanted); attempt++) {
    vd_mask again = vd_every(0);
    real is_old = vd_all(0.0);
    for (int lane = 0; lane < VD_LANES; lane++) {
      struct matrix *own = m->matrix + lane;
      if (!VD_HOLDS(wanted, lane)) continue;
      if ((own->is_stale || !own->has_jacobian) && !find_jacobian(m, lane)) {
        leave(m, lane);
        continue;
      }
      ((double *)&is_old)[lane] = own->has_jacobian != FRESH;
      own->has_jacobian = KEPT;
      if (!prepare_factors(m, lane, VD_LANE(end, lane) - m->at.time[lane])) leave(m, lane);
    }
    wanted = vd_and(wanted, going(m));
    taken = vd_or(taken, iterate(m, end, wanted));
    again = vd_and(vd_and(wanted, vd_not(taken)), vd_true(is_old));
    mark_stale(m, again);
    wanted = again;
  }
  return taken;
}

static void take_over(long long n, vd_mask lanes, const real *from, real *to) {
  for (long long k = 0; k < n; k++) to[k] = vd_select(lanes, from[k], to[k]);
}

static void go_on(struct run *m, vd_mask lanes) {
  struct place *at = &m->at;
  const struct place *found = &m->found;
  take_over(m->n_states, lanes, found->x, at->x);
  take_over(m->n_unknowns, lanes, found->z, at->z);
  take_over(m->n_states, lanes, found->rates, at->rates);
  take_over(m->n_rows, lanes, found->auxiliary, at->auxiliary);
  take_over(m->n_rows, lanes, found->change, at->change);
  take_over(m->n_unknowns, lanes, found->drift, at->drift);
  for (int lane = 0; lane < VD_LANES; lane++)
    if (VD_HOLDS(lanes, lane))
      at->time[lane] = found->time[lane], at->size[lane] = found->size[lane];
}

/* Watch the events of a lane at the end of a part of a step. */
static void watch_lane(struct run *m, int lane, double end) {
  int status[VD_LANES];
  long long uncounted[VD_LANES] = {0};
  for (int k = 0; k < VD_LANES; k++) status[k] = k == lane ? SOLVED : EVENT;
  m->lane_sample(end, 0, end, m->at.x, m->at.z, m->constants, 0.0, 0, m->channels, m->lane_samples,
                 0, m->watched, uncounted, status, m->lane_where, m->lane_residual);
  if (status[lane] != SOLVED) leave(m, lane);
}

/* Where the next part of a whole step of a lane ends. */
static double end_of_part(const struct run *m, int lane) {
  const double part = m->whole * pow(0.5, (double)m->matrix[lane].halvings);
  const double at = m->at.time[lane], remaining = m->end - at;
  return part >= remaining * (1.0 - 1e-9) ? m->end : at + part;
}

/* Halve the part of a whole step that a lane has not taken, or that misses too much. */
static void halve(struct run *m, int lane, double part) {
  const long long needed = llround(log2(m->whole / part));
  struct matrix *own = m->matrix + lane;
  own->halvings = (own->halvings > needed ? own->halvings : needed) + 1;
  if (pow(0.5, (double)own->halvings) < m->shortest) leave(m, lane);
}

/* The lanes that are under way to the end of a whole step, and where their parts end. */
static vd_mask under_way(const struct run *m, real *to) {
  real is_open = vd_all(0.0);
  for (int lane = 0; lane < VD_LANES; lane++) {
    const int waits = m->lane_status[lane] != SOLVED || m->at.time[lane] >= m->end;
    ((double *)&is_open)[lane] = !waits;
    ((double *)to)[lane] = waits ? m->at.time[lane] : end_of_part(m, lane);
  }
  return vd_true(is_open);
}

/* Take a whole step of all lanes, each in parts of its own as run.c does. */
static void take_step(struct run *m, double end) {
  real to, is_good, error = vd_all(0.0);
  vd_mask wanted;
  m->whole = end - m->end;
  m->end = end;
  while (vd_any(wanted = under_way(m, &to))) {
    const vd_mask taken = try_step(m, to, wanted);
    if (m->tolerance > 0.0 && vd_any(taken)) {
      const real h = abreast(m->found.size);
      error = local_error(m, h, m->found.change, m->found.x) / m->tolerance;
    }
    is_good = vd_all(0.0);
    for (int lane = 0; lane < VD_LANES; lane++) {
      if (!VD_HOLDS(wanted, lane) || m->lane_status[lane] != SOLVED) continue;
      if (VD_HOLDS(taken, lane) && VD_LANE(error, lane) <= 1.0) ((double *)&is_good)[lane] = 1.0;
      else halve(m, lane, VD_LANE(to, lane) - m->at.time[lane]);
    }
    go_on(m, vd_true(is_good));
    for (int lane = 0; lane < VD_LANES; lane++) {
      struct matrix *own = m->matrix + lane;
      if (VD_LANE(is_good, lane) == 0.0) continue;
      if (VD_LANE(error, lane) < ROOM && own->halvings) own->halvings--;
      if (m->at.time[lane] < end) watch_lane(m, lane, m->at.time[lane]);
    }
  }
}

/* Begin at m->at, whose unknowns are solved; returns whether any lane goes on. */
VD_EXPORT int vd_newmark_begin(struct run *m) {
  const vd_mask open = going(m);
  const vd_mask found = evaluate(m, open, abreast(m->at.time), m->at.x, m->at.z, m->constants,
                                 m->at.rates, m->counts);
  for (int lane = 0; lane < VD_LANES; lane++)
    if (VD_HOLDS(open, lane) && !VD_HOLDS(found, lane)) leave(m, lane);
  for (long long k = 0; k < m->n_rows; k++) m->at.auxiliary[k] = m->at.rates[m->rows[k]];
  for (int lane = 0; lane < VD_LANES; lane++) m->at.size[lane] = 0.0;
  m->end = m->at.time[0];
  return vd_any(going(m));
}

/* Take steps up to m->last; write a sample behind each whole interval, those of a lane ``stride``
   apart from the next lane's, and count the good steps of each lane. */
VD_EXPORT int vd_newmark_advance(struct run *m) {
  double *samples = m->lane_samples;
  while (m->step < m->last && vd_any(going(m))) {
    const long long done = m->step / m->per_interval, part = m->step % m->per_interval + 1;
    const double begin = m->start + m->interval * (double)done;
    const double end = begin + m->interval * (double)part / (double)m->per_interval;
    take_step(m, end);
    m->step++;
    const int is_whole = m->step % m->per_interval == 0;
    const double sampled = m->start + m->interval * (double)(m->step / m->per_interval);
    m->lane_sample(end, is_whole, sampled, m->at.x, m->at.z, m->constants, m->weak, m->n_channels,
                   m->channels, samples, m->stride, m->watched, m->good, m->lane_status,
                   m->lane_where, m->lane_residual);
    if (is_whole) samples += m->n_channels;
  }
  return vd_any(going(m));
}
