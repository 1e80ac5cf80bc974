/* Values of functions at many points, and their slopes: a lane for each point and direction.
   There are NPOINT variables of a point, NROW values and NDIRECTION directions, none where only
   values are wanted. */

#define NJOB (NDIRECTION ? NDIRECTION : 1)

/* points (count, NPOINT), values (count, NROW), slopes (count, NDIRECTION, NROW); p holds the
   parameters and the rows of the tables. */
VD_EXPORT void vd_points(long long count, const double *points, const double *p, double *values,
                         double *slopes) {
  real given[NP + NT + 1], c[NC + NT + 1], point[NPOINT], v[NROW];
#if NDIRECTION
  real direction[NDIRECTION], s[NROW];
#endif
  vd_spread(NP + NT, p, given);
  prepare(given, c);
  vd_spread(NT, p + NP, c + NC);
  const long long jobs = count * NJOB;
  for (long long first = 0; first < jobs; first += VD_LANES) {
    for (int lane = 0; lane < VD_LANES; lane++) {
      const long long job = first + lane < jobs ? first + lane : jobs - 1;
      const double *own = points + job / NJOB * NPOINT;
      for (int k = 0; k < NPOINT; k++) ((double *)(point + k))[lane] = own[k];
#if NDIRECTION
      for (int k = 0; k < NDIRECTION; k++)
        ((double *)(direction + k))[lane] = k == job % NDIRECTION;
#endif
    }
#if NDIRECTION
    evaluate(point, direction, c, v, s);
#else
    evaluate(point, c, v);
#endif
    for (int lane = 0; lane < VD_LANES && first + lane < jobs; lane++) {
      const long long job = first + lane;
      if (job % NJOB == 0)
        for (int k = 0; k < NROW; k++) values[job / NJOB * NROW + k] = VD_LANE(v[k], lane);
#if NDIRECTION
      for (int k = 0; k < NROW; k++) slopes[job * NROW + k] = VD_LANE(s[k], lane);
#endif
    }
  }
}
