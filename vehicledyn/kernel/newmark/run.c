/* Runs of one case: steps of one size or controlled by their error, events and samples. A step that
   needs a Jacobian of Python's ends the call; it is taken again once that is there. */

static int constrained_step(struct run *m, double end);
static void show_place(struct run *m, double *values);

/* Take a step from m->at to m->found. */
VD_EXPORT int vd_newmark_step(struct run *m, double end) {
  if (m->constrained.residual) return constrained_step(m, end);
  struct matrix *own = m->matrix;
  for (;;) {
    if ((own->is_stale || !own->has_jacobian) && !find_jacobian(m, 0)) return NEEDS_JACOBIAN;
    const int is_new = own->has_jacobian == FRESH;
    own->has_jacobian = KEPT;
    prepare_factors(m, 0, end - m->at.time[0]);
    if (iterate(m, end, 1)) return TAKEN;
    if (is_new) return REFUSED;
    own->is_stale = 1;
  }
}

/* Tell whether an event fires up to m->found; where none does, the sides become those there. */
static int event_fires(struct run *m) {
  if (!m->n_events || m->found.time[0] < m->blind_until) return 0;
  double *values = m->work;
  m->events(m->found.time[0], m->found.x, m->found.z, m->constants, values);
  for (long long k = 0; k < m->n_events; k++) {
    if (m->sides[k] < 0 && values[k] >= 0.0 && m->rising[k]) return 1;
    if (m->sides[k] > 0 && values[k] <= 0.0 && m->falling[k]) return 1;
  }
  for (long long k = 0; k < m->n_events; k++)
    if (values[k] != 0.0) m->sides[k] = values[k] > 0.0 ? 1 : -1;
  return 0;
}

static void count_steps(struct run *m, double size) {
  m->counts[STEPS]++;
  m->least = fmin(m->least, size);
  m->most = fmax(m->most, size);
}

/* Write a sample: its unknowns are solved once more, and its blocks checked. */
static int take_sample(struct run *m) {
  const struct place *at = &m->at;
  const long long row = m->counts[SAMPLES];
  const double time = m->start + m->interval * (double)(m->step / m->per_interval);
  double *x = m->xs + row * m->n_states, *z = m->zs + row * m->n_unknowns, *found = m->work;
  memcpy(x, at->x, m->n_states * sizeof(double));
  memcpy(z, at->z, m->n_unknowns * sizeof(double));
  m->status = m->solve(time, x, z, m->constants, m->counts, m->figures);
  if (m->status) return UNSOLVED;
  m->survey(1, &time, x, z, m->constants, found, found + m->n_blocks);
  for (long long k = 0; k < m->n_blocks; k++) {
    if (!(found[k] <= m->figures[0])) m->figures[0] = found[k];
    if (found[k] <= m->tolerances[k]) continue;
    m->figures[1] = found[k];
    m->counts[WHERE] = k;
    return INACCURATE;
  }
  double *values = m->ys + row * m->n_outputs;
  if (m->constrained.output) show_place(m, values);
  else m->outputs(time, x, z, m->constants, values);
  m->counts[SAMPLES]++;
  return TAKEN;
}

static void go_on(struct run *m) {
  const size_t size = sizeof(double), n = m->n_rows * size;
  memcpy(m->at.x, m->found.x, m->n_states * size);
  memcpy(m->at.z, m->found.z, m->n_unknowns * size);
  memcpy(m->at.rates, m->found.rates, m->n_rates * size);
  memcpy(m->at.auxiliary, m->found.auxiliary, n);
  memcpy(m->at.change, m->found.change, n);
  memcpy(m->at.drift, m->found.drift, m->n_unknowns * size);
  memcpy(m->at.forces, m->found.forces, 2 * m->constrained.n_multipliers * size);
  m->at.time[0] = m->found.time[0], m->at.size[0] = m->found.size[0];
}

/* Go on to the end of the step that is due, in parts where it must be. */
static int finish_step(struct run *m) {
  while (m->at.time[0] < m->end) {
    const double part = m->whole * pow(0.5, (double)m->halvings), remaining = m->end - m->at.time[0];
    m->to = part >= remaining * (1.0 - 1e-9) ? m->end : m->at.time[0] + part;
    const int status = vd_newmark_step(m, m->to);
    if (status == NEEDS_JACOBIAN) return status;
    m->error = status == REFUSED ? 2.0 : m->tolerance > 0.0 ? local_error(m, m->found.size[0], m->found.change, m->found.x) / m->tolerance : 0.0;
    if (status == REFUSED || !(m->error <= 1.0)) {
      const long long needed = llround(log2(m->whole / (m->to - m->at.time[0])));
      m->halvings = (m->halvings > needed ? m->halvings : needed) + 1;
      if (pow(0.5, (double)m->halvings) >= m->shortest) continue;
      return status == REFUSED ? STUCK : INEXACT;
    }
    if (m->tolerance > 0.0 || m->to < m->end) count_steps(m, m->to - m->at.time[0]);
    if (event_fires(m)) return CROSSED;
    go_on(m);
    if (m->error < ROOM && m->halvings) m->halvings--;
  }
  if (m->tolerance <= 0.0) count_steps(m, m->whole);
  return TAKEN;
}

/* Take steps up to m->last, at most m->room samples and about m->budget steps; samples are written
   behind whole intervals. The call ends where Python must do something. */
VD_EXPORT int vd_newmark_advance(struct run *m) {
  while (m->step < m->last) {
    if (!m->is_within) {
      const long long done = m->step / m->per_interval, part = m->step % m->per_interval + 1;
      const double begin = m->start + m->interval * (double)done;
      m->end = begin + m->interval * (double)part / (double)m->per_interval;
      m->whole = m->end - m->at.time[0];
      m->is_within = 1;
    }
    int status = finish_step(m);
    if (status != TAKEN) return status;
    m->is_within = 0;
    m->step++;
    if (m->step % m->per_interval == 0 && (status = take_sample(m)) != TAKEN) return status;
    if (m->counts[SAMPLES] >= m->room || --m->budget <= 0) return PAUSED;
  }
  return TAKEN;
}
