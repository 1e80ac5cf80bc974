/* Tangents of a motion with fixed steps; derivatives of what the steps compute, not of the motion
   that they approximate. The Jacobians of several stages are found side by side, then the tangents
   go from stage to stage, VD_LANES directions side by side. */

/* The directions of a run: n groups of VD_LANES each, of which the first n_live are carried, of the
   last of these one half if halved; the others are zero. x (NX, n) are those of the states, from and
   to (n) those of the begin and the end of a part of a step; room is for stages, moved for what
   constants that move add at each point (VD_LANES, results, n), zero where they add nothing. */
struct directions {
  long long n, n_live, halved;
  real *x, *from, *to, *room, *moved;
};

#define VD_SPREAD(k) own[k * point] = from[k];

static void spread_moved(const struct slopes *s, long long n, real *moved) {
  double *to = (double *)moved;
  const long long point = s->n_targets * n * VD_LANES;
  for (long long k = 0; k < s->n_moved; k++) {
    const double *from = (const double *)(s->results + s->moved_values[k]);
    double *own = to + s->moved_targets[k] * n * VD_LANES + s->moved_directions[k];
#if VD_LANES == 8
    VD_EIGHT(VD_SPREAD)
#else
    VD_FOUR(VD_SPREAD)
#endif
  }
}

/* Groups of lanes that are carried together; of the last one only the first half may be wanted. */
#if VD_LANES == 8 && VD_WIDTH == 8
typedef vd_four vd_half;
#define vd_fma_half(a, b, c) ((vd_half)VD_FMA4(a, b, c))
#else
typedef real vd_half;
#define vd_fma_half(a, b, c) vd_fma(a, b, c)
#endif
VD_INLINE vd_half vd_all_half(double a) { return a - (vd_half){0.0}; }

#define VD_LONE(act) act(0)
#define VD_PAIR(act) act(0) act(1)
#define VD_TRIPLE(act) act(0) act(1) act(2)
#define VD_NONE(act)
#define VD_FIRST(act) act(0)
#define VD_SECOND(act) act(1)
#define VD_THIRD(act) act(2)
#define VD_HALF(p, k) (*(vd_half *)((p) + k))
#define VD_START(k) real a##k = moved[k];
#define VD_START_HALF(k) vd_half a##k = VD_HALF(moved, k);
#define VD_TAKE(k) a##k = vd_fma(vd_all(weight), g[k], a##k);
#define VD_TAKE_HALF(k) a##k = vd_fma_half(vd_all_half(weight), VD_HALF(g, k), a##k);
#define VD_GIVE(k) to[k] = a##k;
#define VD_GIVE_HALF(k) VD_HALF(to, k) = a##k;
#define VD_SCALE(k) real a##k = vd_all(scale) * to[k];
#define VD_SCALE_HALF(k) vd_half a##k = vd_all_half(scale) * VD_HALF(to, k);

/* Room holds the tangents of time and states, and behind them those of the results, which later
   results follow from too. */
#define VD_COMBINE(name, every, last)                                                             \
  static void name(const struct slopes *s, const real *w, int lane, long long n,                  \
                   const real *moved, real *room) {                                               \
    const double *all = (const double *)s->results + lane, *weights = (const double *)w + lane;   \
    const int *value = s->values, *source = s->sources;                                           \
    real *const results = room + (1 + NX) * n, *to = results;                                     \
    for (long long k = 0; k < s->n_targets; k++, moved += n, to += n) {                           \
      every(VD_START) last(VD_START_HALF)                                                         \
      for (const int *end = s->values + s->starts[k + 1]; value < end; value++, source++) {       \
        const double weight = all[(long long)*value * VD_LANES];                                  \
        const real *g = room + *source * n;                                                       \
        every(VD_TAKE) last(VD_TAKE_HALF)                                                         \
      }                                                                                           \
      every(VD_GIVE) last(VD_GIVE_HALF)                                                           \
    }                                                                                             \
    const int *column = s->step_columns, *which = s->step_which;                                  \
    for (long long k = 0; k < s->n_steps; k++) {                                                  \
      const double scale = weights[(long long)s->step_scales[k] * VD_LANES];                      \
      to = results + s->step_out[k] * n;                                                          \
      every(VD_SCALE) last(VD_SCALE_HALF)                                                         \
      for (const int *end = s->step_which + s->step_starts[k + 1]; which < end; which++) {        \
        const double weight = weights[(long long)*which * VD_LANES];                              \
        const real *g = results + *column++ * n;                                                  \
        every(VD_TAKE) last(VD_TAKE_HALF)                                                         \
      }                                                                                           \
      every(VD_GIVE) last(VD_GIVE_HALF)                                                           \
    }                                                                                             \
  }

VD_COMBINE(combine_one, VD_LONE, VD_NONE)
VD_COMBINE(combine_two, VD_PAIR, VD_NONE)
VD_COMBINE(combine_three, VD_TRIPLE, VD_NONE)
VD_COMBINE(combine_half, VD_NONE, VD_FIRST)
VD_COMBINE(combine_one_half, VD_LONE, VD_SECOND)
VD_COMBINE(combine_two_half, VD_PAIR, VD_THIRD)

/* Tangents of results at a point by those of time and states, see above for the room. */
static void combine(const struct slopes *s, const real *w, int lane, const struct directions *d) {
  static void (*const whole[])(const struct slopes *, const real *, int, long long, const real *,
                               real *) = {combine_one, combine_two, combine_three};
  static void (*const halved[])(const struct slopes *, const real *, int, long long, const real *,
                                real *) = {combine_half, combine_one_half, combine_two_half};
  const long long n = d->n;
  const real *moved = d->moved + lane * s->n_targets * n;
  long long k = 0;
  for (; d->n_live - k > 3; k += 3) combine_three(s, w, lane, n, moved + k, d->room + k);
  (d->halved ? halved : whole)[d->n_live - k - 1](s, w, lane, n, moved + k, d->room + k);
}

/* Tangents of the time at a place in the step. */
static void place(const struct directions *d, double part, real *given) {
  for (long long g = 0; g < d->n; g++) given[g] = (1.0 - part) * d->from[g] + part * d->to[g];
}

static int lasts_as_long(const struct directions *d) {
  return !memcmp(d->from, d->to, d->n * sizeof(real));
}

/* to = x + a h dk, and what a change of the step's length adds, along rates k. */
static void move(const struct directions *d, double a, double h, const double *k, const real *dk,
                 real *to) {
  const long long n = d->n;
  const real by = vd_all(a * h);
  for (long long i = 0; i < NX * n; i++) to[i] = vd_fma(by, dk[i], d->x[i]);
  if (lasts_as_long(d)) return;
  for (int i = 0; i < NX; i++)
    for (long long g = 0; g < n; g++)
      to[i * n + g] = to[i * n + g] + (a * k[i]) * (d->to[g] - d->from[g]);
}

static void tangents_rk4(const struct slopes *s, const real *w, const struct directions *d,
                         int lane, double h, const double *ks) {
  static const double share[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
  static const double at[4] = {INSIDE, 0.5, 0.5, 1.0 - INSIDE};
  const long long n = d->n, size = NX * n;
  real *given = d->room, *dk = given + size + n + NZ * n, *sum = dk + size;
  double rate[NXR];
  memset(rate, 0, sizeof rate);
  memcpy(given + n, d->x, size * sizeof(real));
  for (int stage = 0; stage < 4; stage++) {
    const double *k = ks + stage * NX;
    place(d, at[stage], given);
    combine(s, w, lane + stage, d);
    for (int i = 0; i < NX; i++) rate[i] += weight[stage] * k[i];
    if (stage == 0)
      memcpy(sum, dk, size * sizeof(real));
    else
      for (long long i = 0; i < size; i++) sum[i] = vd_fma(vd_all(weight[stage]), dk[i], sum[i]);
    if (stage < 3) move(d, share[stage + 1], h, k, dk, given + n);
  }
  move(d, 1.0 / 6.0, h, rate, sum, d->x);
}

static void tangents_symplectic(const struct slopes *s, const real *w, const struct directions *d,
                                int lane, double h, const double *k, const double *next) {
  const long long n = d->n, size = NX * n;
  real *given = d->room, *dk = given + size + n + NZ * n, *moved = dk + size;
  place(d, INSIDE, given);
  memcpy(given + n, d->x, size * sizeof(real));
  combine(s, w, lane, d);
  move(d, 1.0, h, k, dk, moved);
  for (int i = 0; i < NQ; i++) {
    const int p = positions[i], v = velocities[i];
    for (long long g = 0; g < n; g++)
      moved[p * n + g] =
          d->x[p * n + g] + h * moved[v * n + g] + next[v] * (d->to[g] - d->from[g]);
  }
  memcpy(d->x, moved, size * sizeof(real));
}

/* Groups of points whose steps are taken before the derivatives are found, so that the code of the
   motion stays in the cache. */
enum { VD_GROUPS = NX + NZ < 256 ? 8 : 1, VD_MOST = VD_GROUPS * VD_LANES };

/* Points of the stages of some steps, and those behind the steps. */
struct trail {
  double t[VD_MOST], x[VD_MOST][NXR], z[VD_MOST][NZR], k[VD_MOST][NXR], a[VD_MOST][NAR];
  double ends[VD_MOST][NXR], ends_z[VD_MOST][NZR], memory[1 + 2 * NZR];
};

/* Take up to count steps and return how many were taken; a step that fails or in which an event
   fires is not. sides are none where events are not watched. */
static int take_steps(const struct steps *way, long long step, int count, const double *c,
                      double *x, double *z, int *sides, struct trail *trail, int *status) {
  const int stages = stages_of(way);
  for (int k = 0; k < count; k++, step++) {
    double *end = trail->ends[k], *end_z = trail->ends_z[k], times[VD_STAGES + 1];
    const int first = k * stages;
    stage_times(way, step, times);
    memcpy(trail->t + first, times, stages * sizeof(double));
    memcpy(end, x, NX * sizeof(double));
    memcpy(end_z, z, NZ * sizeof(double));
    *status = vd_stage_points(way->method, times, step_of(way), c, end, end_z, trail->memory,
                              &trail->x[0][0] + first * NX, &trail->z[0][0] + first * NZ,
                              &trail->k[0][0] + first * NX);
    for (int i = first; i < first + stages; i++)
      accelerations(&trail->k[0][0] + i * NX, &trail->a[0][0] + i * NA);
    if (!*status && sides)
      *status = vd_end_of_step(times[VD_STAGES], end, end_z, c, sides, !((step + 1) % way->per));
    if (*status) return k;
    memcpy(x, end, NX * sizeof(double));
    memcpy(z, end_z, NZ * sizeof(double));
  }
  return count;
}

#if NK
/* Leave steps of a trail from the first with a corner on: go back to its begin, and return how many
   are left. */
static int leave_corner(struct branches *b, const struct steps *way, long long step, int count,
                        const struct numbers *given, double *x, double *z, int *sides,
                        const int *earlier, const struct trail *trail) {
  double ends[VD_MOST];
  int own = 0;
  for (int k = 0; k < count; k++) ends[k] = time_of(step + k + 1, 0.0, way->start, way->interval, way->per);
  while (own < count) {
    const int some = count - own < VD_LANES ? count - own : VD_LANES;
    gather_places(given->points, some, ends + own, trail->ends[own], trail->ends_z[own]);
    const int taken = steps_to_corner(b, given->points, some);
    own += taken;
    if (taken < some) break;
  }
  if (own == count) return count;
  memcpy(x, trail->x[own * stages_of(way)], NX * sizeof(double));
  memcpy(z, trail->z[own * stages_of(way)], NZ * sizeof(double));
  if (sides && NE) {
    memcpy(sides, earlier, NE * sizeof(int));
    for (int k = 0; k < own; k++)
      vd_end_of_step(ends[k], trail->ends[k], trail->ends_z[k], given->c, sides, 0);
  }
  return own;
}
#endif

/* Take n_steps steps, or a part of one, unless one fails, an event fires in it or, where branches
   are given, one of these changes. States, unknowns and tangents at the ends of whole intervals are
   written to xs, zs and dxs, row after row; taken is the number of steps. Without directions there
   are no tangents. */
VD_EXPORT int vd_tangent_steps(const struct steps *way, long long step, long long n_steps,
                               const struct numbers *given, double *x, double *z, int *sides,
                               struct branches *b, const struct slopes *s,
                               const struct directions *d, double *xs, double *zs, real *dxs,
                               long long *taken) {
  const int stages = stages_of(way), each = VD_LANES / stages;
  const double h = step_of(way);
  const long long last = step + n_steps;
  struct trail trail;
  int earlier[NE + 1];
  memset(trail.memory, 0, sizeof trail.memory);
  *taken = 0;
  for (int status = 0; step < last && !status;) {
    const long long most = VD_GROUPS * each, wanted = last - step < most ? last - step : most;
    if (sides) memcpy(earlier, sides, NE * sizeof(int));
    int count = take_steps(way, step, (int)wanted, given->c, x, z, sides, &trail, &status);
#if NK
    const int smooth =
        b ? leave_corner(b, way, step, count, given, x, z, sides, earlier, &trail) : count;
    if (smooth < count) count = smooth, status = VD_CORNER;
#endif
    for (int first = 0; first < count; first += each) {
      const int some = count - first < each ? count - first : each, at = first * stages;
      if (d->n_live) {
        const int failed = weigh(given, some * stages, trail.t + at, &trail.x[0][0] + at * NX,
                                 &trail.z[0][0] + at * NZ, &trail.a[0][0] + at * NA);
        if (failed) return failed;
        find_slopes(s, given->w);
        spread_moved(s, d->n, d->moved);
      }
      for (int k = first; k < first + some; k++, step++) {
        const double *rates = &trail.k[0][0] + k * stages * NX;
        const int lane = (k - first) * stages;
        if (d->n_live && way->method == RK4)
          tangents_rk4(s, given->w, d, lane, h, rates);
        else if (d->n_live)
          tangents_symplectic(s, given->w, d, lane, h, rates, trail.ends[k]);
        if (way->to < 1.0 || (step + 1) % way->per) continue;
        memcpy(xs, trail.ends[k], NX * sizeof(double));
        memcpy(zs, trail.ends_z[k], NZ * sizeof(double));
        memcpy(dxs, d->x, NX * d->n * sizeof(real));
        xs += NX, zs += NZ, dxs += NX * d->n;
      }
      *taken += some;
    }
    if (status) return status;
  }
  return 0;
}

/* Results at points and their tangents (count, results, n), by those of time (count, n) and states
   (count, NX, n). Values are those observed. */
VD_EXPORT int vd_tangent_points(long long count, const double *t, const double *x, const double *z,
                                const struct numbers *given, const struct slopes *s,
                                const struct directions *d, const real *dt, const real *dx,
                                double *values, real *found) {
  const long long n = d->n, size = s->n_targets * n;
  real observed[NO + 1];
  for (long long first = 0; first < count; first += VD_LANES) {
    const int some = count - first < VD_LANES ? (int)(count - first) : VD_LANES;
    const int status = weigh_points(given, some, t + first, x + first * NX, z + first * NZ);
    if (status) return status;
    vd_observe_apart(&given->points->t, given->points->x, given->points->z, given->lanes, observed,
                     given->w + NBEFORE);
    find_slopes(s, given->w);
    spread_moved(s, n, d->moved);
    for (int lane = 0; lane < some; lane++) {
      const long long point = first + lane;
      memcpy(d->room, dt + point * n, n * sizeof(real));
      memcpy(d->room + n, dx + point * NX * n, NX * n * sizeof(real));
      combine(s, given->w, lane, d);
      memcpy(found + point * size, d->room + (1 + NX) * n, size * sizeof(real));
      for (int i = 0; i < NO; i++) values[point * NO + i] = VD_LANE(observed[i], lane);
    }
  }
  return 0;
}
