/* Points of a motion with their derivatives as weights of linear programs, for one case.
   The generated part defines NU weights of its own and NI entries of inverses. */

VD_EXPORT void vd_prepare(const double *p, double *c) {
  prepare(p, c);
  lay_out(c);
}

/* Solve the unknowns from the guess in z where this is asked for. */
VD_EXPORT int vd_solve_point(double t, const double *x, double *z, const double *c) {
  struct course course;
  begin_course(&course);
  check_finite(x, &course);
  if (course.alive) solve_blocks(t, x, z, c, &course);
  return course.status[0];
}

/* Rates and weights at a point whose unknowns are solved. */
VD_EXPORT int vd_linearise(double t, const double *x, const double *z, const double *c,
                           double *rate, double *w) {
  double jacobian[NI + 1], square[NW * NW], unit[NW];
  const double *own = jacobian;
  double *inverse = w + NU;
  linearise(&t, x, z, c, rate, w, jacobian);
  for (int k = 0; k < NB; k++) {
    const int n = block_start[k + 1] - block_start[k];
    for (int j = 0; j < n; j++) {
      memcpy(square, own, n * n * sizeof(double));
      for (int i = 0; i < n; i++) unit[i] = i == j ? -1.0 : 0.0;
      if (!solve_linear(n, square, unit)) return SINGULAR;
      memcpy(inverse + j * n, unit, n * sizeof(double));
    }
    own += n * n;
    inverse += n * n;
  }
  return SOLVED;
}

VD_EXPORT void vd_observe(double t, const double *x, const double *z, const double *c,
                          double *values, double *w) {
  observe(&t, x, z, c, values, w);
}
