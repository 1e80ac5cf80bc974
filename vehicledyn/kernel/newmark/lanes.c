/* Cases side by side with steps of one size, halved where Newton's method asks for it. A lane in
   which an event fires, or that needs full factors or other derivatives, stops with EVENT: it is run
   by itself. */

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

/* Try a step of some lanes to m->found; return those that take it. A lane that has failed with an
   old Jacobian tries again with a new one. */
static vd_mask try_step(struct run *m, double end, vd_mask wanted) {
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
      if (!prepare_factors(m, lane, end - m->at.time)) leave(m, lane);
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
    if (VD_HOLDS(lanes, lane)) at->size[lane] = found->size[lane];
}

static vd_mask only(int lane) {
  real own = vd_all(0.0);
  ((double *)&own)[lane] = 1.0;
  return vd_true(own);
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

/* Take a step of one lane in parts, as run.c does; the others wait at its begin. */
static void take_parts(struct run *m, int lane, double end) {
  struct matrix *own = m->matrix + lane;
  const double begin = m->at.time, whole = end - begin;
  while (m->at.time < end && m->lane_status[lane] == SOLVED) {
    const double part = whole * pow(0.5, (double)own->halvings), remaining = end - m->at.time;
    const double to = part >= remaining * (1.0 - 1e-9) ? end : m->at.time + part;
    if (!vd_any(try_step(m, to, only(lane)))) {
      const long long needed = llround(log2(whole / (to - m->at.time)));
      own->halvings = (own->halvings > needed ? own->halvings : needed) + 1;
      if (pow(0.5, (double)own->halvings) < m->shortest) leave(m, lane);
      continue;
    }
    go_on(m, only(lane));
    m->at.time = to;
    if (own->halvings) own->halvings--;
    if (to < end) watch_lane(m, lane, to);
  }
  m->at.time = begin;
}

/* Take a step of all lanes at once, but for those that need parts. */
static void take_step(struct run *m, double end) {
  real is_whole = vd_all(0.0);
  for (int lane = 0; lane < VD_LANES; lane++)
    ((double *)&is_whole)[lane] = m->matrix[lane].halvings == 0;
  const vd_mask wanted = vd_and(going(m), vd_true(is_whole));
  const vd_mask taken = try_step(m, end, wanted);
  const vd_mask others = vd_and(going(m), vd_not(taken));
  go_on(m, taken);
  for (int lane = 0; lane < VD_LANES; lane++)
    if (VD_HOLDS(others, lane)) {
      if (VD_HOLDS(wanted, lane)) m->matrix[lane].halvings = 1;
      take_parts(m, lane, end);
    }
  m->at.time = end;
}

/* Begin at m->at, whose unknowns are solved; returns whether any lane goes on. */
VD_EXPORT int vd_newmark_begin(struct run *m) {
  const vd_mask open = going(m);
  const vd_mask found = evaluate(m, open, m->at.time, m->at.x, m->at.z, m->constants, m->at.rates,
                                 m->counts);
  for (int lane = 0; lane < VD_LANES; lane++)
    if (VD_HOLDS(open, lane) && !VD_HOLDS(found, lane)) leave(m, lane);
  for (long long k = 0; k < m->n_rows; k++) m->at.auxiliary[k] = m->at.rates[m->rows[k]];
  for (int lane = 0; lane < VD_LANES; lane++) m->at.size[lane] = 0.0;
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
