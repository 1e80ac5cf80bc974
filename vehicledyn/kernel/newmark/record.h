/* One run with steps of Newmark's family on the rates of any kernel, whose functions come as
   pointers: compiled once for each number of lanes, not for each model. A `real` holds a number of
   each case, see real.h. reduced_steps.py and family.py hold the same algorithm; change them
   together. */
#if VD_LANES == 1
#define VD_TAKE(mask, a, b) (a)
#else
#define VD_TAKE(mask, a, b) vd_select(mask, a, b)
#endif

enum { TAKEN, REFUSED, NEEDS_JACOBIAN, CROSSED, STUCK, INEXACT, UNSOLVED, INACCURATE, PAUSED };
enum { SAMPLES, STEPS, EVALUATIONS, ITERATIONS, WHERE };
enum { NONE, KEPT, FRESH };
enum { SOLVED = 0, EVENT = 5 };
enum { MOST_LANES = 8 };

typedef int (*vd_solver)(double, const double *, double *, const double *, long long *, double *);
typedef int (*vd_lane_rates)(const real *, const real *, real *, const real *, real *, int *, int *,
                             double *);
typedef int (*vd_lane_sample)(double, int, double, const real *, const real *, const real *, double,
                              int, const int *, double *, long long, real *, long long *, int *,
                              int *, double *);
typedef void (*vd_function)(double, const double *, const double *, const double *, double *);
typedef void (*vd_points)(long long, const double *, const double *, double *, double *);
typedef void (*vd_surveyor)(long long, const double *, const double *, const double *,
                            const double *, double *, double *);

/* A point with its rates, the auxiliary rates that a step of some size left, and what it added to
   these and to the unknowns; the size is zero where the motion starts. Of steps with multipliers
   the rates are those of the rows, the forces are multipliers, then what corrects positions, and
   the change where the motion starts is the third derivative that the constraints demand. */
struct place {
  double time[MOST_LANES], size[MOST_LANES];
  real *x, *z, *rates, *auxiliary, *change, *drift;
  double *forces;
};

/* What steps with multipliers need besides; the residual is null for others, and so is the output
   where the channels are those of the rates. The spread is the Jacobian of the constraints column by
   column, of which ``arms`` has those of the begin of a step and of the latest iteration;
   ``lightness`` is what multiplies each column. ``back`` puts the velocities of the place at the time
   ``back_from`` onto the constraints, where a step of another size begins. */
struct constrained {
  vd_points residual, output, spread;
  const double *given, *l_values, *u_values, *lightness, *back;
  double *arms;
  const int *l_starts, *l_rows, *u_starts, *u_rows, *row_place, *column_place;
  const int *arm_starts, *arm_columns;
  long long n_multipliers, n_others, is_stabilised;
  double lead, scale, lever, first_order_mass, first_order_gamma, close_states, close_forces;
  double back_from;
};

/* Rows of the entries of a triangular factor by columns, and the same as runs of rows in turn. */
struct triangle {
  const int *starts, *rows, *run_starts, *run_firsts, *run_counts;
};

/* Which entries the Jacobian of the rates has, by columns, and where they go in the iteration
   matrix, whose rows and columns stand in the order of elimination; a lever is that of positions,
   of velocities or of other states. Columns of a colour share no row. ``below`` are the rows of
   the factors under each diagonal, ``above`` those over it. */
struct pattern {
  const int *starts, *rows, *places, *levers, *colour_starts, *colour_columns, *order;
  struct triangle below, above;
  long long n_colours, n_entries;
};

/* The matrix of one lane: for which size of step it is, whether it is out of date, whether its
   Jacobian is there, and whether its factors are full; how often steps of several lanes are halved
   in this one; how many evaluations a step with the Jacobian took at least, and how many more the
   others took together. */
struct matrix {
  double size;
  long long is_stale, has_jacobian, is_full, halvings, fewest, wasted;
};

/* newmark_code.py lays it out alike. Lists of places in the state: rows are those but for
   positions, pairs the places of velocities among the rows. */
struct run {
  vd_solver solve;
  vd_function rates_at, outputs, events;
  vd_surveyor survey;
  vd_lane_rates lane_rates;
  vd_lane_sample lane_sample;
  const real *constants;
  const double *tolerances, *new_mass, *gamma;
  const int *rows, *positions, *velocities, *pairs, *rising, *falling, *channels;
  int *sides, *from_rows, *lane_status, *lane_where;
  double *jacobian, *dense, *base, *lane_residual, *lane_samples;
  real *lower, *upper, *inverse, *work, *given, *watched;
  double *xs, *zs, *ys, *figures;
  long long *counts, *good;
  struct place at, found;
  long long n_states, n_unknowns, n_outputs, n_blocks, n_events, n_rows, n_pairs;
  long long n_constants, n_channels, stride, halvings, is_within, step, last, per_interval, budget;
  long long room, status;
  double alpha_m, alpha_f, beta, second_order_gamma, tolerance, shortest, blind_until;
  double start, interval, end, whole, to, error, least, most, wanted, weak;
  double first_order_gamma, share;
  long long n_rates, n_watched;
  struct pattern pattern;
  struct constrained constrained;
  struct matrix matrix[MOST_LANES];
};
