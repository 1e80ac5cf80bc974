/* Derivatives at several points side by side, a lane for each.
   A program has columns: sources, then rows, each a sum of weights times columns before it. A plan
   holds the rows of a program that lead from some sources to its results, for eight or four
   directions at once where it goes ahead, and for one where it goes back. */

#include <stdlib.h>

struct program {
  long long n_rows, n_columns, n_targets;
  const int *out, *starts, *columns, *which, *targets;
};

/* Places for values that rows hand on; one is used again once its value is needed no more. */
struct places {
  int n_free, n, *of, *open;
};

static int take_place(struct places *p) { return p->n_free ? p->open[--p->n_free] : p->n++; }

/* Write the plan: numbers of rows and places, then for each row its place and its result, -1 for
   none, the number of sources and of rows that it adds up, and these as pairs of a weight and a
   source or a place. bits (n_columns) say which directions move the sources; found (n_targets) are
   the directions that move the results, and number them in order, -1 for none. Returns the length,
   or zero without memory. */
VD_EXPORT long long vd_plan(const struct program *p, unsigned char *bits, int *plan, int *number,
                            unsigned char *found) {
  const long long n = p->n_columns;
  int *room = malloc((5 * n + 1) * sizeof(int)), *next = plan + 2;
  if (!room) return 0;
  int *last = room, *result = room + n, *row_of = room + 2 * n;
  struct places places = {0, 0, room + 3 * n, room + 4 * n};
  for (long long i = 0; i < n; i++) last[i] = -1, result[i] = -1, row_of[i] = 0;
  for (long long k = 0; k < p->n_rows; k++) {
    unsigned char own = 0;
    for (int i = p->starts[k]; i < p->starts[k + 1]; i++) own |= bits[p->columns[i]];
    bits[p->out[k]] = own;
    row_of[p->out[k]] = 1;
  }
  for (long long k = 0; k < p->n_targets; k++) {
    result[p->targets[k]] = (int)k;
    found[k] = bits[p->targets[k]];
    number[k] = -1;
  }
  for (long long k = p->n_rows - 1; k >= 0; k--) {
    const int out = p->out[k];
    if (!bits[out] || (last[out] < 0 && result[out] < 0)) continue;
    for (int i = p->starts[k]; i < p->starts[k + 1]; i++)
      if (bits[p->columns[i]] && last[p->columns[i]] < k) last[p->columns[i]] = (int)k;
  }
  int n_rows = 0, n_results = 0;
  for (long long k = 0; k < p->n_rows; k++) {
    const int out = p->out[k];
    if (!bits[out] || (last[out] < 0 && result[out] < 0)) continue;
    int *head = next;
    next += 4;
    head[2] = head[3] = 0;
    for (int inner = 0; inner < 2; inner++)
      for (int i = p->starts[k]; i < p->starts[k + 1]; i++) {
        const int column = p->columns[i];
        if (!bits[column] || row_of[column] != inner) continue;
        head[2 + inner]++;
        *next++ = p->which[i];
        *next++ = inner ? places.of[column] : column;
      }
    for (int i = p->starts[k]; i < p->starts[k + 1]; i++) {
      const int column = p->columns[i];
      if (!bits[column] || !row_of[column] || last[column] != k) continue;
      places.open[places.n_free++] = places.of[column];
      last[column] = -2;
    }
    head[0] = last[out] < 0 ? -1 : (places.of[out] = take_place(&places));
    head[1] = result[out] < 0 ? -1 : (number[result[out]] = n_results++);
    n_rows++;
  }
  plan[0] = n_rows;
  plan[1] = places.n;
  free(room);
  return next - plan;
}

/* Add up how many columns of rows each direction moves: bits (n_columns) say which directions move
   the sources, up to 64; counts (64) grow. */
VD_EXPORT void vd_weigh_directions(const struct program *p, unsigned long long *bits,
                                   long long *counts) {
  for (long long k = 0; k < p->n_rows; k++) {
    unsigned long long own = 0;
    for (int i = p->starts[k]; i < p->starts[k + 1]; i++) own |= bits[p->columns[i]];
    bits[p->out[k]] = own;
    for (int d = 0; own; d++, own >>= 1)
      if (own & 1) counts[d] += p->starts[k + 1] - p->starts[k];
  }
}

#define VD_FOUR(act) act(0) act(1) act(2) act(3)
#define VD_EIGHT(act) VD_FOUR(act) act(4) act(5) act(6) act(7)
#define VD_BEGIN(k) real a##k = zero;
#define VD_ADD_SEED(k) a##k = vd_fma(weight, vd_all(s[k]), a##k);
#define VD_ADD(k) a##k = vd_fma(weight, s[k], a##k);
#define VD_PUT(k) to[k] = a##k;

/* Several directions ahead: seeds are those of the sources, numbers that all points share. */
#define VD_AHEAD(name, width, every)                                                              \
  static void name(const int *plan, const real *w, const double *seeds, real *slots,              \
                   real *results) {                                                               \
    const real zero = vd_all(0.0);                                                                \
    int rows = *plan;                                                                             \
    for (plan += 2; rows > 0; rows--) {                                                           \
      const int slot = plan[0], result = plan[1], inner = plan[3];                                \
      int own = plan[2];                                                                          \
      every(VD_BEGIN)                                                                             \
      for (plan += 4; own > 0; own--, plan += 2) {                                                \
        const real weight = w[plan[0]];                                                           \
        const double *s = seeds + width * plan[1];                                                \
        every(VD_ADD_SEED)                                                                        \
      }                                                                                           \
      for (const int *end = plan + 2 * inner; plan < end; plan += 2) {                            \
        const real weight = w[plan[0]], *s = slots + width * plan[1];                             \
        every(VD_ADD)                                                                             \
      }                                                                                           \
      if (slot >= 0) {                                                                            \
        real *to = slots + width * slot;                                                          \
        every(VD_PUT)                                                                             \
      }                                                                                           \
      if (result >= 0) {                                                                          \
        real *to = results + width * result;                                                      \
        every(VD_PUT)                                                                             \
      }                                                                                           \
    }                                                                                             \
  }

VD_AHEAD(pass_four, 4, VD_FOUR)
VD_AHEAD(pass_eight, 8, VD_EIGHT)

/* One direction, each point with seeds of its own. */
static void pass_one(const int *plan, const real *w, const real *seeds, real *slots,
                     real *results) {
  int rows = *plan;
  for (plan += 2; rows > 0; rows--) {
    const int slot = plan[0], result = plan[1], inner = plan[3];
    int own = plan[2];
    real a = vd_all(0.0);
    for (plan += 4; own > 0; own--, plan += 2) a = vd_fma(w[plan[0]], seeds[plan[1]], a);
    for (const int *end = plan + 2 * inner; plan < end; plan += 2)
      a = vd_fma(w[plan[0]], slots[plan[1]], a);
    if (slot >= 0) slots[slot] = a;
    if (result >= 0) results[result] = a;
  }
}

/* A plan for `width` directions with its seeds, and where its results lie. */
struct pass {
  const int *plan;
  const double *seeds;
  long long first;
  int width;
};

void vd_by_state_apart(const real *w, real *j);

/* Derivatives of n_targets results by time, states and the first n_inner results, row after row:
   places of values among those of by_state, where this is asked for, and of the passes; and by
   directions of the constants. A row follows from results before it alone. Steps of a solution
   follow, which change the results in their places. */
struct slopes {
  int by_state;
  long long n_targets, n_passes, n_moved, n_steps;
  const struct pass *passes;
  const int *starts, *values, *sources;
  const int *moved_values, *moved_targets, *moved_directions;
  const int *step_out, *step_scales, *step_starts, *step_columns, *step_which;
  real *slots, *results;
};

static void find_slopes(const struct slopes *s, const real *w) {
  if (s->by_state) vd_by_state_apart(w, s->results);
  for (long long k = 0; k < s->n_passes; k++) {
    const struct pass *p = s->passes + k;
    (p->width == 4 ? pass_four : pass_eight)(p->plan, w, p->seeds, s->slots,
                                             s->results + p->first);
  }
}

enum { VD_SINGULAR = 2, VD_CORNER = 7 };
int vd_inverse(int n, const double *jacobian, double *inverse);
void vd_linearise_apart(const real *t, const real *x, const real *z, const real *a, const real *c,
                        real *w, real *jacobian);
void vd_observe_apart(const real *t, const real *x, const real *z, const real *c, real *values,
                      real *w);

/* Weights at up to VD_LANES points: w holds those of the rates and the unknowns, those of their
   inverses, and behind all fixed ones those of what is observed. */
struct points {
  real t, x[NX + 1], z[NZ + 1], a[NA + 1], jacobian[NI + 1];
};

static void gather_places(struct points *p, int count, const double *t, const double *x,
                          const double *z) {
  for (int lane = 0; lane < VD_LANES; lane++) {
    const int own = lane < count ? lane : count - 1;
    ((double *)&p->t)[lane] = t[own];
    for (int i = 0; i < NX; i++) ((double *)(p->x + i))[lane] = x[own * NX + i];
    for (int i = 0; i < NZ; i++) ((double *)(p->z + i))[lane] = z[own * NZ + i];
  }
}

static void gather(struct points *p, int count, const double *t, const double *x, const double *z,
                   const double *a) {
  gather_places(p, count, t, x, z);
  for (int lane = 0; lane < VD_LANES; lane++) {
    const int own = lane < count ? lane : count - 1;
    for (int i = 0; i < NA; i++) ((double *)(p->a + i))[lane] = a[own * NA + i];
  }
}

/* Enter numbers that all points share: constants, and weights that are fixed. */
VD_EXPORT void vd_share(long long n, const double *values, real *to) {
  for (long long i = 0; i < n; i++) to[i] = vd_all(values[i]);
}

VD_EXPORT const int vd_lanes = VD_LANES;

static double time_of(long long step, double part, double start, double interval,
                      long long per_interval) {
  return start + interval * ((double)(step / per_interval) +
                             ((double)(step % per_interval) + part) / (double)per_interval);
}

#define INSIDE 1e-8
enum { RK4 = 0, SYMPLECTIC_EULER = 1 };
enum { VD_STAGES = 4, NXR = NX > 0 ? NX : 1, NZR = NZ > 0 ? NZ : 1, NAR = NA > 0 ? NA : 1 };

void vd_rates_at(double t, const double *x, const double *z, const double *c, double *rates);
int vd_end_of_step(double t, const double *x, const double *z, const double *c, int *sides,
                   int is_sample);
int vd_stage_points(int method, const double *times, double h, const double *c, double *x,
                    double *z, double *memory, double *xs, double *zs, double *ks);

/* Where the stages of a step lie, and behind them its end. */
struct steps {
  int method;
  long long per;
  double start, interval, from, to;
};

static void stage_times(const struct steps *s, long long step, double *times) {
  const double part = s->to - s->from;
  times[0] = time_of(step, s->from + INSIDE * part, s->start, s->interval, s->per);
  times[1] = time_of(step, s->from + 0.5 * part, s->start, s->interval, s->per);
  times[2] = times[1];
  times[3] = time_of(step, s->to - INSIDE * part, s->start, s->interval, s->per);
  times[4] = s->to < 1.0 ? time_of(step, s->to, s->start, s->interval, s->per)
                         : time_of(step + 1, 0.0, s->start, s->interval, s->per);
}

static double step_of(const struct steps *s) {
  return s->interval / (double)s->per * (s->to - s->from);
}

static int stages_of(const struct steps *s) { return s->method == RK4 ? VD_STAGES : 1; }

/* Accelerations, those of the rates that are. */
static void accelerations(const double *rates, double *a) {
  for (int i = 0; i < NA; i++) a[i] = rates[accelerated[i]];
}

/* Numbers of a run: constants as given and in lanes, room for weights and points. */
struct numbers {
  const double *c;
  const real *lanes;
  real *w;
  struct points *points;
};

/* Minus the inverse of a block's Jacobian, which lies by columns; by Cramer's rule, one division, for
   the sizes that most blocks have. */
static int invert_block(int n, const real *jacobian, real *inverse) {
  double square[NW * NW], found[NW * NW];
  if (n == 1) {
    if (vd_any(vd_eq(jacobian[0], vd_all(0.0)))) return VD_SINGULAR;
    inverse[0] = -1.0 / jacobian[0];
    return 0;
  }
  if (n == 2) {
    const real determinant = jacobian[0] * jacobian[3] - jacobian[1] * jacobian[2];
    if (vd_any(vd_eq(determinant, vd_all(0.0)))) return VD_SINGULAR;
    const real scale = -1.0 / determinant;
    inverse[0] = jacobian[3] * scale, inverse[3] = jacobian[0] * scale;
    inverse[1] = -jacobian[1] * scale, inverse[2] = -jacobian[2] * scale;
    return 0;
  }
  for (int lane = 0; lane < VD_LANES; lane++) {
    for (int i = 0; i < n * n; i++) square[i] = VD_LANE(jacobian[i], lane);
    const int status = vd_inverse(n, square, found);
    if (status) return status;
    for (int i = 0; i < n * n; i++) ((double *)(inverse + i))[lane] = found[i];
  }
  return 0;
}

static int weigh(const struct numbers *given, int count, const double *t, const double *x,
                 const double *z, const double *a) {
  struct points *p = given->points;
  const real *jacobian = p->jacobian;
  real *inverse = given->w + NU;
  gather(p, count, t, x, z, a);
  vd_linearise_apart(&p->t, p->x, p->z, p->a, given->lanes, given->w, p->jacobian);
  for (int k = 0; k < NB; k++) {
    const int n = block_size[k], status = invert_block(n, jacobian, inverse);
    if (status) return status;
    jacobian += n * n, inverse += n * n;
  }
  return 0;
}

/* Weights at up to VD_LANES points of which the accelerations are not known. */
static int weigh_points(const struct numbers *given, int count, const double *t, const double *x,
                        const double *z) {
  double rates[NXR], a[VD_LANES][NAR];
  for (int k = 0; NA && k < count; k++) {
    vd_rates_at(t[k], x + k * NX, z + k * NZ, given->c, rates);
    accelerations(rates, a[k]);
  }
  return weigh(given, count, t, x, z, &a[0][0]);
}
