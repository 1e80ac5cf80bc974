/* Values of functions at many points, and their slopes: a lane for each point and direction, or
   for each point where the NENTRY elements of the Jacobian that are not zero come together.
   There are NPOINT variables of a point, NROW values and NDIRECTION directions, none where only
   values are wanted. */

#define BY_DIRECTION (NDIRECTION && !NENTRY)
#define NJOB (BY_DIRECTION ? NDIRECTION : 1)

/* points (count, NPOINT), values (count, NROW), slopes (count, NDIRECTION, NROW); p holds the
   parameters and the rows of the tables. */
VD_EXPORT void vd_points(long long count, const double *points, const double *p, double *values,
                         double *slopes) {
  real given[NP + NT + 1], c[NC + NT + 1], point[NPOINT], v[NROW];
#if BY_DIRECTION
  real direction[NDIRECTION], s[NROW];
#elif NENTRY
  real s[NENTRY];
  for (long long k = 0; k < count * NDIRECTION * NROW; k++) slopes[k] = 0.0;
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
#if BY_DIRECTION
      for (int k = 0; k < NDIRECTION; k++)
        ((double *)(direction + k))[lane] = k == job % NDIRECTION;
#endif
    }
#if BY_DIRECTION
    evaluate(point, direction, c, v, s);
#elif NENTRY
    evaluate(point, c, v, s);
#else
    evaluate(point, c, v);
#endif
    for (int lane = 0; lane < VD_LANES && first + lane < jobs; lane++) {
      const long long job = first + lane;
      if (job % NJOB == 0)
        for (int k = 0; k < NROW; k++) values[job / NJOB * NROW + k] = VD_LANE(v[k], lane);
#if BY_DIRECTION
      for (int k = 0; k < NROW; k++) slopes[job * NROW + k] = VD_LANE(s[k], lane);
#elif NENTRY
      for (int k = 0; k < NENTRY; k++)
        slopes[job * NDIRECTION * NROW + place[k]] = VD_LANE(s[k], lane);
#endif
    }
  }
}
