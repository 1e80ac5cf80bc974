/* Elementary functions of n doubles at once, in registers of any width.

   The arrays hold numbers up to the next multiple of VD_WIDTH; what lies behind n is computed
   too. Each element is computed by itself, so neither its place nor n nor the width matter to it.
   The few elements outside of the range of a method are given to the C library. Errors are
   below two units in the last place; a test measures them.

   Sources: coefficients of sin, cos, atan and log: Sun's fdlibm (1993), freely distributable;
   of tanh: S. Moshier's Cephes library (1989). exp: Taylor's series. */

#define VD_EACH(n) for (int i = 0; i < (n); i += VD_WIDTH)
#define VD_WIDE(a) (*(const vd_wide *)((a) + i))
#define VD_STORE(r, value) (*(vd_wide *)((r) + i) = (value))

VD_INLINE vd_wide vd_w(double a) { return a - (vd_wide){0.0}; }
VD_INLINE vd_whole vd_i(long long a) { return a - (vd_whole){0}; }
/* Bits that are added and shifted: beyond the last they are lost. */
typedef unsigned long long vd_natural __attribute__((vector_size(8 * VD_WIDTH), aligned(8)));
/* a where the bits of m are set, else b. */
VD_INLINE vd_wide vd_mix(vd_whole m, vd_wide a, vd_wide b) {
  return (vd_wide)((m & (vd_whole)a) | (~m & (vd_whole)b));
}
VD_INLINE vd_wide vd_abs_wide(vd_wide a) {
  return (vd_wide)((vd_whole)a & vd_i(0x7fffffffffffffffLL));
}
#define VD_SIGN vd_i((long long)0x8000000000000000ULL)
/* a, which is not negative, with the sign of b. */
VD_INLINE vd_wide vd_signed(vd_wide a, vd_wide b) {
  return (vd_wide)((vd_whole)a | ((vd_whole)b & VD_SIGN));
}
/* The few elements that the C library is asked for are found again behind a loop, so that no call
   inside it makes registers give up their coefficients. */
#define VD_FAR static VD_APART __attribute__((cold))
/* Conditions, choices and roots of wide numbers. */
#if VD_WIDTH == 8
typedef unsigned char vd_test;
#define VD_TRUE(m, k) ((m) >> (k) & 1)
VD_INLINE vd_test vd_none(void) { return 0; }
VD_INLINE vd_test vd_less(vd_wide a, vd_wide b) { return VD_LT8(a, b); }
VD_INLINE vd_wide vd_pick(vd_test m, vd_wide a, vd_wide b) { return (vd_wide)VD_PICK8(m, a, b); }
VD_INLINE int vd_some(vd_test m) { return m != 0; }
VD_INLINE vd_wide vd_sqrt_wide(vd_wide a) { return (vd_wide)VD_SQRT8(a); }
#else
typedef vd_whole vd_test;
#define VD_TRUE(m, k) ((m)[k])
VD_INLINE vd_test vd_none(void) { return (vd_test){0}; }
VD_INLINE vd_test vd_less(vd_wide a, vd_wide b) { return a < b; }
#if VD_WIDTH == 4
VD_INLINE vd_wide vd_pick(vd_test m, vd_wide a, vd_wide b) { return (vd_wide)VD_PICK4(m, a, b); }
VD_INLINE int vd_some(vd_test m) { return VD_ANY4(m); }
VD_INLINE vd_wide vd_sqrt_wide(vd_wide a) { return (vd_wide)VD_SQRT4(a); }
#else
#define vd_pick vd_mix
VD_INLINE int vd_some(vd_test m) { return (m[0] | m[1]) != 0; }
VD_INLINE vd_wide vd_sqrt_wide(vd_wide a) {
  for (int k = 0; k < VD_WIDTH; k++) a[k] = sqrt(a[k]);
  return a;
}
#endif
#endif

/* Adding and taking off 3/2 2^52 rounds to a whole number, which the low bits hold meanwhile. */
#define VD_ROUNDER 6755399441055744.0
#define VD_NEXT(value, coefficient) value = vd_fma_wide(value, z, vd_w(coefficient))

/* An angle less its quarter turns, with an error of about a unit in the last place of what is
   left. A fused sum takes a product whole; without fused sums the parts of the quarter are so
   short that their products are exact. */
VD_INLINE vd_wide vd_less_turns(vd_wide x, vd_wide turns) {
#if VD_FUSED
  x = vd_fma_wide(turns, vd_w(-1.57079632679489655800e+00), x);
  x = vd_fma_wide(turns, vd_w(-6.12323399573676603587e-17), x);
  return vd_fma_wide(turns, vd_w(1.49738490485918329680e-33), x);
#else
  const vd_wide first = x - turns * 1.57079632673412561417e+00;
  const vd_wide second = first - turns * 6.07710050630396597660e-11;
  const vd_wide lost = (first - second) - turns * 6.07710050630396597660e-11;
  return second + (lost - turns * 2.02226624879595063154e-21);
#endif
}

/* Sine and cosine of an angle within a quarter turn, and its square z. */
VD_INLINE vd_wide vd_sine_near(vd_wide y, vd_wide z) {
  vd_wide p = vd_w(1.58969099521155010221e-10);
  VD_NEXT(p, -2.50507602534068634195e-08);
  VD_NEXT(p, 2.75573137070700676789e-06);
  VD_NEXT(p, -1.98412698298579493134e-04);
  VD_NEXT(p, 8.33333333332248946124e-03);
  VD_NEXT(p, -1.66666666666666324348e-01);
  return vd_fma_wide(z * y, p, y);
}
VD_INLINE vd_wide vd_cosine_near(vd_wide z) {
  vd_wide q = vd_w(-1.13596475577881948265e-11);
  VD_NEXT(q, 2.08757232129817482790e-09);
  VD_NEXT(q, -2.75573143513906633035e-07);
  VD_NEXT(q, 2.48015872894767294178e-05);
  VD_NEXT(q, -1.38888888888741095749e-03);
  VD_NEXT(q, 4.16666666666666019037e-02);
  VD_NEXT(q, -0.5);
  VD_NEXT(q, 1.0);
  return q;
}

/* The sine of -0 is +0. Angles that round to no quarter turn are their own rest: most angles of
   a vehicle, so registers full of them take the short way, to the same bits. */
#define VD_NO_TURN 0.785
#define VD_LARGE_ANGLE 1e6

/* Sine, and cosine where c is wanted, of angles of any size but very large ones. */
VD_INLINE void vd_turned(vd_wide x, vd_wide *sine, vd_wide *cosine) {
  const vd_wide shifted = vd_fma_wide(x, vd_w(0.63661977236758134308), vd_w(VD_ROUNDER));
  const vd_wide turns = shifted - VD_ROUNDER;
  const vd_whole quarter = (vd_whole)shifted;
  const vd_wide y = vd_less_turns(x, turns), z = y * y;
  const vd_wide near_sine = vd_sine_near(y, z), near_cosine = vd_cosine_near(z);
  const vd_whole odd = -(quarter & 1), sign_of_sine = (quarter << 62) & VD_SIGN;
  *sine = (vd_wide)((vd_whole)vd_mix(odd, near_cosine, near_sine) ^ sign_of_sine);
  if (!cosine) return;
  const vd_whole sign_of_cosine = sign_of_sine ^ (odd & VD_SIGN);
  *cosine = (vd_wide)((vd_whole)vd_mix(odd, near_sine, near_cosine) ^ sign_of_cosine);
}

VD_FAR void vd_sincos_far(int n, const double *a, double *s, double *c) {
  for (int i = 0; i < n; i++)
    if (!(fabs(a[i]) < VD_LARGE_ANGLE)) s[i] = sin(a[i]), c[i] = cos(a[i]);
}
static VD_APART void vd_sincos(int n, double *a, double *s, double *c) {
  vd_test far = vd_none();
  VD_EACH(n) {
    const vd_wide x = VD_WIDE(a), size = vd_abs_wide(x);
    if (!vd_some(~vd_less(size, vd_w(VD_NO_TURN)))) {
      const vd_wide z = x * x;
      VD_STORE(s, vd_sine_near(x + 0.0, z));
      VD_STORE(c, vd_cosine_near(z));
      continue;
    }
    vd_wide sine, cosine;
    vd_turned(x, &sine, &cosine);
    VD_STORE(s, sine);
    VD_STORE(c, cosine);
    far |= ~vd_less(size, vd_w(VD_LARGE_ANGLE));
  }
  if (vd_some(far)) vd_sincos_far(n, a, s, c);
}

/* The sine of vd_sincos. */
VD_FAR void vd_sin_far(int n, const double *a, double *s) {
  for (int i = 0; i < n; i++)
    if (!(fabs(a[i]) < VD_LARGE_ANGLE)) s[i] = sin(a[i]);
}
static VD_APART void vd_sin(int n, double *a, double *s) {
  vd_test far = vd_none();
  VD_EACH(n) {
    const vd_wide x = VD_WIDE(a), size = vd_abs_wide(x);
    if (!vd_some(~vd_less(size, vd_w(VD_NO_TURN)))) {
      VD_STORE(s, vd_sine_near(x + 0.0, x * x));
      continue;
    }
    vd_wide sine;
    vd_turned(x, &sine, 0);
    VD_STORE(s, sine);
    far |= ~vd_less(size, vd_w(VD_LARGE_ANGLE));
  }
  if (vd_some(far)) vd_sin_far(n, a, s);
}

/* (atan x - x) / x^3 of z = x^2, for |x| below the tangent of 22.5 degrees. */
VD_INLINE vd_wide vd_atan_series(vd_wide z) {
  vd_wide p = vd_w(0.021258265202632331938);
  VD_NEXT(p, -0.043589673095549364756);
  VD_NEXT(p, 0.056924951125022744292);
  VD_NEXT(p, -0.066411129005250079750);
  VD_NEXT(p, 0.076900673596383494670);
  VD_NEXT(p, -0.090907823469368162024);
  VD_NEXT(p, 0.11111106650845162306);
  VD_NEXT(p, -0.14285714195196932155);
  VD_NEXT(p, 0.19999999999088227086);
  VD_NEXT(p, -0.33333333333330148055);
  return p;
}

#define VD_TAN_NEAR 0.41421356237309503

/* Arc tangent of a / b >= 0, for a, b >= 0, not both zero: the angle from the nearest of the
   directions 0, 45 and 90 degrees, and that of the direction. What the rounded direction lacks is
   added where the ratio itself is not exact: 3.9e-17 of it, for both. */
VD_INLINE vd_wide vd_atan_ratio(vd_wide a, vd_wide b, int is_exact) {
  const vd_test steep = vd_less(VD_TAN_NEAR * b, a);
  const vd_test steeper = vd_less(2.41421356237309510 * b, a);
  const vd_wide across = vd_pick(steeper, -b, vd_pick(steep, a - b, a));
  const vd_wide along = vd_pick(steeper, a, vd_pick(steep, a + b, b));
  const vd_wide base = vd_pick(steeper, vd_w(1.57079632679489655800),
                               vd_pick(steep, vd_w(0.78539816339744827900), vd_w(0.0)));
  const vd_wide x = across / along, z = x * x, p = vd_atan_series(z);
  if (is_exact) return base + vd_fma_wide(z * x, p, x);
  return base + (x + vd_fma_wide(z * x, p, base * 3.9e-17));
}

/* Registers full of numbers whose arc tangent is nearest to 0 take a short way, to the same bits. */
static VD_APART void vd_atan(int n, double *a, double *r) {
  VD_EACH(n) {
    const vd_wide x = VD_WIDE(a), size = vd_abs_wide(x);
    if (!vd_some(~vd_less(size, vd_w(VD_TAN_NEAR)))) {
      const vd_wide z = size * size;
      VD_STORE(r, vd_signed(vd_fma_wide(z * size, vd_atan_series(z), size), x));
      continue;
    }
    VD_STORE(r, vd_signed(vd_atan_ratio(size, vd_w(1.0), 1), x));
  }
}

static VD_APART void vd_atan2(int n, double *a, double *b, double *r) {
  VD_EACH(n) {
    const vd_wide y = VD_WIDE(a), x = VD_WIDE(b), ay = vd_abs_wide(y), ax = vd_abs_wide(x);
    const vd_wide angle = vd_atan_ratio(ay, ax, 0);
    const vd_wide behind = 3.14159265358979311600 - (angle - 1.22464679914735320717e-16);
    VD_STORE(r, vd_signed(vd_mix((vd_whole)x < 0, behind, angle), y));
    const vd_wide larger = vd_pick(vd_less(ax, ay), ay, ax),
                  smaller = vd_pick(vd_less(ax, ay), ax, ay);
    const vd_test odd = ~(vd_less(larger, vd_w(1e150)) & vd_less(vd_w(1e-150), larger) &
                          (vd_less(vd_w(1e-150), smaller) | ~vd_less(vd_w(0.0), smaller)));
    if (vd_some(odd))
      for (int k = 0; k < VD_WIDTH; k++)
        if (VD_TRUE(odd, k)) r[i + k] = atan2(y[k], x[k]);
  }
}

/* asin x = atan2(x, w), acos x = atan2(w, x) with w = sqrt(1 - x x). */
VD_INLINE vd_wide vd_beside(vd_wide x) {
#if VD_FUSED
  return vd_sqrt_wide(vd_fma_wide(-x, x, vd_w(1.0)));
#else
  return vd_sqrt_wide((1.0 - x) * (1.0 + x));
#endif
}

static VD_APART void vd_asin(int n, double *a, double *r) {
  VD_EACH(n) {
    const vd_wide x = VD_WIDE(a), w = vd_beside(x);
    VD_STORE(r, vd_signed(vd_atan_ratio(vd_abs_wide(x), w, 0), x));
    const vd_test odd = vd_less(vd_w(1.0), vd_abs_wide(x));
    if (vd_some(odd))
      for (int k = 0; k < VD_WIDTH; k++)
        if (VD_TRUE(odd, k)) r[i + k] = asin(x[k]);
  }
}

static VD_APART void vd_acos(int n, double *a, double *r) {
  VD_EACH(n) {
    const vd_wide x = VD_WIDE(a), w = vd_beside(x);
    const vd_wide angle = vd_atan_ratio(w, vd_abs_wide(x), 0);
    const vd_wide behind = 3.14159265358979311600 - (angle - 1.22464679914735320717e-16);
    VD_STORE(r, vd_pick(vd_less(x, vd_w(0.0)), behind, angle));
    const vd_test odd = vd_less(vd_w(1.0), vd_abs_wide(x));
    if (vd_some(odd))
      for (int k = 0; k < VD_WIDTH; k++)
        if (VD_TRUE(odd, k)) r[i + k] = acos(x[k]);
  }
}

/* For |x| < 700. */
VD_INLINE vd_wide vd_exp_wide(vd_wide x) {
  const vd_wide shifted = vd_fma_wide(x, vd_w(1.44269504088896338700), vd_w(VD_ROUNDER));
  const vd_wide k = shifted - VD_ROUNDER;
  const vd_wide high = vd_fma_wide(k, vd_w(-6.93147180369123816490e-01), x);
  const vd_wide z = vd_fma_wide(k, vd_w(-1.90821492927058770002e-10), high);
  const vd_wide lost = vd_fma_wide(k, vd_w(-1.90821492927058770002e-10), high - z);
  vd_wide p = vd_w(1.0 / 6227020800.0);
  VD_NEXT(p, 1.0 / 479001600.0);
  VD_NEXT(p, 1.0 / 39916800.0);
  VD_NEXT(p, 1.0 / 3628800.0);
  VD_NEXT(p, 1.0 / 362880.0);
  VD_NEXT(p, 1.0 / 40320.0);
  VD_NEXT(p, 1.0 / 5040.0);
  VD_NEXT(p, 1.0 / 720.0);
  VD_NEXT(p, 1.0 / 120.0);
  VD_NEXT(p, 1.0 / 24.0);
  VD_NEXT(p, 1.0 / 6.0);
  VD_NEXT(p, 0.5);
  const vd_wide value = 1.0 + (z + vd_fma_wide(z * z, p, lost));
  const vd_natural power = ((vd_natural)shifted + 1023ULL) << 52;
  return value * (vd_wide)power;
}

#define VD_LARGE_POWER 700.0
VD_FAR void vd_exp_far(int n, const double *a, double *r) {
  for (int i = 0; i < n; i++)
    if (!(fabs(a[i]) < VD_LARGE_POWER)) r[i] = exp(a[i]);
}
static VD_APART void vd_exp(int n, double *a, double *r) {
  vd_test far = vd_none();
  VD_EACH(n) {
    const vd_wide x = VD_WIDE(a);
    VD_STORE(r, vd_exp_wide(x));
    far |= ~vd_less(vd_abs_wide(x), vd_w(VD_LARGE_POWER));
  }
  if (vd_some(far)) vd_exp_far(n, a, r);
}

static VD_APART void vd_tanh(int n, double *a, double *r) {
  VD_EACH(n) {
    const vd_wide x = VD_WIDE(a), size = vd_abs_wide(x);
    const vd_wide held = vd_pick(vd_less(vd_w(20.0), size), vd_w(20.0), size);
    const vd_wide large = 1.0 - 2.0 / (vd_exp_wide(2.0 * held) + 1.0), z = x * x;
    vd_wide p = vd_w(-9.64399179425052238628e-01);
    VD_NEXT(p, -9.92877231001918586564e+01);
    VD_NEXT(p, -1.61468768441708447952e+03);
    vd_wide q = z + 1.12811678491632931402e+02;
    VD_NEXT(q, 2.23548839060100448583e+03);
    VD_NEXT(q, 4.84406305325125486048e+03);
    const vd_wide small = vd_fma_wide(x * z, p / q, x);
    VD_STORE(r, vd_signed(vd_pick(vd_less(size, vd_w(0.625)), small, large), x));
  }
}

static VD_APART void vd_log(int n, double *a, double *r) {
  VD_EACH(n) {
    const vd_wide x = VD_WIDE(a);
    /* x = m 2^k with sqrt(1/2) <= m < sqrt(2); k + 1022, which is not negative, is found first. */
    const vd_natural above = ((vd_natural)x - 0x0006a09e667f3bcdULL) >> 52;
    const vd_whole whole = (vd_whole)above - 1022;
    const vd_wide m = (vd_wide)((vd_natural)x - ((above - 1022ULL) << 52));
    const vd_wide k = (vd_wide)(whole + (vd_whole)vd_w(VD_ROUNDER)) - VD_ROUNDER;
    const vd_wide f = m - 1.0, s = f / (2.0 + f), z = s * s, half = 0.5 * f * f;
    vd_wide p = vd_w(1.479819860511658591e-01);
    VD_NEXT(p, 1.531383769920937332e-01);
    VD_NEXT(p, 1.818357216161805012e-01);
    VD_NEXT(p, 2.222219843214978396e-01);
    VD_NEXT(p, 2.857142874366239149e-01);
    VD_NEXT(p, 3.999999999940941908e-01);
    VD_NEXT(p, 6.666666666666735130e-01);
    const vd_wide rest = s * (half + z * p) + k * 1.90821492927058770002e-10;
    VD_STORE(r, k * 6.93147180369123816490e-01 - ((half - rest) - f));
    const vd_test odd = vd_less(x, vd_w(DBL_MIN)) | ~vd_less(x, vd_w(INFINITY));
    if (vd_some(odd))
      for (int j = 0; j < VD_WIDTH; j++)
        if (VD_TRUE(odd, j)) r[i + j] = log(x[j]);
  }
}

#define VD_LIBRARY1(name)                                       \
  static VD_APART void vd_##name(int n, double *a, double *r) { \
    for (int i = 0; i < n; i++) r[i] = name(a[i]);              \
  }
#define VD_LIBRARY2(name)                                                  \
  static VD_APART void vd_##name(int n, double *a, double *b, double *r) { \
    for (int i = 0; i < n; i++) r[i] = name(a[i], b[i]);                   \
  }
VD_LIBRARY1(sinh)
VD_LIBRARY1(cosh)
VD_LIBRARY1(asinh)
VD_LIBRARY1(acosh)
VD_LIBRARY1(atanh)
VD_LIBRARY1(floor)
VD_LIBRARY1(ceil)
VD_LIBRARY1(erf)
VD_LIBRARY1(expm1)
VD_LIBRARY1(log1p)
VD_LIBRARY2(pow)
VD_LIBRARY2(fmod)
VD_LIBRARY2(remainder)
VD_LIBRARY2(copysign)
VD_LIBRARY2(hypot)
