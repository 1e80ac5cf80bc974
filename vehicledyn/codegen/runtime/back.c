/* Adjoints of a motion with steps of rk4: what a change of the states before a step does to a
   number drawn from the motion, from what one of those behind it does. Those of the constants add
   up, for several stages side by side. */

/* Take steps and keep states and unknowns of their stages. */
VD_EXPORT int vd_record(const struct steps *way, long long step, long long n_steps,
                        const double *c, double *x, double *z, double *xs, double *zs) {
  double times[VD_STAGES + 1], memory[1 + 2 * NZR], ks[VD_STAGES * NXR];
  memset(memory, 0, sizeof memory);
  for (long long k = 0; k < n_steps; k++, xs += VD_STAGES * NX, zs += VD_STAGES * NZ) {
    stage_times(way, step + k, times);
    const int status =
        vd_stage_points(way->method, times, step_of(way), c, x, z, memory, xs, zs, ks);
    if (status) return status;
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

/* to = J' bar, the first place being that of time. */
static void rates_back(const struct slopes *s, int lane, const double *bar, double *to) {
  const double *all = (const double *)s->results + lane;
  memset(to, 0, (1 + NX) * sizeof(double));
  for (int k = 0; k < NX; k++)
    for (int i = s->starts[k]; i < s->starts[k + 1]; i++)
      to[s->sources[i]] += all[(long long)s->values[i] * VD_LANES] * bar[k];
}

/* One step whose stages are in lanes: their adjoints from last to first. */
static void step_back(const struct slopes *s, int lane, double h, real *bars, double *x_bar) {
  static const double share[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
  double rate_bar[NXR], stage_bar[1 + NX], total[NXR];
  memcpy(total, x_bar, NX * sizeof(double));
  memset(stage_bar, 0, sizeof stage_bar);
  for (int stage = 3; stage >= 0; stage--) {
    const double later = stage < 3 ? share[stage + 1] * h : 0.0;
    for (int i = 0; i < NX; i++) {
      rate_bar[i] = h / 6.0 * weight[stage] * x_bar[i] + later * stage_bar[1 + i];
      ((double *)(bars + i))[lane + stage] = rate_bar[i];
    }
    rates_back(s, lane + stage, rate_bar, stage_bar);
    for (int i = 0; i < NX; i++) total[i] += stage_bar[1 + i];
  }
  memcpy(x_bar, total, NX * sizeof(double));
}

/* Go back over n_steps steps whose stages are kept in xs and zs. seeds (intervals, NX) are added
   where a step begins an interval. */
VD_EXPORT int vd_steps_back(const struct steps *way, long long first, long long n_steps,
                            const struct numbers *given, const double *xs, const double *zs,
                            const struct slopes *s, const struct back_pass *b,
                            const double *seeds, double *x_bar) {
  enum { MOST = VD_LANES / VD_STAGES };
  const double h = step_of(way);
  double t[VD_LANES], times[VD_STAGES + 1];
  real bars[NXR];
  for (long long end = n_steps; end > 0;) {
    const int count = end < MOST ? (int)end : MOST;
    const long long begin = end - count;
    for (int k = 0; k < count; k++) {
      stage_times(way, first + begin + k, times);
      memcpy(t + k * VD_STAGES, times, VD_STAGES * sizeof(double));
    }
    const int status =
        weigh(given->points, count * VD_STAGES, t, xs + begin * VD_STAGES * NX,
              zs + begin * VD_STAGES * NZ, given->lanes, given->w);
    if (status) return status;
    find_slopes(s, given->w);
    memset(bars, 0, sizeof bars);
    for (int k = count - 1; k >= 0; k--) {
      step_back(s, k * VD_STAGES, h, bars, x_bar);
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
    const int status = weigh(given->points, some, t + first, x + first * NX, z + first * NZ,
                             given->lanes, given->w);
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
