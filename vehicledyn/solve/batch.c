/* What a kernel offers to many cases, one in each lane; arrays hold the lanes of each number
   side by side. */

/* Hand out why and where lanes stopped; those that go on have the status SOLVED. */
static int hand_out(const struct course *course, int *status, int *where, double *residual) {
  for (int lane = 0; lane < VD_LANES; lane++) {
    status[lane] = course->status[lane];
    where[lane] = course->where[lane];
    residual[lane] = course->failed_residual[lane];
  }
  return vd_any(course->alive);
}

/* Take up lanes that may have stopped before. */
static void resume(struct course *course, const int *status, const int *where,
                   const double *residual) {
  begin_course(course);
  real going = vd_all(1.0);
  for (int lane = 0; lane < VD_LANES; lane++) {
    course->status[lane] = status[lane];
    course->where[lane] = where[lane];
    course->failed_residual[lane] = residual[lane];
    if (status[lane] != SOLVED) ((double *)&going)[lane] = 0.0;
  }
  course->alive = vd_true(going);
}

static void take_sample(const real *y, const struct course *course, int n_channels,
                        const int *channels, double *samples, long long stride) {
  for (int lane = 0; lane < VD_LANES; lane++)
    if (VD_HOLDS(course->alive, lane))
      for (int k = 0; k < n_channels; k++)
        samples[lane * stride + k] = VD_LANE(y[channels[k]], lane);
}

VD_EXPORT const int vd_lanes = VD_LANES;

VD_EXPORT void vd_prepare_lanes(const real *p, real *c) { prepare(p, c); }

/* Solve the blocks from a guess in z and find the rates. */
VD_EXPORT int vd_rates_lanes(double t, const real *x, real *z, const real *c, real *rate,
                             int *status, int *where, double *residual) {
  struct course course;
  begin_course(&course);
  const real now = vd_all(t);
  solve_blocks(now, x, z, c, &course);
  check_residuals(now, x, z, c, &course);
  rates(&now, x, z, c, rate);
  return hand_out(&course, status, where, residual);
}

/* Solve the blocks at the start, from a guess in z, and write the first sample. */
VD_EXPORT int vd_begin_lanes(double t, const real *x, real *z, const real *c, int n_channels,
                             const int *channels, double *samples, long long stride,
                             int *status, int *where, double *residual) {
  real y[NY + 1], again[NZ1];
  struct course course;
  begin_course(&course);
  const real now = vd_all(t);
  solve_blocks(now, x, z, c, &course);
  check_residuals(now, x, z, c, &course);
  memcpy(again, z, NZ * sizeof(real));
  solve_blocks(now, x, again, c, &course); /* as a run of one case does for its first sample */
  outputs(&now, x, again, c, y);
  take_sample(y, &course, n_channels, channels, samples, stride);
  return hand_out(&course, status, where, residual);
}

/* Take n_steps steps; after each whole interval check the loops and write a sample, those of a
   lane ``stride`` apart from the next lane's. Count the good steps of each lane. */
VD_EXPORT int vd_advance_lanes(int method, long long first_step, long long n_steps,
                               long long per_interval, double start, double interval,
                               const real *c, real *x, real *z, real *memory, int n_channels,
                               const int *channels, double *samples, long long stride,
                               long long *good, int *status, int *where, double *residual) {
  const struct march march = begin_march(method, per_interval, start, interval);
  real y[NY + 1];
  struct course course;
  resume(&course, status, where, residual);
  for (long long step = first_step; step < first_step + n_steps; step++) {
    if (!vd_any(course.alive)) break;
    take_step(&march, step, 0.0, 1.0, c, x, z, memory, &course);
    for (int lane = 0; lane < VD_LANES; lane++) good[lane] += course.status[lane] == SOLVED;
    if ((step + 1) % per_interval || !vd_any(course.alive)) continue;
    const real end = vd_all(time_of(step + 1, 0.0, start, interval, per_interval));
    check_residuals(end, x, z, c, &course);
    outputs(&end, x, z, c, y);
    take_sample(y, &course, n_channels, channels, samples, stride);
    samples += n_channels;
  }
  return hand_out(&course, status, where, residual);
}
