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

/* Numbers of a point in packs of eight; what is left of the last one stays zero. */
#define NPACK ((NROW + 7) / 8)
typedef union {
  vd_eight pack[NPACK];
  double each[8 * NPACK];
} vd_column;

/* out = x + h (weights · rates) of the first `count` rates. */
static void vd_weighted(const vd_column *x, double h, const double *weights, int count,
                        const vd_column *rates, vd_column *out) {
  for (int k = 0; k < NPACK; k++) {
    vd_eight sum = {0.0};
    for (int j = 0; j < count; j++) sum += weights[j] * rates[j].pack[k];
    out->pack[k] = x->pack[k] + h * sum;
  }
}

/* The largest of the numbers over their sizes; infinite where one is none. */
static double vd_worst(const vd_column *numbers, const vd_column *sizes) {
  vd_column parts;
  vd_eight total = {0.0};
  double worst = 0.0, sum = 0.0;
  for (int k = 0; k < NPACK; k++) {
    parts.pack[k] = numbers->pack[k] / sizes->pack[k];
    total += parts.pack[k] * 0.0;
  }
  for (int k = 0; k < 8; k++) sum += total[k];
  if (!(sum == 0.0)) return INFINITY;
  for (int k = 0; k < NROW; k++) {
    const double own = fabs(parts.each[k]);
    if (own > worst) worst = own;
  }
  return worst;
}

/* begin and scales (NPOINT,), durations (count,); errors are at most the tolerance times the scales
   in a step. nodes and rates (room + 1, NPOINT) and sizes (room,) are those of the steps taken,
   steps (count,) how many end in each duration. Returns how many durations are left after so many
   trials of a step, or where the room is full. */
VD_EXPORT long long vd_march(long long count, const double *begin, const double *p,
                             const double *durations, const double *scales, double tolerance,
                             long long trials, long long room, double *nodes, double *rates,
                             double *sizes, long long *steps) {
  static const vd_column none;
  double given[NP + NT + 1], c[NC + NT + 1];
  vd_column x = none, next = none, missed, sizes_of, f[NSTAGE];
  for (int k = 0; k < NSTAGE; k++) f[k] = none;
  for (int k = 0; k < 8 * NPACK; k++) sizes_of.each[k] = k < NROW ? scales[k] : 1.0;
  memcpy(given, p, (NP + NT) * sizeof(double));
  prepare(given, c);
  memcpy(c + NC, p + NP, NT * sizeof(double));
  memcpy(x.each, begin, NROW * sizeof(double));
  evaluate(x.each, c, f[0].each);
  memcpy(nodes, x.each, NROW * sizeof(double));
  memcpy(rates, f[0].each, NROW * sizeof(double));
  double step = 0.25 * durations[0], left = durations[0];
  long long done = 0, taken = 0;
  for (long long k = 0; k < count; k++) steps[k] = 0;
  for (long long trial = 0; trial < trials && taken < room && done < count; trial++) {
    const double h = step < left ? step : left;
    for (int number = 0; number < NSTAGE - 1; number++) {
      vd_weighted(&x, h, vd_weights[number], number + 1, f, &next);
      evaluate(next.each, c, f[number + 1].each);
    }
    vd_weighted(&none, h, vd_missing, NSTAGE, f, &missed);
    const double error = vd_worst(&missed, &sizes_of);
    const double factor = isfinite(error) ? 0.9 * pow(fmax(error / tolerance, 1e-6), -0.2) : 0.1;
    const double next_step = h * fmin(fmax(factor, 0.1), 5.0);
    if (!(error <= tolerance)) {
      step = next_step;
      continue;
    }
    if (h < left || next_step < step) step = next_step;
    x = next;
    f[0] = f[NSTAGE - 1];
    sizes[taken++] = h;
    memcpy(nodes + taken * NROW, x.each, NROW * sizeof(double));
    memcpy(rates + taken * NROW, f[0].each, NROW * sizeof(double));
    steps[done] += 1;
    left -= h;
    if (left <= 0.0) {
      done += 1;
      if (done < count) left = durations[done];
    }
  }
  return count - done;
}
