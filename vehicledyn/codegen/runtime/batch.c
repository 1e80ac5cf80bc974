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

/* Pieces of the outputs that some channels need. */
static unsigned long long pieces_of(int n_channels, const int *channels) {
  unsigned long long pieces = 0;
  for (int k = 0; k < n_channels; k++) pieces |= outputs_need(channels[k]);
  return pieces;
}

/* What is watched in each lane: the signs of the events, the last determinant of each block and
   the largest so far. A lane in which an event fires, or a block becomes weak or changes the sign
   of its determinant, stops with EVENT or WEAK: it is run anew by itself. Blocks are not watched
   where ``weak`` is zero. */
enum { SIDES = 0, DETERMINANTS = NE, LARGEST = NE + NB };

VD_EXPORT const int vd_lanes = VD_LANES;
VD_EXPORT const int vd_watched = NE + 2 * NB;

/* Determinant of a, stored by columns and overwritten; no number where a column is zero. */
static real lane_determinant(int n, real *a) {
  if (n == 2) return a[0] * a[3] - a[2] * a[1];
  real determinant = vd_all(1.0);
  for (int j = 0; j < n; j++) {
    for (int i = j + 1; i < n; i++) {
      const vd_mask larger = vd_lt(vd_abs(a[j + j * n]), vd_abs(a[i + j * n]));
      if (!vd_any(larger)) continue;
      for (int k = j; k < n; k++) swap_where(larger, &a[j + k * n], &a[i + k * n]);
      determinant = vd_select(larger, -determinant, determinant);
    }
    determinant = determinant * a[j + j * n];
    for (int k = j + 1; k < n; k++) {
      const real factor = a[j + k * n] / a[j + j * n];
      for (int i = j + 1; i < n; i++) a[i + k * n] -= a[i + j * n] * factor;
    }
  }
  return determinant;
}

static void find_determinants(real t, const real *x, const real *z, const real *c,
                              real *determinants) {
  real residual[NW], jacobian[NW * NW];
  for (int k = 0; k < NB; k++) {
    evaluate_block(k, &t, x, z, c, residual, jacobian);
    determinants[k] = lane_determinant(block_start[k + 1] - block_start[k], jacobian);
  }
}

/* An event whose function is zero at the start is for the run of one case to look at. */
static void begin_watch(real t, const real *x, const real *z, const real *c, real *watched,
                        struct course *course) {
  real values[NE1], *determinants = watched + DETERMINANTS, *largest = watched + LARGEST;
  events(&t, x, z, c, values);
  for (int k = 0; k < NE; k++) {
    watched[SIDES + k] = vd_sign(values[k]);
    stop_lanes(vd_eq(values[k], vd_all(0.0)), EVENT, k, vd_all(0.0), course);
  }
  find_determinants(t, x, z, c, determinants);
  for (int k = 0; k < NB; k++) largest[k] = vd_abs(determinants[k]);
}

static void watch_events(real t, const real *x, const real *z, const real *c, real *watched,
                         struct course *course) {
  const real zero = vd_all(0.0);
  real values[NE1];
  events(&t, x, z, c, values);
  for (int k = 0; k < NE; k++) {
    real *side = watched + SIDES + k;
    vd_mask fires = vd_every(0);
    if (fires_rising[k]) fires = vd_and(vd_lt(*side, zero), vd_le(zero, values[k]));
    if (fires_falling[k])
      fires = vd_or(fires, vd_and(vd_lt(zero, *side), vd_le(values[k], zero)));
    if (vd_any(fires)) stop_lanes(fires, EVENT, k, zero, course);
    *side = vd_select(vd_ne(values[k], zero), vd_sign(values[k]), *side);
  }
}

static void watch_blocks(real t, const real *x, const real *z, const real *c, double weak,
                         real *watched, struct course *course) {
  real determinants[NB + 1], *before = watched + DETERMINANTS, *largest = watched + LARGEST;
  find_determinants(t, x, z, c, determinants);
  for (int k = 0; k < NB; k++) {
    const real size = vd_abs(determinants[k]);
    largest[k] = vd_select(vd_lt(largest[k], size), size, largest[k]);
    const vd_mask sound = vd_and(vd_le(weak * largest[k], size),
                                 vd_lt(vd_all(0.0), determinants[k] * before[k]));
    if (vd_any(vd_not(sound))) stop_lanes(vd_not(sound), WEAK, k, vd_all(0.0), course);
    before[k] = determinants[k];
  }
}

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
                             real *watched, int *status, int *where, double *residual) {
  real y[NY + 1], again[NZ1];
  struct course course;
  begin_course(&course);
  const real now = vd_all(t);
  solve_blocks(now, x, z, c, &course);
  check_residuals(now, x, z, c, &course);
  memcpy(again, z, NZ * sizeof(real));
  solve_blocks(now, x, again, c, &course); /* as a run of one case does for its first sample */
  outputs_selected(pieces_of(n_channels, channels), &now, x, again, c, y);
  take_sample(y, &course, n_channels, channels, samples, stride);
  begin_watch(now, x, z, c, watched, &course);
  return hand_out(&course, status, where, residual);
}

/* Solve the blocks of the lanes that go on, each at a time of its own, from a guess in z, and find
   the rates. */
VD_EXPORT int vd_evaluate_lanes(const real *t, const real *x, real *z, const real *c, real *rate,
                                int *status, int *where, double *residual) {
  struct course course;
  resume(&course, status, where, residual);
  solve_blocks(*t, x, z, c, &course);
  rates(t, x, z, c, rate);
  return hand_out(&course, status, where, residual);
}

/* Watch the events at the end of a step that was taken elsewhere, count it where it is good, and
   write a sample if it ends an interval, with unknowns that are solved once more. */
VD_EXPORT int vd_follow_lanes(double end, int is_whole, double sampled, const real *x, const real *z,
                              const real *c, double weak, int n_channels, const int *channels,
                              double *samples, long long stride, real *watched, long long *good,
                              int *status, int *where, double *residual) {
  real y[NY + 1], again[NZ1];
  struct course course;
  resume(&course, status, where, residual);
  if (NE) watch_events(vd_all(end), x, z, c, watched, &course);
  for (int lane = 0; lane < VD_LANES; lane++) good[lane] += course.status[lane] == SOLVED;
  if (is_whole && vd_any(course.alive)) {
    const real now = vd_all(sampled);
    memcpy(again, z, NZ * sizeof(real));
    solve_blocks(now, x, again, c, &course);
    check_residuals(now, x, again, c, &course);
    if (NB && weak > 0.0) watch_blocks(now, x, again, c, weak, watched, &course);
    outputs_selected(pieces_of(n_channels, channels), &now, x, again, c, y);
    take_sample(y, &course, n_channels, channels, samples, stride);
  }
  return hand_out(&course, status, where, residual);
}

/* Take n_steps steps; after each whole interval check the loops and write a sample, those of a
   lane ``stride`` apart from the next lane's. Count the good steps of each lane. */
VD_EXPORT int vd_advance_lanes(int method, long long first_step, long long n_steps,
                               long long per_interval, double start, double interval,
                               const real *c, real *x, real *z, real *memory, int n_channels,
                               const int *channels, double *samples, long long stride,
                               double weak, real *watched, long long *good, int *status,
                               int *where, double *residual) {
  const struct march march = begin_march(method, per_interval, start, interval);
  const unsigned long long pieces = pieces_of(n_channels, channels);
  real y[NY + 1];
  struct course course;
  resume(&course, status, where, residual);
  for (long long step = first_step; step < first_step + n_steps; step++) {
    if (!vd_any(course.alive)) break;
    take_step(&march, step, 0.0, 1.0, c, x, z, memory, &course);
    const real end = vd_all(time_of(step + 1, 0.0, start, interval, per_interval));
    if (NE) watch_events(end, x, z, c, watched, &course);
    for (int lane = 0; lane < VD_LANES; lane++) good[lane] += course.status[lane] == SOLVED;
    if ((step + 1) % per_interval || !vd_any(course.alive)) continue;
    check_residuals(end, x, z, c, &course);
    if (NB && weak > 0.0) watch_blocks(end, x, z, c, weak, watched, &course);
    outputs_selected(pieces, &end, x, z, c, y);
    take_sample(y, &course, n_channels, channels, samples, stride);
    samples += n_channels;
  }
  return hand_out(&course, status, where, residual);
}
