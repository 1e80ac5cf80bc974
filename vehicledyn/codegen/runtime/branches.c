/* Functions whose signs choose between branches of laws, watched along a motion: before a step in
   which one of them changes its branch, what is taken at once ends. */

#if NK
#define BRANCH_NOISE 1e-9 /* part of a function's size that it changes by, if not by rounding */

/* Parameters in lanes; of NK functions whether they count cells of a table, whether their changes
   are passed over, their branches, 0 where these are not known, how often they have changed, their
   largest values, and those at the point reached. */
struct branches {
  const real *p;
  const int *is_table, *skipped;
  int *marks, *changes;
  double *sizes, *before;
};

void vd_branches_apart(const real *t, const real *x, const real *z, const real *p, real *values);

static int branch_of(double value, int is_table) {
  if (value != value) return 0;
  return is_table ? (int)floor(value) + 1 : (value > 0.0) - (value < 0.0);
}

/* Where a function changes its branch between lanes, the first of them and the point reached
   included: that lane, or `count` if there is none. With `kept` the changes are entered. */
static int branch_change(struct branches *b, int k, const real *value, int count, int kept) {
  int mark = b->marks[k];
  double before = b->before[k], size = b->sizes[k];
  for (int lane = 0; lane < count; lane++) {
    const double own = VD_LANE(*value, lane);
    const int branch = branch_of(own, b->is_table[k]);
    size = fabs(own) > size ? fabs(own) : size;
    if (mark && branch && branch != mark && fabs(own - before) > BRANCH_NOISE * size) {
      if (!kept) return lane;
      b->changes[k]++;
    }
    mark = branch ? branch : mark;
    before = own;
  }
  if (kept) b->marks[k] = mark, b->before[k] = before, b->sizes[k] = size;
  return count;
}

static int on_one_side(const struct branches *b, int k, real value) {
  const real side = value * (double)b->marks[k];
  return !b->is_table[k] && !vd_any(vd_not(vd_lt(vd_all(0.0), side)));
}

/* How many of the steps that end at up to VD_LANES points are taken before one with a corner. */
static int steps_to_corner(struct branches *b, const struct points *p, int count) {
  real values[NK + 1];
  int taken = count;
  vd_branches_apart(&p->t, p->x, p->z, b->p, values);
  for (int k = 0; k < NK; k++) {
    if (b->skipped[k] || on_one_side(b, k, values[k])) continue;
    taken = branch_change(b, k, values + k, taken, 0);
  }
  for (int k = 0; taken && k < NK; k++)
    if (on_one_side(b, k, values[k]) && !vd_any(vd_lt(vd_all(b->sizes[k]), vd_abs(values[k]))))
      b->before[k] = VD_LANE(values[k], taken - 1);
    else
      branch_change(b, k, values + k, taken, 1);
  return taken;
}

/* Values (count, NK) at points. */
VD_EXPORT void vd_branch_values(long long count, const double *t, const double *x, const double *z,
                                const real *p, double *values) {
  struct points points;
  real found[NK + 1];
  for (long long first = 0; first < count; first += VD_LANES, values += NK * VD_LANES) {
    const int some = count - first < VD_LANES ? (int)(count - first) : VD_LANES;
    gather_places(&points, some, t + first, x + first * NX, z + first * NZ);
    vd_branches_apart(&points.t, points.x, points.z, p, found);
    for (int lane = 0; lane < some; lane++)
      for (int k = 0; k < NK; k++) values[lane * NK + k] = VD_LANE(found[k], lane);
  }
}
#endif
