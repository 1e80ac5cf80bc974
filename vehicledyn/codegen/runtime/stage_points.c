/* Points of a motion with fixed steps at which derivatives are wanted, for one case. */

enum { VD_STAGES = 4 };

VD_EXPORT void vd_prepare(const double *p, double *c) {
  prepare(p, c);
  lay_out(c);
}

/* Solve the unknowns from the guess in z. */
VD_EXPORT int vd_solve_point(double t, const double *x, double *z, const double *c) {
  struct course course;
  begin_course(&course);
  check_finite(x, &course);
  if (course.alive) solve_blocks(t, x, z, c, &course);
  return course.status[0];
}

/* Minus the inverse of the Jacobian of a block, by columns. */
int vd_inverse(int n, const double *jacobian, double *inverse) {
  double square[NW * NW], unit[NW];
  for (int j = 0; j < n; j++) {
    memcpy(square, jacobian, n * n * sizeof(double));
    for (int i = 0; i < n; i++) unit[i] = i == j ? -1.0 : 0.0;
    if (!solve_linear(n, square, unit)) return SINGULAR;
    memcpy(inverse + j * n, unit, n * sizeof(double));
  }
  return SOLVED;
}

/* Tell how a step ends: with an event where the signs in sides are watched, or inaccurate where an
   interval ends. */
int vd_end_of_step(double t, const double *x, const double *z, const double *c, int *sides,
                   int is_sample) {
  struct course course;
  if (sides && NE && event_fires(t, x, z, c, sides)) return EVENT;
  begin_course(&course);
  if (is_sample) check_residuals(t, x, z, c, &course);
  return course.status[0];
}

void vd_rates_at(double t, const double *x, const double *z, const double *c, double *rate) {
  rates(&t, x, z, c, rate);
}

/* A stage: its unknowns, solved from the guess in z, and its rates. */
static int enter_stage(double t, const double *x, double *z, const double *c, double *rate) {
  const int status = vd_solve_point(t, x, z, c);
  if (!status) rates(&t, x, z, c, rate);
  return status;
}

/* A step: states, unknowns and rates of its stages, in rows, and the point behind it in x and z.
   The guesses of the unknowns are those of steps.c, kept in memory. */
int vd_stage_points(int method, const double *times, double h, const double *c, double *x,
                    double *z, double *memory, double *xs, double *zs, double *ks) {
  const double known = memory[0];
  double *before = memory + 1, *between = memory + 1 + NZ;
  memcpy(xs, x, NX * sizeof(double));
  memcpy(zs, z, NZ * sizeof(double));
  rates(times, x, z, c, ks);
  if (method == SYMPLECTIC_EULER) {
    for (int i = 0; i < NX; i++) x[i] += h * ks[i];
    for (int i = 0; i < NQ; i++) x[positions[i]] = xs[positions[i]] + h * x[velocities[i]];
    return vd_solve_point(times[VD_STAGES], x, z, c);
  }
  const double *first = zs;
  double *x1 = xs + NX, *x2 = x1 + NX, *x3 = x2 + NX, *z1 = zs + NZ, *z2 = z1 + NZ, *z3 = z2 + NZ;
  const double *k0 = ks, *k1 = ks + NX, *k2 = k1 + NX, *k3 = k2 + NX;
  for (int i = 0; i < NZ; i++)
    z1[i] = first[i] + known * 0.5 * (3.0 * first[i] - 4.0 * between[i] + before[i]);
  for (int i = 0; i < NX; i++) x1[i] = x[i] + 0.5 * h * k0[i];
  int status = enter_stage(times[1], x1, z1, c, ks + NX);
  if (status) return status;
  for (int i = 0; i < NZ; i++) z2[i] = z1[i] + known * (first[i] - 2.0 * between[i] + before[i]);
  for (int i = 0; i < NX; i++) x2[i] = x[i] + 0.5 * h * k1[i];
  status = enter_stage(times[2], x2, z2, c, ks + 2 * NX);
  if (status) return status;
  for (int i = 0; i < NZ; i++) z3[i] = 2.0 * z2[i] - first[i];
  for (int i = 0; i < NX; i++) x3[i] = x[i] + h * k2[i];
  status = enter_stage(times[3], x3, z3, c, ks + 3 * NX);
  if (status) return status;
  memory[0] = 1.0;
  for (int i = 0; i < NZ; i++) {
    before[i] = first[i];
    between[i] = 0.5 * (z1[i] + z2[i]);
    z[i] = z3[i];
  }
  for (int i = 0; i < NX; i++)
    x[i] += h / 6.0 * (k0[i] + 2.0 * k1[i] + 2.0 * k2[i] + k3[i]);
  return vd_solve_point(times[VD_STAGES], x, z, c);
}
