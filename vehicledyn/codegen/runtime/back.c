/* Adjoints of a motion with steps of rk4, for one case: what a change of the states before a step
   does to a number drawn from the motion, from what one of those behind it does. */

/* Take steps and keep states and unknowns at the begin of each. */
VD_EXPORT int vd_record(long long step, long long n_steps, long long per, double start,
                        double interval, const double *c, double *x, double *z, double *memory,
                        double *xs, double *zs) {
  const struct march march = begin_march(RK4, per, start, interval);
  struct course course;
  begin_course(&course);
  for (long long k = 0; k < n_steps; k++) {
    memcpy(xs + k * NX, x, NX * sizeof(double));
    memcpy(zs + k * NZ, z, NZ * sizeof(double));
    take_step(&march, step + k, 0.0, 1.0, c, x, z, memory, &course);
    if (!course.alive) break;
  }
  return course.status[0];
}

/* Adjoints of the rates' inputs: t holds columns, those of constants add up. */
static void rates_back(const double *w, const int *targets, const double *rate_bar, double *b,
                       double *t, double *x_bar) {
  for (int i = 0; i < NX; i++) b[targets[i]] = rate_bar[i];
  stage_back(w, b, t);
  memcpy(x_bar, t + 1, NX * sizeof(double));
}

/* One step: the stages anew, then their adjoints from last to first. w has room for the weights
   of four stages, n_weights each. */
static int step_back(const double *times, double h, const double *c, const double *x,
                     const double *z, double *w, long long n_weights, const int *targets,
                     double *b, double *t, double *x_bar) {
  static const double share[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
  double k[NX1], xs[NX1], zs[NZ1], rate_bar[NX1], stage_bar[NX1], total[NX1];
  memcpy(xs, x, NX * sizeof(double));
  memcpy(zs, z, NZ * sizeof(double));
  for (int stage = 0; stage < 4; stage++) {
    int status = stage ? vd_solve_point(times[stage], xs, zs, c) : 0;
    if (!status) status = vd_linearise(times[stage], xs, zs, c, k, w + stage * n_weights);
    if (status) return status;
    if (stage < 3)
      for (int i = 0; i < NX; i++) xs[i] = x[i] + share[stage + 1] * h * k[i];
  }
  memcpy(total, x_bar, NX * sizeof(double));
  memset(stage_bar, 0, sizeof stage_bar);
  for (int stage = 3; stage >= 0; stage--) {
    const double later = stage < 3 ? share[stage + 1] * h : 0.0;
    for (int i = 0; i < NX; i++)
      rate_bar[i] = h / 6.0 * weight[stage] * x_bar[i] + later * stage_bar[i];
    rates_back(w + stage * n_weights, targets, rate_bar, b, t, stage_bar);
    for (int i = 0; i < NX; i++) total[i] += stage_bar[i];
  }
  memcpy(x_bar, total, NX * sizeof(double));
  return SOLVED;
}

/* Go back over n_steps steps whose begins are kept in xs and zs. */
VD_EXPORT int vd_steps_back(long long first, long long n_steps, long long per, double start,
                            double interval, const double *c, const double *xs,
                            const double *zs, double *w, long long n_weights,
                            const int *targets, double *b, double *t, double *x_bar) {
  const double h = interval / (double)per;
  for (long long k = n_steps - 1; k >= 0; k--) {
    const long long step = first + k;
    const double times[4] = {time_of(step, INSIDE, start, interval, per),
                             time_of(step, 0.5, start, interval, per),
                             time_of(step, 0.5, start, interval, per),
                             time_of(step, 1.0 - INSIDE, start, interval, per)};
    const int status = step_back(times, h, c, xs + k * NX, zs + k * NZ, w, n_weights, targets, b,
                                 t, x_bar);
    if (status) return status;
  }
  return SOLVED;
}

/* Add to x_bar and to the constants in t what seeds of observed values at a point do. b and t are
   those of the stage, own_b and own_t those of what is observed. */
VD_EXPORT int vd_values_back(double time, const double *x, const double *z, const double *c,
                             double *w, double *own_w, const int *rates, const int *unknowns,
                             const int *own_targets, long long n_values,
                             const double *seeds, double *b, double *t, double *own_b,
                             double *own_t, double *x_bar) {
  double values[n_values + 1], rate[NX1];
  vd_observe(time, x, z, c, values, own_w);
  const int status = vd_linearise(time, x, z, c, rate, w);
  if (status) return status;
  for (long long i = 0; i < n_values; i++) own_b[own_targets[i]] = seeds[i];
  point_back(own_w, own_b, own_t);
  for (int i = 0; i < NX; i++) b[rates[i]] = 0.0;
  for (int i = 0; i < NZ; i++) b[unknowns[i]] = own_t[1 + NX + i];
  stage_back(w, b, t);
  for (int i = 0; i < NZ; i++) b[unknowns[i]] = 0.0;
  for (int i = 0; i < NX; i++) x_bar[i] += own_t[1 + i] + t[1 + i];
  return SOLVED;
}
