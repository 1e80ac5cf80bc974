/* What a kernel of one lane offers: its functions, solving the blocks, events, and runs with
   samples at equal intervals.
   interpreted.py holds the same algorithm; change both together. */

enum { SAMPLES, STEPS, EVALUATIONS, ITERATIONS, WHERE };
enum { LARGEST_RESIDUAL, FAILED_RESIDUAL };

/* Enter what a course came to and return its status. */
static int settle(const struct course *course, long long *counts, double *figures) {
  counts[EVALUATIONS] += course->evaluations;
  counts[ITERATIONS] += course->iterations;
  if (course->largest_residual > figures[LARGEST_RESIDUAL])
    figures[LARGEST_RESIDUAL] = course->largest_residual;
  if (course->status[0] != SOLVED) {
    counts[WHERE] = course->where[0];
    figures[FAILED_RESIDUAL] = course->failed_residual[0];
  }
  return course->status[0];
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

/* Behind the constants and the rows of tables lie vd_copies numbers for fours.h. */
VD_EXPORT void vd_prepare(const double *p, double *c) {
  prepare(p, c);
  lay_out(c);
}

VD_EXPORT void vd_rates(double t, const double *x, const double *z, const double *c, double *r) {
  rates(&t, x, z, c, r);
}

VD_EXPORT void vd_outputs(double t, const double *x, const double *z, const double *c,
                          double *y) {
  outputs(&t, x, z, c, y);
}

VD_EXPORT void vd_block(int k, double t, const double *x, const double *z, const double *c,
                        double *residual, double *jacobian) {
  evaluate_block(k, &t, x, z, c, residual, jacobian);
}

/* Largest residual and determinant of each block at some points, one row a point. */
VD_EXPORT void vd_survey(long long n_points, const double *t, const double *xs, const double *zs,
                         const double *c, double *residuals, double *determinants) {
  double residual[NW], jacobian[NW * NW];
  for (long long point = 0; point < n_points; point++)
    for (int k = 0; k < NB; k++) {
      const int n = block_start[k + 1] - block_start[k];
      double largest = 0.0;
      evaluate_block(k, t + point, xs + point * NX, zs + point * NZ, c, residual, jacobian);
      for (int i = 0; i < n; i++)
        if (!(fabs(residual[i]) <= largest)) largest = fabs(residual[i]);
      *residuals++ = largest;
      *determinants++ = determinant_of(n, jacobian);
    }
}

VD_EXPORT int vd_solve(double t, const double *x, double *z, const double *c,
                       long long *counts, double *figures) {
  struct course course;
  begin_course(&course);
  solve_blocks(t, x, z, c, &course);
  return settle(&course, counts, figures);
}

VD_EXPORT void vd_events(double t, const double *x, const double *z, const double *c,
                         double *values) {
  events(&t, x, z, c, values);
}

VD_EXPORT void vd_resets(double t, const double *x, const double *z, const double *c,
                         double *values) {
  resets(&t, x, z, c, values);
}

/* The guesses of the unknowns are not extrapolated into the part, nor from it. */
VD_EXPORT int vd_advance_part(int method, long long step, double from, double to,
                              long long per_interval, double start, double interval,
                              const double *c, double *x, double *z, long long *counts,
                              double *figures) {
  const struct march march = begin_march(method, per_interval, start, interval);
  double memory[1 + 2 * NZ1] = {0.0};
  struct course course;
  begin_course(&course);
  take_step(&march, step, from, to, c, x, z, memory, &course);
  return settle(&course, counts, figures);
}

/* Take n_steps steps; after each whole interval check the loops and write a sample.
   x and z are consistent on entry and left at the last good step; a step in which an event
   fires is not taken. */
VD_EXPORT int vd_advance(int method, long long first_step, long long n_steps,
                         long long per_interval, double start, double interval,
                         const double *c, double *x, double *z, double *memory, int *sides,
                         double *xs, double *zs, double *ys, long long *counts,
                         double *figures) {
  const struct march march = begin_march(method, per_interval, start, interval);
  double held_x[NX1], held_z[NZ1], held_memory[1 + 2 * NZ1];
  struct course course;
  begin_course(&course);
  for (long long step = first_step; step < first_step + n_steps; step++) {
    const double end = time_of(step + 1, 0.0, start, interval, per_interval);
    if (NE) {
      memcpy(held_x, x, NX * sizeof(double));
      memcpy(held_z, z, NZ * sizeof(double));
      memcpy(held_memory, memory, (1 + 2 * NZ) * sizeof(double));
    }
    take_step(&march, step, 0.0, 1.0, c, x, z, memory, &course);
    if (!course.alive) break;
    if (NE && event_fires(end, x, z, c, sides)) {
      memcpy(x, held_x, NX * sizeof(double));
      memcpy(z, held_z, NZ * sizeof(double));
      memcpy(memory, held_memory, (1 + 2 * NZ) * sizeof(double));
      course.status[0] = EVENT;
      break;
    }
    counts[STEPS]++;
    if ((step + 1) % per_interval) continue;
    check_residuals(end, x, z, c, &course);
    if (!course.alive) break;
    const long long row = counts[SAMPLES];
    memcpy(xs + row * NX, x, NX * sizeof(double));
    memcpy(zs + row * NZ, z, NZ * sizeof(double));
    outputs(&end, x, z, c, ys + row * NY);
    counts[SAMPLES]++;
  }
  return settle(&course, counts, figures);
}
