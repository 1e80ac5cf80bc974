/* A motion from one point through a row of moments, by the pair of Dormand and Prince (1980). */
#include <stdlib.h>

#define NSTAGE 7
static const double vd_weights[NSTAGE - 1][NSTAGE - 1] = {
    {1.0 / 5.0},
    {3.0 / 40.0, 9.0 / 40.0},
    {44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0},
    {19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0},
    {9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0},
    {35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0},
};
static const double vd_missing[NSTAGE] = {71.0 / 57600.0,      0.0,          -71.0 / 16695.0,
                                          71.0 / 1920.0,       -17253.0 / 339200.0,
                                          22.0 / 525.0,        -1.0 / 40.0};

/* begin and scales (NPOINT,), durations (count,); errors are at most the tolerance times the scales
   in a step. nodes and rates (room + 1, NPOINT) and sizes (room,) are those of the steps taken,
   steps (count,) how many end in each duration. Returns how many durations are left after so many
   trials of a step, or where the room is full. */
VD_EXPORT long long vd_march(long long count, const double *begin, const double *p,
                             const double *durations, const double *scales, double tolerance,
                             long long trials, long long room, double *nodes, double *rates,
                             double *sizes, long long *steps) {
  double given[NP + NT + 1], c[NC + NT + 1], x[NROW], next[NROW], f[NSTAGE][NROW];
  memcpy(given, p, (NP + NT) * sizeof(double));
  prepare(given, c);
  memcpy(c + NC, p + NP, NT * sizeof(double));
  memcpy(x, begin, sizeof x);
  evaluate(x, c, f[0]);
  memcpy(nodes, x, sizeof x);
  memcpy(rates, f[0], sizeof x);
  double step = 0.25 * durations[0], left = durations[0];
  long long done = 0, taken = 0;
  for (long long k = 0; k < count; k++) steps[k] = 0;
  for (long long trial = 0; trial < trials && taken < room && done < count; trial++) {
    const double h = step < left ? step : left;
    for (int number = 0; number < NSTAGE - 1; number++) {
      for (int k = 0; k < NROW; k++) {
        double sum = 0.0;
        for (int j = 0; j <= number; j++) sum += vd_weights[number][j] * f[j][k];
        next[k] = x[k] + h * sum;
      }
      evaluate(next, c, f[number + 1]);
    }
    double error = 0.0;
    for (int k = 0; k < NROW; k++) {
      double sum = 0.0;
      for (int j = 0; j < NSTAGE; j++) sum += vd_missing[j] * f[j][k];
      const double own = fabs(h * sum) / scales[k];
      error = isfinite(own) ? fmax(error, own) : INFINITY;
    }
    const double factor = isfinite(error) ? 0.9 * pow(fmax(error / tolerance, 1e-6), -0.2) : 0.1;
    const double next_step = h * fmin(fmax(factor, 0.1), 5.0);
    if (!(error <= tolerance)) {
      step = next_step;
      continue;
    }
    if (h < left || next_step < step) step = next_step;
    memcpy(x, next, sizeof x);
    memcpy(f[0], f[NSTAGE - 1], sizeof f[0]);
    sizes[taken++] = h;
    memcpy(nodes + taken * NROW, x, sizeof x);
    memcpy(rates + taken * NROW, f[0], sizeof x);
    steps[done] += 1;
    left -= h;
    if (left <= 0.0) {
      done += 1;
      if (done < count) left = durations[done];
    }
  }
  return count - done;
}
