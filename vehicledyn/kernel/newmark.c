/* Steps of Newmark's family on the rates of any kernel, whose functions come as pointers: compiled
   once, not for each model. reduced_steps.py and family.py hold the same algorithm; change
   them together. A step that needs a Jacobian ends the call; it is taken again once that is there. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("O3")
#endif
#include <math.h>
#include <string.h>
#if defined(_WIN32)
#define VD_EXPORT __declspec(dllexport)
#else
#define VD_EXPORT __attribute__((visibility("default")))
#endif

enum { TAKEN, REFUSED, NEEDS_JACOBIAN, CROSSED, STUCK, INEXACT, UNSOLVED, INACCURATE, PAUSED };
enum { SAMPLES, STEPS, EVALUATIONS, ITERATIONS, WHERE };
enum { NONE, KEPT, FRESH };
enum { MOST_ITERATIONS = 20 };

static const double CLOSE = 1e-12, SLOW = 0.3, ROUNDING = 1e-10, ROOM = 0.08;

typedef int (*vd_solver)(double, const double *, double *, const double *, long long *, double *);
typedef void (*vd_function)(double, const double *, const double *, const double *, double *);
typedef void (*vd_points)(long long, const double *, const double *, double *, double *);
typedef void (*vd_surveyor)(long long, const double *, const double *, const double *,
                            const double *, double *, double *);

/* A point with its rates, the auxiliary rates that a step of some size left, and what it added to
   them; the size is zero where the motion starts. Of steps with multipliers the rates are those of
   the rows, and the forces are multipliers, then what corrects positions. */
struct place {
  double time, size;
  double *x, *z, *rates, *auxiliary, *change, *forces;
};

/* What steps with multipliers need besides; the residual is null for others. */
struct constrained {
  vd_points residual;
  const double *given, *l_values, *u_values, *arms;
  const int *l_starts, *l_rows, *u_starts, *u_rows, *row_place, *column_place;
  const int *arm_starts, *arm_columns;
  long long n_multipliers, n_others, is_stabilised;
  double lead, scale, lever, first_order_mass, first_order_gamma;
};

/* One run; newmark_code.py lays it out alike. Lists of places in the state: rows are those but
   for positions, pairs the places of velocities among the rows. */
struct run {
  vd_solver solve;
  vd_function rates, outputs, events;
  vd_surveyor survey;
  const double *constants, *tolerances, *new_mass, *gamma;
  const int *rows, *positions, *velocities, *pairs, *rising, *falling;
  int *sides, *pivots;
  double *jacobian, *matrix, *work, *xs, *zs, *ys, *figures;
  long long *counts;
  struct place at, found;
  long long n_states, n_unknowns, n_outputs, n_blocks, n_events, n_rows, n_pairs;
  long long is_stale, has_jacobian, halvings, is_within, step, last, per_interval, budget, room;
  long long status;
  double alpha_m, alpha_f, beta, second_order_gamma, tolerance, shortest, blind_until;
  double start, interval, end, whole, to, factored, error, least, most, wanted;
  long long n_rates, n_watched;
  struct constrained constrained;
};

/* Factors of the matrix, stored by columns, with pivots; zero where it is singular. */
static void factorise(long long n, double *restrict a, int *restrict pivots) {
  for (long long j = 0; j < n; j++) {
    double *own = a + j * n;
    long long pivot = j;
    for (long long i = j + 1; i < n; i++)
      if (fabs(own[i]) > fabs(own[pivot])) pivot = i;
    pivots[j] = (int)pivot;
    if (pivot != j)
      for (long long k = 0; k < n; k++) {
        const double held = a[j + k * n];
        a[j + k * n] = a[pivot + k * n];
        a[pivot + k * n] = held;
      }
    const double scale = 1.0 / own[j];
    for (long long i = j + 1; i < n; i++) own[i] *= scale;
    for (long long k = j + 1; k < n; k++) {
      double *restrict other = a + k * n;
      const double top = other[j];
      if (top != 0.0)
        for (long long i = j + 1; i < n; i++) other[i] -= own[i] * top;
    }
  }
}

static void solve_factored(long long n, const double *restrict a, const int *restrict pivots,
                           double *restrict b) {
  for (long long j = 0; j < n; j++) { /* all first: later pivots moved the rows of factors, too */
    const double held = b[pivots[j]];
    b[pivots[j]] = b[j];
    b[j] = held;
  }
  for (long long j = 0; j < n; j++) {
    const double own = b[j];
    for (long long i = j + 1; i < n; i++) b[i] -= a[i + j * n] * own;
  }
  for (long long j = n - 1; j >= 0; j--) {
    b[j] /= a[j + j * n];
    const double own = b[j];
    for (long long i = 0; i < j; i++) b[i] -= a[i + j * n] * own;
  }
}

/* Find factors where they are of another size of step. */
static void prepare_factors(struct run *m, double h) {
  if (m->factored != 0.0 && fabs(h - m->factored) <= 1e-9 * m->factored) return;
  const long long n = m->n_rows, width = m->n_states;
  const double part = 1.0 - m->alpha_f, bend = m->beta * h * h;
  for (long long k = 0; k < n; k++) {
    const double lever = part * (h * m->gamma[k]);
    for (long long i = 0; i < n; i++)
      m->matrix[i + k * n] = -lever * m->jacobian[i * width + m->rows[k]];
    m->matrix[k + k * n] += m->new_mass[k];
  }
  for (long long k = 0; k < m->n_pairs; k++)
    for (long long i = 0; i < n; i++)
      m->matrix[i + m->pairs[k] * n] -= part * bend * m->jacobian[i * width + m->positions[k]];
  factorise(n, m->matrix, m->pivots);
  m->factored = h;
}

/* The state at the end of a step by Newmark's formulas. */
static void move(const struct run *m, double h, const double *old, const double *new, double *x) {
  const double *from = m->at.x;
  for (long long k = 0; k < m->n_rows; k++) {
    const double gamma = m->gamma[k];
    x[m->rows[k]] = from[m->rows[k]] + h * ((1.0 - gamma) * old[k] + gamma * new[k]);
  }
  for (long long k = 0; k < m->n_pairs; k++) {
    const int pair = m->pairs[k];
    const double bend = (0.5 - m->beta) * old[pair] + m->beta * new[pair];
    x[m->positions[k]] = from[m->positions[k]] + h * (from[m->velocities[k]] + h * bend);
  }
}

static int evaluate(struct run *m, double t, const double *x, double *z, double *rates) {
  if (m->solve(t, x, z, m->constants, m->counts, m->figures)) return 0;
  m->counts[EVALUATIONS]++;
  m->rates(t, x, z, m->constants, rates);
  return 1;
}

/* Iterate from auxiliary rates that change as in the step before; the end is in m->found. Rates at
   the end are those that the step demands. */
static int iterate(struct run *m, double end) {
  const long long n = m->n_rows;
  struct place *at = &m->at, *found = &m->found;
  double *old = m->work, *known = old + n, *residual = known + n, *next = residual + n;
  double *x = next + m->n_states, *new = found->auxiliary, *held;
  const double h = end - at->time, ratio = at->size != 0.0 ? h / at->size : 1.0;
  const double further = at->size != 0.0 ? ratio : 0.0;
  prepare_factors(m, h);
  for (long long k = 0; k < n; k++) {
    const double rate = at->rates[m->rows[k]];
    old[k] = rate + ratio * (at->auxiliary[k] - rate);
    known[k] = (1.0 - m->new_mass[k]) * old[k] - m->alpha_f * rate;
    new[k] = old[k] + further * at->change[k];
  }
  memcpy(found->z, at->z, m->n_unknowns * sizeof(double));
  memcpy(x, at->x, m->n_states * sizeof(double));
  memcpy(next, at->x, m->n_states * sizeof(double));
  move(m, h, old, new, x);
  double before = INFINITY;
  for (int iteration = 0; iteration < MOST_ITERATIONS; iteration++) {
    if (!evaluate(m, end, x, found->z, found->rates)) return REFUSED;
    for (long long k = 0; k < n; k++)
      residual[k] = m->new_mass[k] * new[k] + known[k] -
                    (1.0 - m->alpha_f) * found->rates[m->rows[k]];
    solve_factored(n, m->matrix, m->pivots, residual);
    for (long long k = 0; k < n; k++) new[k] -= residual[k];
    move(m, h, old, new, next);
    double size = 0.0, total = 0.0;
    for (long long i = 0; i < m->n_states; i++) {
      const double moved = fabs(next[i] - x[i]) / (1.0 + fabs(x[i]));
      total += moved;
      if (moved > size) size = moved;
    }
    if (!isfinite(total)) return REFUSED;
    held = x, x = next, next = held;
    const double contraction = iteration ? size / before : 0.0;
    if (contraction > SLOW && size > ROUNDING) m->is_stale = 1;
    const double left = size * contraction / fmax(1.0 - contraction, 1e-3);
    if ((iteration && left < CLOSE) || size == 0.0 || (contraction > 0.5 && size < ROUNDING)) {
      for (long long k = 0; k < n; k++)
        found->rates[m->rows[k]] = (m->new_mass[k] * new[k] + known[k]) / (1.0 - m->alpha_f);
      memcpy(found->x, x, m->n_states * sizeof(double));
      for (long long k = 0; k < n; k++) found->change[k] = new[k] - old[k];
      found->time = end, found->size = h;
      return TAKEN;
    }
    if (contraction > 0.9) return REFUSED;
    before = size;
  }
  return REFUSED;
}

static int constrained_step(struct run *m, double end);

/* Take a step from m->at to m->found. */
VD_EXPORT int vd_newmark_step(struct run *m, double end) {
  if (m->constrained.residual) return constrained_step(m, end);
  if (m->is_stale || !m->has_jacobian) return NEEDS_JACOBIAN;
  const int is_new = m->has_jacobian == FRESH;
  m->has_jacobian = KEPT;
  if (iterate(m, end) == TAKEN) return TAKEN;
  if (is_new) return REFUSED;
  m->is_stale = 1;
  return NEEDS_JACOBIAN;
}

/* The largest local error of the step to m->found about, for one plus the size of each state. */
static double error_of(const struct run *m) {
  const double *change = m->found.change, *x = m->found.x, h = m->found.size;
  const double shift = m->alpha_m - m->alpha_f, gamma = m->second_order_gamma;
  const double missed = (1.0 - gamma) * shift * shift + gamma * (1.0 + shift) * (1.0 + shift);
  const double ratio = m->at.size != 0.0 ? h / m->at.size : 0.0;
  const double by_rate = h * (0.5 - shift - gamma);
  const double by_bend = m->at.size != 0.0 ? h * (1.0 / 6.0 - 0.5 * missed) : 0.0;
  const double by_position = h * h * (1.0 / 6.0 - 0.5 * shift - m->beta);
  double largest = 0.0;
  for (long long k = 0; k < m->n_watched; k++) {
    const double bend = change[k] - ratio * m->at.change[k];
    const double error = fabs(by_rate * change[k] + by_bend * bend);
    largest = fmax(largest, error / (1.0 + fabs(x[m->rows[k]])));
  }
  for (long long k = 0; k < m->n_pairs; k++) {
    const double error = fabs(by_position * change[m->pairs[k]]);
    largest = fmax(largest, error / (1.0 + fabs(x[m->positions[k]])));
  }
  return largest;
}

/* Tell whether an event fires up to m->found; where none does, the sides become those there. */
static int event_fires(struct run *m) {
  if (!m->n_events || m->found.time < m->blind_until) return 0;
  double *values = m->work;
  m->events(m->found.time, m->found.x, m->found.z, m->constants, values);
  for (long long k = 0; k < m->n_events; k++) {
    if (m->sides[k] < 0 && values[k] >= 0.0 && m->rising[k]) return 1;
    if (m->sides[k] > 0 && values[k] <= 0.0 && m->falling[k]) return 1;
  }
  for (long long k = 0; k < m->n_events; k++)
    if (values[k] != 0.0) m->sides[k] = values[k] > 0.0 ? 1 : -1;
  return 0;
}

static void count_steps(struct run *m, double size) {
  m->counts[STEPS]++;
  m->least = fmin(m->least, size);
  m->most = fmax(m->most, size);
}

/* Write a sample: its unknowns are solved once more, and its blocks checked. */
static int take_sample(struct run *m) {
  const struct place *at = &m->at;
  const long long row = m->counts[SAMPLES];
  const double time = m->start + m->interval * (double)(m->step / m->per_interval);
  double *x = m->xs + row * m->n_states, *z = m->zs + row * m->n_unknowns, *found = m->work;
  memcpy(x, at->x, m->n_states * sizeof(double));
  memcpy(z, at->z, m->n_unknowns * sizeof(double));
  m->status = m->solve(time, x, z, m->constants, m->counts, m->figures);
  if (m->status) return UNSOLVED;
  m->survey(1, &time, x, z, m->constants, found, found + m->n_blocks);
  for (long long k = 0; k < m->n_blocks; k++) {
    if (!(found[k] <= m->figures[0])) m->figures[0] = found[k];
    if (found[k] <= m->tolerances[k]) continue;
    m->figures[1] = found[k];
    m->counts[WHERE] = k;
    return INACCURATE;
  }
  m->outputs(time, x, z, m->constants, m->ys + row * m->n_outputs);
  m->counts[SAMPLES]++;
  return TAKEN;
}

static void go_on(struct run *m) {
  const size_t size = sizeof(double), n = m->n_rows * size;
  memcpy(m->at.x, m->found.x, m->n_states * size);
  memcpy(m->at.z, m->found.z, m->n_unknowns * size);
  memcpy(m->at.rates, m->found.rates, m->n_rates * size);
  memcpy(m->at.auxiliary, m->found.auxiliary, n);
  memcpy(m->at.change, m->found.change, n);
  memcpy(m->at.forces, m->found.forces, 2 * m->constrained.n_multipliers * size);
  m->at.time = m->found.time, m->at.size = m->found.size;
}

/* Go on to the end of the step that is due, in parts where it must be. */
static int finish_step(struct run *m) {
  while (m->at.time < m->end) {
    const double part = m->whole * pow(0.5, (double)m->halvings), remaining = m->end - m->at.time;
    m->to = part >= remaining * (1.0 - 1e-9) ? m->end : m->at.time + part;
    const int status = vd_newmark_step(m, m->to);
    if (status == NEEDS_JACOBIAN) return status;
    m->error = status == REFUSED ? 2.0 : m->tolerance > 0.0 ? error_of(m) / m->tolerance : 0.0;
    if (status == REFUSED || !(m->error <= 1.0)) {
      const long long needed = llround(log2(m->whole / (m->to - m->at.time)));
      m->halvings = (m->halvings > needed ? m->halvings : needed) + 1;
      if (pow(0.5, (double)m->halvings) >= m->shortest) continue;
      return status == REFUSED ? STUCK : INEXACT;
    }
    if (m->tolerance > 0.0 || m->to < m->end) count_steps(m, m->to - m->at.time);
    if (event_fires(m)) return CROSSED;
    go_on(m);
    if (m->error < ROOM && m->halvings) m->halvings--;
  }
  if (m->tolerance <= 0.0) count_steps(m, m->whole);
  return TAKEN;
}

/* Take steps up to m->last, at most m->room samples and about m->budget steps; samples are written
   behind whole intervals. The call ends where Python must do something. */
VD_EXPORT int vd_newmark_advance(struct run *m) {
  while (m->step < m->last) {
    if (!m->is_within) {
      const long long done = m->step / m->per_interval, part = m->step % m->per_interval + 1;
      const double begin = m->start + m->interval * (double)done;
      m->end = begin + m->interval * (double)part / (double)m->per_interval;
      m->whole = m->end - m->at.time;
      m->is_within = 1;
    }
    int status = finish_step(m);
    if (status != TAKEN) return status;
    m->is_within = 0;
    m->step++;
    if (m->step % m->per_interval == 0 && (status = take_sample(m)) != TAKEN) return status;
    if (m->counts[SAMPLES] >= m->room || --m->budget <= 0) return PAUSED;
  }
  return TAKEN;
}
