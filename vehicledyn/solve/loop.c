/* The part of every kernel that does not depend on the model: Newton's method on the blocks,
   fixed-step integration and sampling. The generated part above defines the sizes NX, NZ, NY,
   NB, NW (largest block) and NE, the functions rates, outputs, events and resets, and the
   tables of blocks and events.
   interpreted.py holds the same algorithm; change both together. */

enum { SOLVED = 0, NOT_CONVERGED = 1, SINGULAR = 2, NOT_FINITE = 3, INACCURATE = 4, EVENT = 5 };
enum { RK4 = 0, SYMPLECTIC_EULER = 1 };
enum { SAMPLES, STEPS, EVALUATIONS, ITERATIONS, WHERE };
enum { LARGEST_RESIDUAL, FAILED_RESIDUAL };
enum { MAX_ITERATIONS = 12 };

/* Where a step looks at its ends, as a part of the step: just inside, so that a corner of a law
   in time that falls on the end belongs to one step only, in spite of rounding. */
static const double INSIDE = 1e-8;

/* A Newton step this small leaves an error of its square times the curvature: below 1e-14. */
static const double SMALL_STEP = 1e-8, ROUNDING = 1e-13;

/* Solve a x = b, a stored by columns; x replaces b. Return 0 if a is singular. */
static int solve_linear(int n, double *a, double *b) {
  for (int j = 0; j < n; j++) {
    int pivot = j;
    for (int i = j + 1; i < n; i++)
      if (fabs(a[i + j * n]) > fabs(a[pivot + j * n])) pivot = i;
    if (a[pivot + j * n] == 0.0) return 0;
    if (pivot != j) {
      for (int k = j; k < n; k++) {
        const double held = a[j + k * n];
        a[j + k * n] = a[pivot + k * n];
        a[pivot + k * n] = held;
      }
      const double held = b[j];
      b[j] = b[pivot];
      b[pivot] = held;
    }
    const double scale = 1.0 / a[j + j * n];
    for (int i = j + 1; i < n; i++) a[i + j * n] *= scale;
    for (int k = j + 1; k < n; k++) {
      const double top = a[j + k * n];
      if (top != 0.0)
        for (int i = j + 1; i < n; i++) a[i + k * n] -= a[i + j * n] * top;
    }
    for (int i = j + 1; i < n; i++) b[i] -= a[i + j * n] * b[j];
    a[j + j * n] = scale;
  }
  for (int j = n - 1; j >= 0; j--) {
    b[j] *= a[j + j * n];
    for (int i = 0; i < j; i++) b[i] -= a[i + j * n] * b[j];
  }
  return 1;
}

static int newton(int k, double t, const double *x, double *z, const double *c,
                  long long *counts) {
  double step[NW], jacobian[NW * NW];
  double *unknown = z + block_start[k];
  const int n = block_start[k + 1] - block_start[k];
  for (int iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
    block_functions[k](&t, x, z, c, step, jacobian);
    counts[ITERATIONS]++;
    if (!solve_linear(n, jacobian, step)) return SINGULAR;
    int small = 1;
    for (int i = 0; i < n; i++) {
      unknown[i] -= step[i];
      if (!isfinite(unknown[i])) return NOT_CONVERGED;
      if (!(fabs(step[i]) <= SMALL_STEP + ROUNDING * fabs(unknown[i]))) small = 0;
    }
    if (small) return SOLVED;
  }
  return NOT_CONVERGED;
}

static double residual_of(int k, double t, const double *x, const double *z, const double *c) {
  double residual[NW], jacobian[NW * NW], largest = 0.0;
  block_functions[k](&t, x, z, c, residual, jacobian);
  for (int i = 0; i < block_start[k + 1] - block_start[k]; i++)
    if (!(fabs(residual[i]) <= largest)) largest = fabs(residual[i]);
  return largest;
}

/* Determinant of a, stored by columns and overwritten. */
static double determinant_of(int n, double *a) {
  if (n == 2) return a[0] * a[3] - a[2] * a[1];
  double determinant = 1.0;
  for (int j = 0; j < n; j++) {
    int pivot = j;
    for (int i = j + 1; i < n; i++)
      if (fabs(a[i + j * n]) > fabs(a[pivot + j * n])) pivot = i;
    const double head = a[pivot + j * n];
    if (head == 0.0) return 0.0;
    determinant *= pivot == j ? head : -head;
    for (int k = j + 1; k < n; k++) {
      const double factor = a[pivot + k * n] / head;
      a[pivot + k * n] = a[j + k * n];
      if (factor != 0.0)
        for (int i = j + 1; i < n; i++)
          a[i + k * n] -= (i == pivot ? a[j + j * n] : a[i + j * n]) * factor;
    }
  }
  return determinant;
}

static int solve_blocks(double t, const double *x, double *z, const double *c,
                        long long *counts, double *figures) {
  for (int k = 0; k < NB; k++) {
    const int status = newton(k, t, x, z, c, counts);
    if (status != SOLVED) {
      counts[WHERE] = k;
      figures[FAILED_RESIDUAL] = residual_of(k, t, x, z, c);
      return status;
    }
  }
  return SOLVED;
}

/* Keep the largest residual; report a block above its tolerance. */
static int check_residuals(double t, const double *x, const double *z, const double *c,
                           long long *counts, double *figures) {
  for (int k = 0; k < NB; k++) {
    const double residual = residual_of(k, t, x, z, c);
    if (residual > figures[LARGEST_RESIDUAL]) figures[LARGEST_RESIDUAL] = residual;
    if (!(residual <= block_tolerance[k])) {
      counts[WHERE] = k;
      figures[FAILED_RESIDUAL] = residual;
      return INACCURATE;
    }
  }
  return SOLVED;
}

static int check_finite(const double *x, long long *counts) {
  for (int i = 0; i < NX; i++)
    if (!isfinite(x[i])) {
      counts[WHERE] = i;
      return NOT_FINITE;
    }
  return SOLVED;
}

/* Solve the unknowns of a stage, starting from the guess in z, and find the rates. */
static int stage(double t, const double *x, double *z, const double *c, double *rate,
                 long long *counts, double *figures) {
  const int finite = check_finite(x, counts);
  if (finite != SOLVED) return finite;
  const int status = solve_blocks(t, x, z, c, counts, figures);
  if (status != SOLVED) return status;
  rates(&t, x, z, c, rate);
  counts[EVALUATIONS]++;
  return SOLVED;
}

/* Classical Runge-Kutta step. The guesses of the unknowns extrapolate the start and middle of
   the last step, kept in memory as flag, start, middle: errors of third order in h. Times t and
   last lie just inside the step. */
static int step_rk4(double t, double middle, double last, double end, double h, double *x,
                    double *z, const double *c, double *memory, long long *counts,
                    double *figures) {
  double k1[NX1], k2[NX1], k3[NX1], k4[NX1], xs[NX1], zs[NZ1], zm[NZ1], bend[NZ1];
  double *before = memory + 1, *between = memory + 1 + NZ;
  int status;
  rates(&t, x, z, c, k1);
  counts[EVALUATIONS]++;
  for (int i = 0; i < NZ; i++) {
    const int known = memory[0] != 0.0;
    zs[i] = z[i] + (known ? 0.5 * (3.0 * z[i] - 4.0 * between[i] + before[i]) : 0.0);
    bend[i] = known ? z[i] - 2.0 * between[i] + before[i] : 0.0;
  }
  for (int i = 0; i < NX; i++) xs[i] = x[i] + 0.5 * h * k1[i];
  if ((status = stage(middle, xs, zs, c, k2, counts, figures)) != SOLVED) return status;
  for (int i = 0; i < NZ; i++) {
    zm[i] = zs[i];
    zs[i] += bend[i];
  }
  for (int i = 0; i < NX; i++) xs[i] = x[i] + 0.5 * h * k2[i];
  if ((status = stage(middle, xs, zs, c, k3, counts, figures)) != SOLVED) return status;
  for (int i = 0; i < NZ; i++) {
    zm[i] = 0.5 * (zm[i] + zs[i]);
    zs[i] = 2.0 * zs[i] - z[i];
  }
  for (int i = 0; i < NX; i++) xs[i] = x[i] + h * k3[i];
  if ((status = stage(last, xs, zs, c, k4, counts, figures)) != SOLVED) return status;
  for (int i = 0; i < NX; i++)
    xs[i] = x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
  if ((status = check_finite(xs, counts)) != SOLVED) return status;
  if ((status = solve_blocks(end, xs, zs, c, counts, figures)) != SOLVED) return status;
  memory[0] = 1.0;
  for (int i = 0; i < NZ; i++) {
    before[i] = z[i];
    between[i] = zm[i];
    z[i] = zs[i];
  }
  for (int i = 0; i < NX; i++) x[i] = xs[i];
  return SOLVED;
}

/* Semi-implicit Euler step: positions move with the new velocities. */
static int step_symplectic(double t, double end, double h, double *x, double *z,
                           const double *c, double *memory, long long *counts, double *figures) {
  double rate[NX1], xs[NX1], zs[NZ1];
  double *before = memory + 1;
  int status;
  rates(&t, x, z, c, rate);
  counts[EVALUATIONS]++;
  for (int i = 0; i < NX; i++) xs[i] = x[i] + h * rate[i];
  for (int k = 0; k < NQ; k++) xs[positions[k]] = x[positions[k]] + h * xs[velocities[k]];
  if ((status = check_finite(xs, counts)) != SOLVED) return status;
  for (int i = 0; i < NZ; i++) zs[i] = memory[0] != 0.0 ? 2.0 * z[i] - before[i] : z[i];
  if ((status = solve_blocks(end, xs, zs, c, counts, figures)) != SOLVED) return status;
  memory[0] = 1.0;
  for (int i = 0; i < NZ; i++) {
    before[i] = z[i];
    z[i] = zs[i];
  }
  for (int i = 0; i < NX; i++) x[i] = xs[i];
  return SOLVED;
}

/* Counted from the first step of the run, so that no rounding adds up. */
static double time_of(long long step, double part, double start, double interval,
                      long long per_interval) {
  return start + interval * ((double)(step / per_interval) +
                             ((double)(step % per_interval) + part) / (double)per_interval);
}

VD_EXPORT void vd_prepare(const double *p, double *c) { prepare(p, c); }

VD_EXPORT void vd_rates(double t, const double *x, const double *z, const double *c, double *r) {
  rates(&t, x, z, c, r);
}

VD_EXPORT void vd_outputs(double t, const double *x, const double *z, const double *c,
                          double *y) {
  outputs(&t, x, z, c, y);
}

VD_EXPORT void vd_block(int k, double t, const double *x, const double *z, const double *c,
                        double *residual, double *jacobian) {
  block_functions[k](&t, x, z, c, residual, jacobian);
}

/* Largest residual and determinant of each block at some points, one row a point. */
VD_EXPORT void vd_survey(long long n_points, const double *t, const double *xs, const double *zs,
                         const double *c, double *residuals, double *determinants) {
  double residual[NW], jacobian[NW * NW];
  for (long long point = 0; point < n_points; point++)
    for (int k = 0; k < NB; k++) {
      const int n = block_start[k + 1] - block_start[k];
      double largest = 0.0;
      block_functions[k](t + point, xs + point * NX, zs + point * NZ, c, residual, jacobian);
      for (int i = 0; i < n; i++)
        if (!(fabs(residual[i]) <= largest)) largest = fabs(residual[i]);
      *residuals++ = largest;
      *determinants++ = determinant_of(n, jacobian);
    }
}

VD_EXPORT int vd_solve(double t, const double *x, double *z, const double *c,
                       long long *counts, double *figures) {
  return solve_blocks(t, x, z, c, counts, figures);
}

VD_EXPORT void vd_events(double t, const double *x, const double *z, const double *c,
                         double *values) {
  events(&t, x, z, c, values);
}

VD_EXPORT void vd_resets(double t, const double *x, const double *z, const double *c,
                         double *values) {
  resets(&t, x, z, c, values);
}

/* Tell whether an event fires between a point whose signs are in sides and this one; where none
   does, the signs become those of this point. A value of zero lies on no side: an event fires
   when it is reached, and the sign of a value that does not fire there stays. */
static int event_fires(double t, const double *x, const double *z, const double *c, int *sides) {
  double values[NE1];
  events(&t, x, z, c, values);
  for (int k = 0; k < NE; k++) {
    if (sides[k] < 0 && values[k] >= 0.0 && fires_rising[k]) return 1;
    if (sides[k] > 0 && values[k] <= 0.0 && fires_falling[k]) return 1;
  }
  for (int k = 0; k < NE; k++)
    if (values[k] != 0.0) sides[k] = values[k] > 0.0 ? 1 : -1;
  return 0;
}

/* Take the part of a step from one fraction of it to another. */
static int take_step(int method, long long step, double from, double to, long long per_interval,
                     double start, double interval, const double *c, double *x, double *z,
                     double *memory, long long *counts, double *figures) {
  const double part = to - from, h = interval / (double)per_interval * part;
  const double t = time_of(step, from + INSIDE * part, start, interval, per_interval);
  const double middle = time_of(step, from + 0.5 * part, start, interval, per_interval);
  const double end = to < 1.0 ? time_of(step, to, start, interval, per_interval)
                              : time_of(step + 1, 0.0, start, interval, per_interval);
  const double last = time_of(step, to - INSIDE * part, start, interval, per_interval);
  return method == RK4
             ? step_rk4(t, middle, last, end, h, x, z, c, memory, counts, figures)
             : step_symplectic(t, end, h, x, z, c, memory, counts, figures);
}

/* The guesses of the unknowns are not extrapolated into the part, nor from it. */
VD_EXPORT int vd_advance_part(int method, long long step, double from, double to,
                              long long per_interval, double start, double interval,
                              const double *c, double *x, double *z, long long *counts,
                              double *figures) {
  double memory[1 + 2 * NZ1] = {0.0};
  return take_step(method, step, from, to, per_interval, start, interval, c, x, z, memory,
                   counts, figures);
}

/* Take n_steps steps; after each whole interval check the loops and write a sample.
   x and z are consistent on entry and left at the last good step; a step in which an event
   fires is not taken. */
VD_EXPORT int vd_advance(int method, long long first_step, long long n_steps,
                         long long per_interval, double start, double interval,
                         const double *c, double *x, double *z, double *memory, int *sides,
                         double *xs, double *zs, double *ys, long long *counts,
                         double *figures) {
  double held_x[NX1], held_z[NZ1], held_memory[1 + 2 * NZ1];
  for (long long step = first_step; step < first_step + n_steps; step++) {
    const double end = time_of(step + 1, 0.0, start, interval, per_interval);
    if (NE) {
      memcpy(held_x, x, NX * sizeof(double));
      memcpy(held_z, z, NZ * sizeof(double));
      memcpy(held_memory, memory, (1 + 2 * NZ) * sizeof(double));
    }
    int status = take_step(method, step, 0.0, 1.0, per_interval, start, interval, c, x, z,
                           memory, counts, figures);
    if (status != SOLVED) return status;
    if (NE && event_fires(end, x, z, c, sides)) {
      memcpy(x, held_x, NX * sizeof(double));
      memcpy(z, held_z, NZ * sizeof(double));
      memcpy(memory, held_memory, (1 + 2 * NZ) * sizeof(double));
      return EVENT;
    }
    counts[STEPS]++;
    if ((step + 1) % per_interval) continue;
    if ((status = check_residuals(end, x, z, c, counts, figures)) != SOLVED) return status;
    const long long row = counts[SAMPLES];
    memcpy(xs + row * NX, x, NX * sizeof(double));
    memcpy(zs + row * NZ, z, NZ * sizeof(double));
    outputs(&end, x, z, c, ys + row * NY);
    counts[SAMPLES]++;
  }
  return SOLVED;
}
