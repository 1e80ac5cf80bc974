/* Motions from many points with their tangents: classical Runge-Kutta steps, a lane for each point.
   The tangent is that of the step itself. Besides the derivatives by the NPOINT states and the
   parameter it carries the rates at the begin of the step: at its end they must be the rates there,
   whether or not the rates have a kink in between, and by how much they miss them is the error. */

#include <stdlib.h>

#define NBY (NPOINT + 1)
#define NTANGENT (NPOINT + 2)

static const double vd_safety = 0.85, vd_least = 0.1, vd_most = 4.0, vd_shortest = 1e-10;

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

/* Take a step of each lane from one place to the next. */
static void vd_flow_step(const real *c, real h, vd_place_of_flow *at, vd_place_of_flow *next,
                         real *k, real *stage) {
  const real part[3] = {h * 0.5, h * 0.5, h}, sixth = h / 6.0, third = h / 3.0;
  const int n = NROW * NTANGENT;
  real x[NROW], f[NROW], s[NENTRY];
  for (int row = 0; row < NROW; row++) at->y[row * NTANGENT + NBY] = at->f[row];
  vd_carry(at->s, at->y, k);
  vd_ahead(NROW, at->x, sixth, at->f, next->x);
  vd_ahead(n, at->y, sixth, k, next->y);
  vd_ahead(NROW, at->x, part[0], at->f, x);
  vd_ahead(n, at->y, part[0], k, stage);
  for (int number = 1; number < 4; number++) {
    const real weight = number < 3 ? third : sixth;
    evaluate(x, c, f, s);
    vd_carry(s, stage, k);
    vd_ahead(NROW, next->x, weight, f, next->x);
    vd_ahead(n, next->y, weight, k, next->y);
    if (number == 3) break;
    vd_ahead(NROW, at->x, part[number], f, x);
    vd_ahead(n, at->y, part[number], k, stage);
  }
  evaluate(next->x, c, next->f, next->s);
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
  real *work = malloc(2 * NROW * NTANGENT * sizeof(real) + 64);
  if (!room || !work) {
    free(room);
    free(work);
    return count;
  }
  vd_place_of_flow *at = (void *)(((size_t)room + 63) / 64 * 64), *next = at + 1;
  real *k = (void *)(((size_t)work + 63) / 64 * 64), *stage = k + NROW * NTANGENT;
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
      vd_flow_step(c, h, at, next, k, stage);
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
        const double error = missed / fmax(size, DBL_MIN);
        const int finite = isfinite(error), short_one = step[lane] <= vd_shortest * durations[own];
        if (finite && (error <= tolerance || short_one)) {
          left[lane] = step[lane] >= left[lane] ? 0.0 : left[lane] - step[lane];
          worst[lane] = fmax(worst[lane], error);
        } else {
          taken_as[lane] = 0.0;
          if (short_one) left[lane] = -1.0; /* No number: it ends here. */
        }
        const double factor =
            finite ? vd_safety * pow(fmax(error / tolerance, 1e-6), -0.25) : vd_least;
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
