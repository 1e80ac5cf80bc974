/* Motions from many points with their tangents: a lane for each point, by steps of order five.
   The tangent is that of the step itself. Besides the derivatives by the NPOINT states and the
   parameter it carries the rates at the begin of the step: at its end they must be the rates there,
   whether or not the rates have a kink in between, and by how much they miss them is the error.
   Motions that decay fast do not show there: the tangents of all states have an embedded error
   besides, coarse, without which steps would become too long to be stable. */

#include <stdlib.h>

#define NBY (NPOINT + 1)
#define NTANGENT (NPOINT + 2)

/* Error allowed of the tangents of a step, part of the largest. */
static const double vd_coarse = 0.02;
static const double vd_safety = 0.85, vd_least = 0.02, vd_most = 4.0, vd_shortest = 1e-10,
                    vd_kink = 100.0;

/* out = J tangent, and the derivatives by the parameter where those are carried. */
static void vd_carry(const real *s, const real *tangent, real *out) {
  const real zero = vd_all(0.0);
  for (int k = 0; k < NROW * NTANGENT; k++) out[k] = zero;
  for (int k = 0; k < NENTRY; k++) {
    const int row = place[k] % NROW, column = place[k] / NROW;
    real *to = out + row * NTANGENT;
    if (column == NPOINT) {
      to[NPOINT] = to[NPOINT] + s[k];
      continue;
    }
    const real a = s[k], *from = tangent + column * NTANGENT;
    for (int j = 0; j < NTANGENT; j++) to[j] = vd_fma(a, from[j], to[j]);
  }
}

/* out = a + h b for n numbers. */
VD_INLINE void vd_ahead(int n, const real *a, real h, const real *b, real *out) {
  for (int k = 0; k < n; k++) out[k] = vd_fma(h, b[k], a[k]);
}

typedef struct {
  real x[NROW], f[NROW], s[NENTRY], y[NROW * NTANGENT];
} vd_place_of_flow;

/* Dormand and Prince (1980): weights of the stages before, the last row those of the step. */
#define NSTAGE 6
static const double vd_weights[NSTAGE][NSTAGE] = {
    {1.0 / 5.0},
    {3.0 / 40.0, 9.0 / 40.0},
    {44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0},
    {19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0},
    {9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0},
    {35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0},
};

/* How they differ from those of order four, the end of the step being the last stage. */
static const double vd_differences[NSTAGE + 1] = {
    71.0 / 57600.0,      0.0,           -71.0 / 16695.0, 71.0 / 1920.0,
    -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0,
};

/* Take a step of each lane from one place to the next. The tangents of the stages have room in
   work, that of the point where rates are asked for behind them; there the errors of the tangents
   are left. */
static void vd_flow_step(const real *c, real h, vd_place_of_flow *at, vd_place_of_flow *next,
                         real *work) {
  const int n = NROW * NTANGENT;
  real f[NSTAGE][NROW], s[NENTRY], x[NROW], *stage = work + NSTAGE * n;
  for (int row = 0; row < NROW; row++) at->y[row * NTANGENT + NBY] = at->f[row];
  memcpy(f[0], at->f, sizeof at->f);
  vd_carry(at->s, at->y, work);
  for (int number = 0; number < NSTAGE; number++) {
    const int last = number == NSTAGE - 1;
    real *to = last ? next->x : x, *tangent = last ? next->y : stage;
    memcpy(to, at->x, sizeof at->x);
    memcpy(tangent, at->y, sizeof at->y);
    for (int k = 0; k <= number; k++) {
      if (vd_weights[number][k] == 0.0) continue;
      const real part = h * vd_weights[number][k];
      vd_ahead(NROW, to, part, f[k], to);
      vd_ahead(n, tangent, part, work + k * n, tangent);
    }
    if (last) break;
    evaluate(x, c, f[number + 1], s);
    vd_carry(s, stage, work + (number + 1) * n);
  }
  evaluate(next->x, c, next->f, next->s);
  vd_carry(next->s, next->y, stage);
  for (int j = 0; j < n; j++) stage[j] = stage[j] * (h * vd_differences[NSTAGE]);
  for (int k = 0; k < NSTAGE; k++)
    if (vd_differences[k] != 0.0) vd_ahead(n, stage, h * vd_differences[k], work + k * n, stage);
}

/* The largest of the tangents by the states, scaled, at least as large as given. */
static real vd_largest(const real *tangent, const double *scales, double least) {
  real largest = vd_all(least);
  for (int row = 0; row < NROW; row++)
    for (int j = 0; j < NPOINT; j++) {
      const real size = vd_abs(tangent[row * NTANGENT + j]) * (scales[j] / scales[row]);
      largest = vd_select(vd_le(size, largest), largest, size);
    }
  return largest;
}

/* Put n numbers of some lanes in place of others. */
static void vd_take(int n, vd_mask taken, const real *from, real *to) {
  for (int k = 0; k < n; k++) to[k] = vd_select(taken, from[k], to[k]);
}

/* points and ends (count, NPOINT), durations (count,), scales (NPOINT,), first and last rates
   (count, NPOINT), maps (count, NPOINT, NBY), errors (count,); returns how many points are not at
   the end of their duration after so many trials of a step. */
VD_EXPORT long long vd_flow(long long count, const double *points, const double *p,
                            const double *durations, const double *scales, double tolerance,
                            long long trials, double *ends, double *maps, double *first,
                            double *last, double *errors) {
  real given[NP + NT + 1], c[NC + NT + 1], h;
  vd_place_of_flow *room = malloc(2 * sizeof(vd_place_of_flow) + 64);
  real *work = malloc((NSTAGE + 1) * NROW * NTANGENT * sizeof(real) + 64);
  if (!room || !work) {
    free(room);
    free(work);
    return count;
  }
  vd_place_of_flow *at = (void *)(((size_t)room + 63) / 64 * 64), *next = at + 1;
  real *k = (void *)(((size_t)work + 63) / 64 * 64);
  long long open = 0;
  vd_spread(NP + NT, p, given);
  prepare(given, c);
  vd_spread(NT, p + NP, c + NC);
  for (long long group = 0; group < count; group += VD_LANES) {
    double left[VD_LANES], step[VD_LANES], worst[VD_LANES];
    const real zero = vd_all(0.0);
    for (int j = 0; j < NROW * NTANGENT; j++) at->y[j] = zero;
    for (int row = 0; row < NROW; row++) at->y[row * NTANGENT + row] = vd_all(1.0);
    for (int lane = 0; lane < VD_LANES; lane++) {
      const long long own = group + lane < count ? group + lane : count - 1;
      for (int row = 0; row < NROW; row++)
        ((double *)(at->x + row))[lane] = points[own * NROW + row];
      left[lane] = group + lane < count ? durations[own] : 0.0;
      step[lane] = 0.25 * left[lane];
      worst[lane] = 0.0;
    }
    evaluate(at->x, c, at->f, at->s);
    for (int lane = 0; lane < VD_LANES && group + lane < count; lane++)
      for (int row = 0; row < NROW; row++)
        first[(group + lane) * NROW + row] = ((double *)(at->f + row))[lane];
    long long trial = 0;
    for (int going = 1; going && trial < trials; trial++) {
      double taken_as[VD_LANES];
      for (int lane = 0; lane < VD_LANES; lane++) {
        step[lane] = fmin(step[lane], left[lane]);
        ((double *)&h)[lane] = step[lane];
      }
      vd_flow_step(c, h, at, next, k);
      const real spread = vd_largest(k + NSTAGE * NROW * NTANGENT, scales, 0.0);
      const real whole = vd_largest(next->y, scales, 1.0);
      going = 0;
      for (int lane = 0; lane < VD_LANES; lane++) {
        double missed = 0.0, size = 0.0;
        for (int row = 0; row < NROW; row++) {
          const double rate = ((double *)(next->f + row))[lane] / scales[row];
          const double carried =
              ((double *)(next->y + row * NTANGENT + NBY))[lane] / scales[row];
          missed = fmax(missed, isfinite(carried) ? fabs(carried - rate) : INFINITY);
          size = fmax(size, fabs(rate));
          if (!isfinite(rate)) missed = INFINITY;
        }
        taken_as[lane] = 1.0;
        if (left[lane] <= 0.0) continue;
        const long long own = group + lane;
        const double own_error = missed / fmax(size, DBL_MIN);
        const double coarse = VD_LANE(spread, lane) / (vd_coarse * VD_LANE(whole, lane));
        const double error = fmax(own_error, isfinite(coarse) ? coarse * tolerance : INFINITY);
        const int finite = isfinite(error), short_one = step[lane] <= vd_shortest * durations[own];
        if (finite && (error <= tolerance || short_one)) {
          left[lane] = step[lane] >= left[lane] ? 0.0 : left[lane] - step[lane];
          worst[lane] = fmax(worst[lane], own_error);
        } else {
          taken_as[lane] = 0.0;
          if (short_one) left[lane] = -1.0; /* No number: it ends here. */
        }
        /* An error that large is that of a kink, and falls with the step itself. */
        const double part = error / tolerance, power = part > vd_kink ? -0.5 : -0.2;
        const double factor = finite ? vd_safety * pow(fmax(part, 1e-6), power) : vd_least;
        step[lane] *= fmin(fmax(factor, vd_least), vd_most);
        if (left[lane] > 0.0) going = 1;
      }
      real flags;
      for (int lane = 0; lane < VD_LANES; lane++) ((double *)&flags)[lane] = taken_as[lane];
      const vd_mask taken = vd_true(flags);
      vd_take(NROW, taken, next->x, at->x);
      vd_take(NROW, taken, next->f, at->f);
      vd_take(NENTRY, taken, next->s, at->s);
      vd_take(NROW * NTANGENT, taken, next->y, at->y);
    }
    for (int lane = 0; lane < VD_LANES && group + lane < count; lane++) {
      const long long own = group + lane;
      open += left[lane] != 0.0;
      errors[own] = worst[lane];
      for (int row = 0; row < NROW; row++) {
        ends[own * NROW + row] = ((double *)(at->x + row))[lane];
        last[own * NROW + row] = ((double *)(at->f + row))[lane];
        for (int j = 0; j < NBY; j++)
          maps[(own * NROW + row) * NBY + j] = ((double *)(at->y + row * NTANGENT + j))[lane];
      }
    }
  }
  free(room);
  free(work);
  return open;
}
