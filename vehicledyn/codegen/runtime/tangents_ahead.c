/* Tangents of a motion with fixed steps, VD_LANES directions side by side; derivatives of what the
   steps compute, not of the motion that they approximate. */

enum { RK4 = 0, SYMPLECTIC_EULER = 1 };

int vd_solve_point(double t, const double *x, double *z, const double *c);
int vd_linearise(double t, const double *x, const double *z, const double *c, double *rate,
                 double *w);
void vd_observe(double t, const double *x, const double *z, const double *c, double *values,
                double *w);

/* What moving constants contribute to rows: entries starts[k] to starts[k + 1] go to row out[k]. */
struct rows {
  long long n_touched, n_rows, n_columns;
  const int *out, *starts, *columns, *which, *targets, *unknowns;
};

/* The directions of a run: n groups of VD_LANES each, and room for them: columns and then rows. */
struct directions {
  long long n;
  real *columns, *x, *from, *to, *room;
};

typedef void (*row_function)(const double *w, const real *b, real *t);

static void push(row_function write, const struct rows *rows, const double *w, real *t) {
  real *b = t + rows->n_columns;
  const int *column = rows->columns, *which = rows->which;
  for (long long k = 0; k < rows->n_touched; k++) {
    const int end = rows->starts[k + 1];
    real sum = t[*column++] * w[*which++];
    for (int i = rows->starts[k] + 1; i < end; i++)
      sum = vd_fma(vd_all(w[*which++]), t[*column++], sum);
    b[rows->out[k]] = sum;
  }
  write(w, b, t);
}

static double time_of(long long step, double part, double start, double interval,
                      long long per_interval) {
  return start + interval * ((double)(step / per_interval) +
                             ((double)(step % per_interval) + part) / (double)per_interval);
}

#define INSIDE 1e-8
enum { NXR = NX > 0 ? NX : 1, NZR = NZ > 0 ? NZ : 1 };

/* Rates of a stage and their tangents: x is what the stage is given, part its place in the step. */
static void tangents_of(const struct rows *rows, const struct directions *d, double part,
                        const real *xs, const double *w, real *rate) {
  for (long long g = 0; g < d->n; g++) {
    real *t = d->columns + g * (rows->n_columns + rows->n_rows);
    t[0] = (1.0 - part) * d->from[g] + part * d->to[g];
    memcpy(t + 1, xs + g * NX, NX * sizeof(real));
    push(stage_rows, rows, w, t);
    for (int i = 0; i < NX; i++) rate[g * NX + i] = t[rows->targets[i]];
  }
}

/* xs = x + a h k, and its tangents with those of the step's length. */
static void move(const struct directions *d, double a, double h, const double *x, const double *k,
                 const real *dk, double *xs, real *dxs) {
  for (int i = 0; i < NX; i++) xs[i] = x[i] + a * h * k[i];
  for (long long g = 0; g < d->n; g++) {
    const real longer = a * (d->to[g] - d->from[g]);
    for (int i = 0; i < NX; i++)
      dxs[g * NX + i] = d->x[g * NX + i] + (a * h) * dk[g * NX + i] + longer * k[i];
  }
}

static int step_rk4(const struct rows *rows, const struct directions *d, const double *times,
                    double h, const double *c, double *x, double *z, double *w) {
  static const double share[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
  static const double place[4] = {INSIDE, 0.5, 0.5, 1.0 - INSIDE};
  double k[NXR], xs[NXR], zs[NZR], sum[NXR];
  const long long size = d->n * NX;
  real *dxs = d->room, *dk = d->room + size, *dsum = d->room + 2 * size;
  memcpy(xs, x, NX * sizeof(double));
  memcpy(zs, z, NZ * sizeof(double));
  memcpy(dxs, d->x, size * sizeof(real));
  for (int stage = 0; stage < 4; stage++) {
    int status = stage ? vd_solve_point(times[stage], xs, zs, c) : 0;
    if (!status) status = vd_linearise(times[stage], xs, zs, c, k, w);
    if (status) return status;
    tangents_of(rows, d, place[stage], dxs, w, dk);
    if (!stage) {
      memset(sum, 0, sizeof sum);
      memset(dsum, 0, size * sizeof(real));
    }
    for (int i = 0; i < NX; i++) sum[i] += weight[stage] * k[i];
    for (long long i = 0; i < size; i++) dsum[i] += weight[stage] * dk[i];
    if (stage < 3) move(d, share[stage + 1], h, x, k, dk, xs, dxs);
  }
  for (int i = 0; i < NX; i++) x[i] += h / 6.0 * sum[i];
  for (long long g = 0; g < d->n; g++) {
    const real longer = (d->to[g] - d->from[g]) * (1.0 / 6.0);
    for (int i = 0; i < NX; i++) {
      real *own = d->x + g * NX + i;
      *own += (h / 6.0) * dsum[g * NX + i] + longer * sum[i];
    }
  }
  memcpy(z, zs, NZ * sizeof(double));
  return vd_solve_point(times[4], x, z, c);
}

static int step_symplectic(const struct rows *rows, const struct directions *d,
                           const double *times, double h, const double *c, double *x, double *z,
                           double *w) {
  double k[NXR], xs[NXR];
  real *dxs = d->room, *dk = d->room + d->n * NX;
  const int status = vd_linearise(times[0], x, z, c, k, w);
  if (status) return status;
  tangents_of(rows, d, INSIDE, d->x, w, dk);
  move(d, 1.0, h, x, k, dk, xs, dxs);
  for (int i = 0; i < NQ; i++) {
    const int p = positions[i], v = velocities[i];
    xs[p] = x[p] + h * xs[v];
    for (long long g = 0; g < d->n; g++)
      dxs[g * NX + p] = d->x[g * NX + p] + h * dxs[g * NX + v] + (d->to[g] - d->from[g]) * xs[v];
  }
  memcpy(x, xs, NX * sizeof(double));
  memcpy(d->x, dxs, d->n * NX * sizeof(real));
  return vd_solve_point(times[4], x, z, c);
}

/* Take n_steps steps, or a part of one from one fraction of it to another. */
VD_EXPORT int vd_tangent_steps(int method, long long step, long long n_steps, double from,
                               double to, long long per, double start, double interval,
                               const double *c, double *x, double *z, double *w,
                               const struct rows *rows, const struct directions *d) {
  const double part = to - from, h = interval / (double)per * part;
  for (long long last = step + n_steps; step < last; step++) {
    const double times[5] = {
        time_of(step, from + INSIDE * part, start, interval, per),
        time_of(step, from + 0.5 * part, start, interval, per),
        time_of(step, from + 0.5 * part, start, interval, per),
        time_of(step, to - INSIDE * part, start, interval, per),
        to < 1.0 ? time_of(step, to, start, interval, per)
                 : time_of(step + 1, 0.0, start, interval, per)};
    const int status = method == RK4 ? step_rk4(rows, d, times, h, c, x, z, w)
                                     : step_symplectic(rows, d, times, h, c, x, z, w);
    if (status) return status;
  }
  return 0;
}

/* Tangents of unknowns (n, NZ) and rates (n, NX) at a point, by those of x, time and constants. */
VD_EXPORT int vd_tangent_point(double t, const double *x, const double *z, const double *c,
                               double *w, const struct rows *rows, const struct directions *d,
                               double *rate, real *dz, real *dk) {
  const int status = vd_linearise(t, x, z, c, rate, w);
  if (status) return status;
  tangents_of(rows, d, 0.0, d->x, w, dk);
  for (long long g = 0; g < d->n; g++)
    for (int i = 0; i < NZ; i++)
      dz[g * NZ + i] = d->columns[g * (rows->n_columns + rows->n_rows) + rows->unknowns[i]];
  return 0;
}

/* Observed values at a point and their tangents (n, n_values). */
VD_EXPORT void vd_tangent_values(double t, const double *x, const double *z, const double *c,
                                 double *w, const struct rows *rows, const struct directions *d,
                                 const real *dz, long long n_values, double *values, real *dy) {
  vd_observe(t, x, z, c, values, w);
  for (long long g = 0; g < d->n; g++) {
    real *column = d->columns + g * (rows->n_columns + rows->n_rows);
    column[0] = d->from[g];
    memcpy(column + 1, d->x + g * NX, NX * sizeof(real));
    memcpy(column + 1 + NX, dz + g * NZ, NZ * sizeof(real));
    push(point_rows, rows, w, column);
    for (long long i = 0; i < n_values; i++) dy[g * n_values + i] = column[rows->targets[i]];
  }
}
