/* Adjoints of a motion with steps of rk4: what a change of the states before a step does to a
   number drawn from the motion, from what one of those behind it does. Those of the constants add
   up, for several stages side by side. */

/* Take steps and keep states, unknowns and accelerations of their stages. */
VD_EXPORT int vd_record(const struct steps *way, long long step, long long n_steps,
                        const double *c, double *x, double *z, double *xs, double *zs, double *as) {
  double times[VD_STAGES + 1], memory[1 + 2 * NZR], ks[VD_STAGES * NXR];
  memset(memory, 0, sizeof memory);
  for (long long k = 0; k < n_steps; k++, xs += VD_STAGES * NX, zs += VD_STAGES * NZ) {
    stage_times(way, step + k, times);
    const int status =
        vd_stage_points(way->method, times, step_of(way), c, x, z, memory, xs, zs, ks);
    if (status) return status;
    for (int i = 0; i < VD_STAGES; i++, as += NA) accelerations(ks + i * NX, as);
  }
  return 0;
}

/* A plan that goes back, with room for its places and results, and where these add up. */
struct back_pass {
  const int *plan;
  long long n_results;
  real *slots, *results, *sums;
};

static void add_up(const struct back_pass *b, const real *w, const real *bars) {
  pass_one(b->plan, w, bars, b->slots, b->results);
  for (long long i = 0; i < b->n_results; i++) b->sums[i] = b->sums[i] + b->results[i];
}

/* Adjoints of results in bars, from which those of earlier results, states and time before them
   follow; room holds time, states, results. */
static void results_back(const struct slopes *s, const real *w, int lane, double *room) {
  const double *all = (const double *)s->results + lane, *weights = (const double *)w + lane;
  double *bars = room + 1 + NX;
  for (long long k = s->n_steps - 1; k >= 0; k--) {
    double *own = bars + s->step_out[k];
    for (int i = s->step_starts[k]; i < s->step_starts[k + 1]; i++)
      bars[s->step_columns[i]] += weights[(long long)s->step_which[i] * VD_LANES] * *own;
    *own *= weights[(long long)s->step_scales[k] * VD_LANES];
  }
  for (long long k = s->n_targets - 1; k >= 0; k--)
    for (int i = s->starts[k]; i < s->starts[k + 1]; i++)
      room[s->sources[i]] += all[(long long)s->values[i] * VD_LANES] * bars[k];
}

/* One step whose stages are in lanes: their adjoints from last to first. */
static void step_back(const struct slopes *s, const real *w, int lane, double h, real *bars,
                      double *x_bar) {
  static const double share[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
  double room[1 + NX + NZ + NX], total[NXR], *results = room + 1 + NX;
  memcpy(total, x_bar, NX * sizeof(double));
  memset(room, 0, sizeof room);
  for (int stage = 3; stage >= 0; stage--) {
    const double later = stage < 3 ? share[stage + 1] * h : 0.0;
    for (int i = 0; i < NX; i++)
      results[NZ + i] = h / 6.0 * weight[stage] * x_bar[i] + later * room[1 + i];
    memset(room, 0, (1 + NX + NZ) * sizeof(double));
    results_back(s, w, lane + stage, room);
    for (int i = 0; i < NZ + NX; i++) ((double *)(bars + i))[lane + stage] = results[i];
    for (int i = 0; i < NX; i++) total[i] += room[1 + i];
  }
  memcpy(x_bar, total, NX * sizeof(double));
}

/* Go back over n_steps steps whose stages are kept in xs and zs. seeds (intervals, NX) are added
   where a step begins an interval. */
VD_EXPORT int vd_steps_back(const struct steps *way, long long first, long long n_steps,
                            const struct numbers *given, const double *xs, const double *zs,
                            const double *as, const struct slopes *s, const struct back_pass *b,
                            const double *seeds, double *x_bar) {
  enum { MOST = VD_LANES / VD_STAGES };
  const double h = step_of(way);
  double t[VD_LANES], times[VD_STAGES + 1];
  real bars[NZ + NXR];
  for (long long end = n_steps; end > 0;) {
    const int count = end < MOST ? (int)end : MOST;
    const long long begin = end - count;
    for (int k = 0; k < count; k++) {
      stage_times(way, first + begin + k, times);
      memcpy(t + k * VD_STAGES, times, VD_STAGES * sizeof(double));
    }
    const int status =
        weigh(given, count * VD_STAGES, t, xs + begin * VD_STAGES * NX,
              zs + begin * VD_STAGES * NZ, as + begin * VD_STAGES * NA);
    if (status) return status;
    find_slopes(s, given->w);
    memset(bars, 0, sizeof bars);
    for (int k = count - 1; k >= 0; k--) {
      step_back(s, given->w, k * VD_STAGES, h, bars, x_bar);
      const long long step = first + begin + k;
      if (step % way->per) continue;
      for (int i = 0; i < NX; i++) x_bar[i] += seeds[step / way->per * NX + i];
    }
    add_up(b, given->w, bars);
    end = begin;
  }
  return 0;
}

/* What seeds (count, NO) of observed values at points do: x_bars (count, NX) by the states, as
   results that state_results number, and by constants, which add up. */
VD_EXPORT int vd_values_back(long long count, const double *t, const double *x, const double *z,
                             const struct numbers *given, const struct back_pass *b,
                             const int *state_results, const double *seeds, double *x_bars) {
  real observed[NO + 1], bars[NZ + NO + 1];
  for (long long first = 0; first < count; first += VD_LANES) {
    const int some = count - first < VD_LANES ? (int)(count - first) : VD_LANES;
    const int status = weigh_points(given, some, t + first, x + first * NX, z + first * NZ);
    if (status) return status;
    vd_observe_apart(&given->points->t, given->points->x, given->points->z, given->lanes,
                     observed, given->w + NBEFORE);
    memset(bars, 0, sizeof bars);
    for (int lane = 0; lane < some; lane++)
      for (int i = 0; i < NO; i++)
        ((double *)(bars + NZ + i))[lane] = seeds[(first + lane) * NO + i];
    add_up(b, given->w, bars);
    for (int lane = 0; lane < some; lane++)
      for (int i = 0; i < NX; i++)
        x_bars[(first + lane) * NX + i] =
            state_results[i] < 0 ? 0.0 : VD_LANE(b->results[state_results[i]], lane);
  }
  return 0;
}
