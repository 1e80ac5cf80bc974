/* The part of every kernel that does not depend on the model: Newton's method on the blocks and
   fixed steps, for one case or for one in each lane. The generated part above defines the sizes
   NX, NZ, NY, NB, NW (largest block) and NE, the functions rates, outputs, events and resets,
   and the tables of blocks and events.
   A lane that has converged or failed keeps its values, so that no lane depends on others.
   interpreted.py holds the same algorithm; change both together. */

enum { SOLVED = 0, NOT_CONVERGED = 1, SINGULAR = 2, NOT_FINITE = 3, INACCURATE = 4, EVENT = 5, WEAK = 6 };
enum { RK4 = 0, SYMPLECTIC_EULER = 1, CHEBYSHEV = 100 };
enum { MOST_STAGES = 50 };
enum { MAX_ITERATIONS = 12 };

/* Where a step looks at its ends, as a part of the step: just inside, so that a corner of a law
   in time that falls on the end belongs to one step only, in spite of rounding. */
static const double INSIDE = 1e-8;

/* A Newton step this small leaves an error of its square times the curvature: below 1e-14. */
static const double SMALL_STEP = 1e-8, ROUNDING = 1e-13;

/* What becomes of the cases: those still going, and why and where the others stopped. */
struct course {
  vd_mask alive;
  real largest_residual;
  double failed_residual[VD_LANES];
  int status[VD_LANES], where[VD_LANES];
  long long evaluations, iterations;
};

static void begin_course(struct course *course) {
  memset(course, 0, sizeof *course);
  course->alive = vd_every(1);
}

static void stop_lanes(vd_mask lanes, int status, int where, real residual,
                       struct course *course) {
  lanes = vd_and(lanes, course->alive);
  for (int lane = 0; lane < VD_LANES; lane++)
    if (VD_HOLDS(lanes, lane)) {
      course->status[lane] = status;
      course->where[lane] = where;
      course->failed_residual[lane] = VD_LANE(residual, lane);
    }
  course->alive = vd_and(course->alive, vd_not(lanes));
}

VD_INLINE void swap_where(vd_mask lanes, real *a, real *b) {
  const real held = *a;
  *a = vd_select(lanes, *b, held);
  *b = vd_select(lanes, held, *b);
}

/* By Cramer's rule: one division, no choice of a pivot, for the size that most blocks have. */
VD_INLINE vd_mask solve_two(real *a, real *b) {
  const real determinant = a[0] * a[3] - a[1] * a[2], scale = 1.0 / determinant;
  const real first = (a[3] * b[0] - a[2] * b[1]) * scale;
  b[1] = (a[0] * b[1] - a[1] * b[0]) * scale;
  b[0] = first;
  return vd_ne(determinant, vd_all(0.0));
}

/* Solve a x = b, a stored by columns; x replaces b. Return the lanes where a is regular. */
static vd_mask solve_linear(int n, real *a, real *b) {
  if (n == 2) return solve_two(a, b);
  vd_mask regular = vd_every(1);
  for (int j = 0; j < n; j++) {
    real best = vd_abs(a[j + j * n]), row = vd_all((double)j);
    for (int i = j + 1; i < n; i++) {
      const real size = vd_abs(a[i + j * n]);
      const vd_mask better = vd_lt(best, size);
      best = vd_select(better, size, best);
      row = vd_select(better, vd_all((double)i), row);
    }
    regular = vd_and(regular, vd_ne(best, vd_all(0.0)));
    for (int i = j + 1; i < n; i++) {
      const vd_mask here = vd_eq(row, vd_all((double)i));
      if (!vd_any(here)) continue;
      for (int k = j; k < n; k++) swap_where(here, &a[j + k * n], &a[i + k * n]);
      swap_where(here, &b[j], &b[i]);
    }
    const real scale = 1.0 / a[j + j * n];
    for (int i = j + 1; i < n; i++) a[i + j * n] *= scale;
    for (int k = j + 1; k < n; k++) {
      const real top = a[j + k * n];
      for (int i = j + 1; i < n; i++) a[i + k * n] -= a[i + j * n] * top;
    }
    for (int i = j + 1; i < n; i++) b[i] -= a[i + j * n] * b[j];
    a[j + j * n] = scale;
  }
  for (int j = n - 1; j >= 0; j--) {
    b[j] *= a[j + j * n];
    for (int i = 0; i < j; i++) b[i] -= a[i + j * n] * b[j];
  }
  return regular;
}

static real largest_of(int n, const real *values) {
  real largest = vd_all(0.0);
  for (int i = 0; i < n; i++) {
    const real size = vd_abs(values[i]);
    largest = vd_select(vd_le(size, largest), largest, size);
  }
  return largest;
}

/* Residual and Jacobian of a block. */
static void evaluate_block(int k, const real *t, const real *x, const real *z, const real *c,
                           real *residual, real *jacobian) {
  real values[NV];
  const int n = block_start[k + 1] - block_start[k];
  wave_functions[wave_of[k]](t, x, z, c, values);
  memcpy(residual, values + value_start[k], n * sizeof(real));
  memcpy(jacobian, values + value_start[k] + n, n * n * sizeof(real));
}

static VD_APART void stop_block(vd_mask lanes, int status, int k, real t, const real *x,
                                const real *z, const real *c, struct course *course) {
  real residual[NW], jacobian[NW * NW];
  evaluate_block(k, &t, x, z, c, residual, jacobian);
  const int n = block_start[k + 1] - block_start[k];
  stop_lanes(lanes, status, k, largest_of(n, residual), course);
}

/* Take Newton's step of a block in the lanes that are open; return those that are open still. */
static vd_mask take_newton_step(int k, vd_mask open, real *values, real t, const real *x, real *z,
                                const real *c, struct course *course) {
  const int n = block_start[k + 1] - block_start[k];
  real *unknown = z + block_start[k], *step = values + value_start[k];
  const vd_mask regular = solve_linear(n, step + n, step);
  vd_mask finite = regular, small = open;
  for (int i = 0; i < n; i++) {
    const real next = unknown[i] - step[i];
    unknown[i] = vd_select(vd_and(open, regular), next, unknown[i]);
    finite = vd_and(finite, vd_finite(next));
    const real limit = SMALL_STEP + ROUNDING * vd_abs(next);
    small = vd_and(small, vd_le(vd_abs(step[i]), limit));
  }
  course->iterations++;
  const vd_mask lost = vd_and(open, vd_not(finite));
  if (vd_any(lost)) {
    stop_block(vd_and(lost, vd_not(regular)), SINGULAR, k, t, x, z, c, course);
    stop_block(lost, NOT_CONVERGED, k, t, x, z, c, course);
  }
  return vd_and(vd_and(open, finite), vd_not(small));
}

/* Solve blocks that do not depend on each other, all in each pass. */
static void newton(int wave, real t, const real *x, real *z, const real *c,
                   struct course *course) {
  const int first = wave_start[wave], last = wave_start[wave + 1];
  vd_mask open[NB + 1];
  real values[NV];
  for (int k = first; k < last; k++) open[k] = course->alive;
  for (int iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
    int going = 0;
    wave_functions[wave](&t, x, z, c, values);
    for (int k = first; k < last; k++) {
      open[k] = vd_and(open[k], course->alive);
      if (!vd_any(open[k])) continue;
      open[k] = take_newton_step(k, open[k], values, t, x, z, c, course);
      going |= vd_any(open[k]);
    }
    if (!going) return;
  }
  for (int k = first; k < last; k++)
    if (vd_any(open[k])) stop_block(open[k], NOT_CONVERGED, k, t, x, z, c, course);
}

static void solve_blocks(real t, const real *x, real *z, const real *c, struct course *course) {
  for (int wave = 0; wave < NWAVES && vd_any(course->alive); wave++)
    newton(wave, t, x, z, c, course);
}

/* Keep the largest residual; stop where a block is above its tolerance. */
static void check_residuals(real t, const real *x, const real *z, const real *c,
                            struct course *course) {
  real values[NV];
  for (int k = 0; k < NB; k++) {
    if (value_start[k] == 0) wave_functions[wave_of[k]](&t, x, z, c, values);
    const int n = block_start[k + 1] - block_start[k];
    const real residual = largest_of(n, values + value_start[k]);
    const vd_mask larger = vd_and(course->alive, vd_lt(course->largest_residual, residual));
    course->largest_residual = vd_select(larger, residual, course->largest_residual);
    const vd_mask held = vd_le(residual, vd_all(block_tolerance[k]));
    if (vd_any(vd_not(held))) stop_lanes(vd_not(held), INACCURATE, k, residual, course);
  }
}

/* Move n numbers on: to = from + a k. One case alone goes a register at a time. */
VD_INLINE void move_on(int n, real *restrict to, const real *restrict from, double a,
                       const real *restrict k) {
  int i = 0;
#if VD_LANES == 1 && defined(VD_WIDTH)
  for (; i + VD_WIDTH <= n; i += VD_WIDTH)
    *(vd_wide *)(to + i) = *(const vd_wide *)(from + i) + a * *(const vd_wide *)(k + i);
#endif
  for (; i < n; i++) to[i] = from[i] + a * k[i];
}

/* Zero, or no number where any of n numbers is not finite: x - x is zero but for these. The bits of
   wide ones are joined, which takes less time than adding one to the next. */
VD_INLINE real excess_of(int n, const real *x) {
#if VD_LANES > 1
  vd_bits found = {0};
  for (int i = 0; i < n; i++) found |= (vd_bits)(x[i] - x[i]);
  return (real)found;
#else
  real sum = 0.0;
  int i = 0;
#if defined(VD_WIDTH)
  vd_whole found = {0};
  for (; i + VD_WIDTH <= n; i += VD_WIDTH) {
    const vd_wide some = *(const vd_wide *)(x + i);
    found |= (vd_whole)(some - some);
  }
  for (int k = 0; k < VD_WIDTH; k++) sum += ((vd_wide)found)[k];
#endif
  for (; i < n; i++) sum = sum + (x[i] - x[i]);
  return sum;
#endif
}

static void check_finite(const real *x, struct course *course) {
  const vd_mask finite = vd_eq(excess_of(NX, x), vd_all(0.0));
  if (!vd_any(vd_and(course->alive, vd_not(finite)))) return;
  for (int i = 0; i < NX; i++)
    stop_lanes(vd_not(vd_finite(x[i])), NOT_FINITE, i, vd_all(0.0), course);
}

/* Solve the unknowns of a stage, starting from the guess in z, and find the rates. */
static void stage(double t, const real *x, real *z, const real *c, real *rate,
                  struct course *course) {
  const real now = vd_all(t);
  check_finite(x, course);
  solve_blocks(now, x, z, c, course);
  if (!vd_any(course->alive)) return;
  rates(&now, x, z, c, rate);
  course->evaluations++;
}

/* Classical Runge-Kutta step. The guesses of the unknowns extrapolate the start and middle of
   the last step, kept in memory as flag, start, middle: errors of third order in h. Times t and
   last lie just inside the step. */
static void step_rk4(double t, double middle, double last, double end, double h, real *x,
                     real *z, const real *c, real *memory, struct course *course) {
  real k1[NX1], k2[NX1], k3[NX1], k4[NX1], xs[NX1], zs[NZ1], zm[NZ1], bend[NZ1];
  real *before = memory + 1, *between = memory + 1 + NZ;
  const vd_mask known = vd_true(memory[0]);
  const real now = vd_all(t);
  rates(&now, x, z, c, k1);
  course->evaluations++;
  for (int i = 0; i < NZ; i++) {
    zs[i] = z[i] + vd_only(known, 0.5 * (3.0 * z[i] - 4.0 * between[i] + before[i]));
    bend[i] = vd_only(known, z[i] - 2.0 * between[i] + before[i]);
  }
  move_on(NX, xs, x, 0.5 * h, k1);
  stage(middle, xs, zs, c, k2, course);
  if (!vd_any(course->alive)) return;
  for (int i = 0; i < NZ; i++) {
    zm[i] = zs[i];
    zs[i] += bend[i];
  }
  move_on(NX, xs, x, 0.5 * h, k2);
  stage(middle, xs, zs, c, k3, course);
  if (!vd_any(course->alive)) return;
  for (int i = 0; i < NZ; i++) {
    zm[i] = 0.5 * (zm[i] + zs[i]);
    zs[i] = 2.0 * zs[i] - z[i];
  }
  move_on(NX, xs, x, h, k3);
  stage(last, xs, zs, c, k4, course);
  if (!vd_any(course->alive)) return;
  for (int i = 0; i < NX; i++)
    xs[i] = x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
  check_finite(xs, course);
  solve_blocks(vd_all(end), xs, zs, c, course);
  if (!vd_any(course->alive)) return;
  memory[0] = vd_all(1.0);
  for (int i = 0; i < NZ; i++) {
    before[i] = z[i];
    between[i] = zm[i];
    z[i] = vd_select(course->alive, zs[i], z[i]);
  }
  for (int i = 0; i < NX; i++) x[i] = vd_select(course->alive, xs[i], x[i]);
}

/* Semi-implicit Euler step: positions move with the new velocities. */
static void step_symplectic(double t, double end, double h, real *x, real *z, const real *c,
                            real *memory, struct course *course) {
  real rate[NX1], xs[NX1], zs[NZ1];
  real *before = memory + 1;
  const vd_mask known = vd_true(memory[0]);
  const real now = vd_all(t);
  rates(&now, x, z, c, rate);
  course->evaluations++;
  for (int i = 0; i < NX; i++) xs[i] = x[i] + h * rate[i];
  for (int k = 0; k < NQ; k++) xs[positions[k]] = x[positions[k]] + h * xs[velocities[k]];
  check_finite(xs, course);
  for (int i = 0; i < NZ; i++) zs[i] = vd_select(known, 2.0 * z[i] - before[i], z[i]);
  solve_blocks(vd_all(end), xs, zs, c, course);
  if (!vd_any(course->alive)) return;
  memory[0] = vd_all(1.0);
  for (int i = 0; i < NZ; i++) {
    before[i] = z[i];
    z[i] = vd_select(course->alive, zs[i], z[i]);
  }
  for (int i = 0; i < NX; i++) x[i] = vd_select(course->alive, xs[i], x[i]);
}

/* Coefficients of a Runge-Kutta-Chebyshev step: the gain of stage j over the start adds up those
   of the two stages before it and rates; it lies at the part ``place`` of the step. Gains, not
   states, so that what has no rate stays as it is. */
struct chebyshev {
  int stages;
  double last[MOST_STAGES + 1], before[MOST_STAGES + 1], rate[MOST_STAGES + 1],
      first_rate[MOST_STAGES + 1], place[MOST_STAGES + 1];
};

/* Of second order, damped: Sommeijer, Shampine, Verwer (1998), equations (2.4) to (2.8). */
static void find_chebyshev(int stages, struct chebyshev *k) {
  double t[MOST_STAGES + 1], slope[MOST_STAGES + 1], bend[MOST_STAGES + 1], b[MOST_STAGES + 1];
  const double w0 = 1.0 + 2.0 / 13.0 / ((double)stages * stages);
  t[0] = 1.0, t[1] = w0, slope[0] = 0.0, slope[1] = 1.0, bend[0] = 0.0, bend[1] = 0.0;
  for (int j = 2; j <= stages; j++) {
    t[j] = 2.0 * w0 * t[j - 1] - t[j - 2];
    slope[j] = 2.0 * t[j - 1] + 2.0 * w0 * slope[j - 1] - slope[j - 2];
    bend[j] = 4.0 * slope[j - 1] + 2.0 * w0 * bend[j - 1] - bend[j - 2];
    b[j] = bend[j] / (slope[j] * slope[j]);
  }
  b[0] = b[1] = b[2];
  const double w1 = slope[stages] / bend[stages];
  k->stages = stages;
  k->rate[1] = b[1] * w1;
  for (int j = 2; j <= stages; j++) {
    k->last[j] = 2.0 * b[j] * w0 / b[j - 1];
    k->before[j] = -b[j] / b[j - 2];
    k->rate[j] = 2.0 * b[j] * w1 / b[j - 1];
    k->first_rate[j] = -(1.0 - b[j - 1] * t[j - 1]) * k->rate[j];
    k->place[j] = w1 * bend[j] / slope[j];
  }
  k->place[1] = k->place[2] / slope[2];
}

/* Counted from the first step of the run, so that no rounding adds up. */
static double time_of(long long step, double part, double start, double interval,
                      long long per_interval) {
  return start + interval * ((double)(step / per_interval) +
                             ((double)(step % per_interval) + part) / (double)per_interval);
}

/* A run with fixed steps: when its steps are, and the method, CHEBYSHEV plus the number of
   stages for that one. */
struct march {
  int method;
  long long per_interval;
  double start, interval;
  struct chebyshev chebyshev;
};

static struct march begin_march(int method, long long per_interval, double start,
                                double interval) {
  struct march march;
  march.method = method;
  march.per_interval = per_interval;
  march.start = start;
  march.interval = interval;
  if (method > CHEBYSHEV) find_chebyshev(method - CHEBYSHEV, &march.chebyshev);
  return march;
}

/* Stabilised explicit step of second order, for rates whose fastest parts decay: it is stable
   down to about -0.65 stages^2 / h. The unknowns of a stage start from those of the one before. */
static void step_chebyshev(const struct march *march, long long step, double from, double part,
                           double t, double end, double h, real *x, real *z, const real *c,
                           struct course *course) {
  const struct chebyshev *k = &march->chebyshev;
  real first[NX1], rate[NX1], before[NX1], gain[NX1], xs[NX1], zs[NZ1];
  const real now = vd_all(t);
  rates(&now, x, z, c, first);
  course->evaluations++;
  memcpy(zs, z, NZ * sizeof(real));
  for (int i = 0; i < NX; i++) {
    before[i] = vd_all(0.0);
    gain[i] = h * k->rate[1] * first[i];
    xs[i] = x[i] + gain[i];
  }
  for (int j = 2; j <= k->stages; j++) {
    const double place = from + part * fmin(k->place[j - 1], 1.0 - INSIDE);
    stage(time_of(step, place, march->start, march->interval, march->per_interval), xs, zs, c,
          rate, course);
    if (!vd_any(course->alive)) return;
    for (int i = 0; i < NX; i++) {
      const real next = k->last[j] * gain[i] + k->before[j] * before[i] +
                        h * (k->rate[j] * rate[i] + k->first_rate[j] * first[i]);
      before[i] = gain[i];
      gain[i] = next;
      xs[i] = x[i] + next;
    }
  }
  check_finite(xs, course);
  solve_blocks(vd_all(end), xs, zs, c, course);
  if (!vd_any(course->alive)) return;
  for (int i = 0; i < NZ; i++) z[i] = vd_select(course->alive, zs[i], z[i]);
  for (int i = 0; i < NX; i++) x[i] = vd_select(course->alive, xs[i], x[i]);
}

/* Take the part of a step from one fraction of it to another. */
static void take_step(const struct march *march, long long step, double from, double to,
                      const real *c, real *x, real *z, real *memory, struct course *course) {
  const long long per = march->per_interval;
  const double start = march->start, interval = march->interval;
  const double part = to - from, h = interval / (double)per * part;
  const double t = time_of(step, from + INSIDE * part, start, interval, per);
  const double middle = time_of(step, from + 0.5 * part, start, interval, per);
  const double end = to < 1.0 ? time_of(step, to, start, interval, per)
                              : time_of(step + 1, 0.0, start, interval, per);
  const double last = time_of(step, to - INSIDE * part, start, interval, per);
  if (march->method == RK4)
    step_rk4(t, middle, last, end, h, x, z, c, memory, course);
  else if (march->method == SYMPLECTIC_EULER)
    step_symplectic(t, end, h, x, z, c, memory, course);
  else
    step_chebyshev(march, step, from, part, t, end, h, x, z, c, course);
}
