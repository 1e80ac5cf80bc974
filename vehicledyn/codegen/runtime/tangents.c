/* Tangents along motions whose nodes are known: a lane for each motion, or for each step.
   The steps are those that found the nodes, of order five, so that the tangents are as stable. The
   elements of the Jacobian follow a parabola through those at the begin, in the middle and at the
   end of a step, or a line where those in the middle are not given. */

#define VD_SIDE 6
#define NBLOCK ((NBY + VD_SIDE - 1) / VD_SIDE)
#define NCARRIED 6

/* Tangents lie in blocks of VD_SIDE columns, of which a step holds one at a time near by. */
typedef real vd_block[NROW][VD_SIDE];
typedef struct {
  real jacobian[NCARRIED][NENTRY], middle[NENTRY];
  vd_block y[NBLOCK], rates[NCARRIED], stage;
} vd_room;

static const double vd_moments[NCARRIED] = {0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0};

/* out = J tangent, to whose column `parameter`, if any, the derivatives by that are added. */
static void vd_carry_block(const real *s, const vd_block tangent, int parameter, vd_block out) {
  for (int row = 0; row < NROW; row++) {
    real a = vd_all(0.0), b = a, c = a, d = a, e = a, f = a, *to = out[row];
    for (int k = first_of_row[row]; k < first_of_row[row + 1]; k++) {
      const real by = s[entry_of[k]], *from = tangent[column_of[k]];
      a = vd_fma(by, from[0], a);
      b = vd_fma(by, from[1], b);
      c = vd_fma(by, from[2], c);
      d = vd_fma(by, from[3], d);
      e = vd_fma(by, from[4], e);
      f = vd_fma(by, from[5], f);
    }
    to[0] = a, to[1] = b, to[2] = c, to[3] = d, to[4] = e, to[5] = f;
    if (parameter >= 0 && by_parameter[row] >= 0)
      to[parameter] = to[parameter] + s[by_parameter[row]];
  }
}

/* out = y + h (weights · rates) of the first `count` rates. */
static void vd_stage(const vd_block y, real h, const double *weights, int count,
                     const vd_block *rates, vd_block out) {
  real part[NCARRIED];
  for (int k = 0; k < count; k++) part[k] = h * weights[k];
  for (int row = 0; row < NROW; row++)
    for (int j = 0; j < VD_SIDE; j++) {
      real sum = y[row][j];
      for (int k = 0; k < count; k++) sum = vd_fma(part[k], rates[k][row][j], sum);
      out[row][j] = sum;
    }
}

/* Carry a block through a step with the Jacobians of its stages. */
static void vd_carry_step(vd_room *r, int block, real h, int parameter) {
  for (int number = 0; number < NCARRIED; number++) {
    vd_stage(r->y[block], h, vd_weights[number ? number - 1 : 0], number, r->rates, r->stage);
    vd_carry_block(r->jacobian[number], r->stage, parameter, r->rates[number]);
  }
  vd_stage(r->y[block], h, vd_weights[NCARRIED - 1], NCARRIED, r->rates, r->y[block]);
}

/* Carry one tangent through a step with the Jacobians of its stages. */
static void vd_carry_one(const vd_room *r, real h, real *y) {
  real rates[NCARRIED][NROW], stage[NROW];
  for (int number = 0; number <= NCARRIED; number++) {
    const double *weights = vd_weights[number ? number - 1 : 0];
    real part[NCARRIED], *to = number == NCARRIED ? y : stage;
    for (int k = 0; k < number; k++) part[k] = h * weights[k];
    for (int row = 0; row < NROW; row++) {
      real sum = y[row];
      for (int k = 0; k < number; k++) sum = vd_fma(part[k], rates[k][row], sum);
      to[row] = sum;
    }
    if (number == NCARRIED) break;
    for (int row = 0; row < NROW; row++) {
      real sum = vd_all(0.0);
      for (int k = first_of_row[row]; k < first_of_row[row + 1]; k++)
        sum = vd_fma(r->jacobian[number][entry_of[k]], stage[column_of[k]], sum);
      rates[number][row] = sum;
    }
  }
}

/* Find the Jacobians of the stages of a step in each lane from the rows of `entries` that `rows`
   tells: those at its begin, in its middle, where it is not negative, and at its end. */
static void vd_between(vd_room *r, const double *entries, const long long *steps,
                       const long long *rows) {
  real *first = r->jacobian[0], *last = r->jacobian[NCARRIED - 1];
  for (int lane = 0; lane < VD_LANES; lane++) {
    const long long *own = rows + 3 * steps[lane];
    const double *begin = entries + own[0] * NENTRY, *end = entries + own[2] * NENTRY;
    const double *middle = own[1] < 0 ? NULL : entries + own[1] * NENTRY;
    for (int k = 0; k < NENTRY; k++) {
      ((double *)(first + k))[lane] = begin[k];
      ((double *)(last + k))[lane] = end[k];
      ((double *)(r->middle + k))[lane] = middle ? middle[k] : 0.5 * (begin[k] + end[k]);
    }
  }
  for (int number = 1; number < NCARRIED - 1; number++) {
    const double t = vd_moments[number];
    const real a = vd_all((1.0 - t) * (1.0 - 2.0 * t)), b = vd_all(4.0 * t * (1.0 - t)),
               c = vd_all(t * (2.0 * t - 1.0));
    real *to = r->jacobian[number];
    for (int k = 0; k < NENTRY; k++)
      to[k] = vd_fma(a, first[k], vd_fma(b, r->middle[k], c * last[k]));
  }
}

VD_EXPORT const long long vd_n_entries = NENTRY;

static vd_room *vd_new_room(void **whole) {
  *whole = malloc(sizeof(vd_room) + 64);
  return *whole ? (void *)(((size_t)*whole + 63) / 64 * 64) : NULL;
}

/* Values (count, NROW) at points (count, NPOINT) and the elements (count, NENTRY) of the Jacobian
   that are not zero. */
VD_EXPORT void vd_entries(long long count, const double *points, const double *p, double *values,
                          double *entries) {
  real given[NP + NT + 1], c[NC + NT + 1], x[NROW], f[NROW], s[NENTRY];
  vd_spread(NP + NT, p, given);
  prepare(given, c);
  vd_spread(NT, p + NP, c + NC);
  for (long long first = 0; first < count; first += VD_LANES) {
    for (int lane = 0; lane < VD_LANES; lane++) {
      const double *own = points + (first + lane < count ? first + lane : count - 1) * NROW;
      for (int row = 0; row < NROW; row++) ((double *)(x + row))[lane] = own[row];
    }
    evaluate(x, c, f, s);
    for (int lane = 0; lane < VD_LANES && first + lane < count; lane++) {
      for (int row = 0; row < NROW; row++)
        values[(first + lane) * NROW + row] = VD_LANE(f[row], lane);
      for (int k = 0; k < NENTRY; k++)
        entries[(first + lane) * NENTRY + k] = VD_LANE(s[k], lane);
    }
  }
}

/* By how much rates carried through each step as a tangent miss those at its end, errors (count,),
   part of the largest: also where the rates have a kink in between they must be those. Returns 1
   where there is no room. */
VD_EXPORT long long vd_missed(long long count, const double *sizes, const long long *rows,
                              const double *values, const double *entries, const double *scales,
                              double *errors) {
  void *whole;
  vd_room *r = vd_new_room(&whole);
  if (!r) return 1;
  for (long long first = 0; first < count; first += VD_LANES) {
    long long step[VD_LANES];
    real h, y[NROW];
    for (int lane = 0; lane < VD_LANES; lane++) {
      step[lane] = first + lane < count ? first + lane : count - 1;
      ((double *)&h)[lane] = sizes[step[lane]];
      const double *own = values + rows[3 * step[lane]] * NROW;
      for (int row = 0; row < NROW; row++) ((double *)(y + row))[lane] = own[row];
    }
    vd_between(r, entries, step, rows);
    vd_carry_one(r, h, y);
    real missed = vd_all(0.0), size = vd_all(DBL_MIN);
    for (int row = 0; row < NROW; row++) {
      real end;
      for (int lane = 0; lane < VD_LANES; lane++)
        ((double *)&end)[lane] = values[rows[3 * step[lane] + 2] * NROW + row];
      const real gap = vd_abs(y[row] - end) * (1.0 / scales[row]);
      missed = vd_larger(vd_select(vd_finite(gap), gap, vd_all(INFINITY)), missed);
      size = vd_larger(vd_abs(end) * (1.0 / scales[row]), size);
    }
    missed = missed / size;
    for (int lane = 0; lane < VD_LANES; lane++) errors[step[lane]] = VD_LANE(missed, lane);
  }
  free(whole);
  return 0;
}

/* Maps (count, NPOINT, NBY) of motions by their states and the parameter. The steps of a motion,
   `steps` (count,) of them, lie behind each other from `begins` (count,) on; sizes (n_steps,) and
   rows (n_steps, 3) are theirs. Returns 1 where there is no room. */
VD_EXPORT long long vd_tangents(long long count, const long long *begins, const long long *steps,
                                const double *sizes, const long long *rows, const double *entries,
                                double *maps) {
  void *whole;
  vd_room *r = vd_new_room(&whole);
  if (!r) return 1;
  for (long long group = 0; group < count; group += VD_LANES) {
    long long longest = 0, own[VD_LANES], at[VD_LANES];
    for (int lane = 0; lane < VD_LANES; lane++) {
      own[lane] = group + lane < count ? group + lane : count - 1;
      longest = steps[own[lane]] > longest ? steps[own[lane]] : longest;
    }
    for (int block = 0; block < NBLOCK; block++)
      for (int row = 0; row < NROW; row++)
        for (int j = 0; j < VD_SIDE; j++)
          r->y[block][row][j] = vd_all(row == block * VD_SIDE + j ? 1.0 : 0.0);
    for (long long step = 0; step < longest; step++) {
      real h;
      for (int lane = 0; lane < VD_LANES; lane++) {
        const int going = step < steps[own[lane]];
        at[lane] = begins[own[lane]] + (going ? step : 0);
        ((double *)&h)[lane] = going ? sizes[at[lane]] : 0.0;
      }
      vd_between(r, entries, at, rows);
      for (int block = 0; block < NBLOCK; block++)
        vd_carry_step(r, block, h, NPOINT / VD_SIDE == block ? NPOINT % VD_SIDE : -1);
    }
    for (int lane = 0; lane < VD_LANES && group + lane < count; lane++)
      for (int row = 0; row < NROW; row++)
        for (int j = 0; j < NBY; j++)
          maps[((group + lane) * NROW + row) * NBY + j] =
              VD_LANE(r->y[j / VD_SIDE][row][j % VD_SIDE], lane);
  }
  free(whole);
  return 0;
}
