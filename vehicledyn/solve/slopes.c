/* Values and slopes of functions at many points: a lane for each point and direction. NPOINT
   variables and the free parameter make NPOINT + 1 directions, NROW values are differentiated. */

/* Put numbers into all lanes as they are, addresses too. */
static void spread(int n, const double *a, real *r) {
  for (int k = 0; k < n; k++)
    for (int lane = 0; lane < VD_LANES; lane++) ((double *)(r + k))[lane] = a[k];
}

/* points (count, NPOINT), values (count, NROW), slopes (count, NPOINT + 1, NROW); p holds the
   parameters and the rows of the tables. */
VD_EXPORT void vd_slopes(long long count, const double *points, const double *p, double *values,
                         double *slopes) {
  enum { DIRECTIONS = NPOINT + 1 };
  real given[NP + NT + 1], c[NC + NT + 1], point[NPOINT], direction[DIRECTIONS], v[NROW], s[NROW];
  spread(NP + NT, p, given);
  prepare(given, c);
  spread(NT, p + NP, c + NC);
  const long long jobs = count * DIRECTIONS;
  for (long long first = 0; first < jobs; first += VD_LANES) {
    for (int lane = 0; lane < VD_LANES; lane++) {
      const long long job = first + lane < jobs ? first + lane : jobs - 1;
      const double *own = points + job / DIRECTIONS * NPOINT;
      for (int k = 0; k < NPOINT; k++) ((double *)(point + k))[lane] = own[k];
      for (int k = 0; k < DIRECTIONS; k++)
        ((double *)(direction + k))[lane] = k == job % DIRECTIONS;
    }
    evaluate(point, direction, c, v, s);
    for (int lane = 0; lane < VD_LANES && first + lane < jobs; lane++) {
      const long long job = first + lane;
      for (int k = 0; k < NROW; k++) {
        slopes[job * NROW + k] = VD_LANE(s[k], lane);
        if (job % DIRECTIONS == 0) values[job / DIRECTIONS * NROW + k] = VD_LANE(v[k], lane);
      }
    }
  }
}
