/* The numbers of a kernel on a GPU: one case a thread, so a `real` is a double; what real.h and
   elementary.c are to a processor. Products and sums are fused where they are asked for by name:
   compile with --fmad=false. */
#define VD_LANES 1
#define VD_DEVICE static __device__
#define VD_EXPORT static __device__
#define VD_APART __noinline__
#define VD_INLINE static __device__ __forceinline__
#define VD_PACK(a, b, c, d) {{a, b, c, d}}
#define VD_LANE(value, lane) (value)
#define VD_HOLDS(mask, lane) (mask)
#define restrict __restrict__
#define VD_ADDRESS 0xfffffffffffffLL
#ifndef DBL_MAX
#define DBL_MAX 1.7976931348623157e308
#endif

typedef double real;
typedef int vd_mask;
typedef struct { real item[4]; } vd_pack;
#define vd_all(a) (a)
#define vd_abs(a) fabs(a)
#define vd_sqrt(a) sqrt(a)
#define vd_fma(a, b, c) fma(a, b, c)
#define vd_fms(a, b, c) fma(a, b, -(c))
#define vd_fnma(a, b, c) fma(-(a), b, c)
#define vd_fnms(a, b, c) fma(-(a), b, -(c))
VD_INLINE vd_mask vd_lt(real a, real b) { return a < b; }
VD_INLINE vd_mask vd_le(real a, real b) { return a <= b; }
VD_INLINE vd_mask vd_eq(real a, real b) { return a == b; }
VD_INLINE vd_mask vd_ne(real a, real b) { return a != b; }
VD_INLINE vd_mask vd_not(vd_mask a) { return !a; }
VD_INLINE vd_mask vd_and(vd_mask a, vd_mask b) { return a & b; }
VD_INLINE vd_mask vd_or(vd_mask a, vd_mask b) { return a | b; }
VD_INLINE vd_mask vd_every(int a) { return a; }
VD_INLINE int vd_any(vd_mask a) { return a; }
VD_INLINE vd_mask vd_true(real a) { return a != 0.0; }
VD_INLINE real vd_real(vd_mask a) { return a ? 1.0 : 0.0; }
VD_INLINE real vd_only(vd_mask m, real a) { return m ? a : 0.0; }
VD_INLINE real vd_select(vd_mask m, real a, real b) { return m ? a : b; }
VD_INLINE real vd_lesser(real a, real b) { return a < b ? a : b; }
VD_INLINE real vd_larger(real a, real b) { return a > b ? a : b; }
VD_INLINE real vd_min(real a, real b) { return a < b || b != b ? a : b; }
VD_INLINE real vd_max(real a, real b) { return b < a || b != b ? a : b; }
VD_INLINE real vd_sign(real a) { return a < 0.0 ? -1.0 : 0.0 < a ? 1.0 : a; }

/* Tables: origin, 1/step, step, last cell and address of the cells lie side by side at t. Each
   place has a cell inside the table, one that is no number has the last. */
VD_INLINE real vd_cell(real x, const real *t) {
  return floor(vd_max(vd_min((x - t[0]) * t[1], t[3]), 0.0));
}
VD_INLINE real vd_knot(real cell, const real *t) { return t[0] + t[2] * cell; }
VD_INLINE real vd_entry(real cell, const real *t, int width, int power) {
  const long long bits = __double_as_longlong(t[4]) & VD_ADDRESS;
  return __ldg((const double *)bits + (long long)cell * width + power);
}
VD_INLINE void vd_four_entries(real cell, const real *t, real *r) {
  for (int k = 0; k < 4; k++) r[k] = vd_entry(cell, t, 4, k);
}

VD_INLINE vd_mask vd_finite(real a) { return fabs(a) <= DBL_MAX; }

#define VD_OF_ONE(name)                                               \
  VD_INLINE void vd_##name(int n, const double *a, double *r) {       \
    for (int i = 0; i < n; i++) r[i] = name(a[i]);                    \
  }
#define VD_OF_TWO(name)                                                               \
  VD_INLINE void vd_##name(int n, const double *a, const double *b, double *r) {      \
    for (int i = 0; i < n; i++) r[i] = name(a[i], b[i]);                              \
  }
VD_INLINE void vd_sincos(int n, const double *a, double *s, double *c) {
  for (int i = 0; i < n; i++) {
    s[i] = sin(a[i]);
    c[i] = cos(a[i]);
  }
}
VD_OF_ONE(sin)
VD_OF_ONE(atan)
VD_OF_ONE(asin)
VD_OF_ONE(acos)
VD_OF_ONE(exp)
VD_OF_ONE(log)
VD_OF_ONE(tanh)
VD_OF_ONE(sinh)
VD_OF_ONE(cosh)
VD_OF_ONE(asinh)
VD_OF_ONE(acosh)
VD_OF_ONE(atanh)
VD_OF_ONE(floor)
VD_OF_ONE(ceil)
VD_OF_ONE(erf)
VD_OF_ONE(expm1)
VD_OF_ONE(log1p)
VD_OF_TWO(atan2)
VD_OF_TWO(pow)
VD_OF_TWO(fmod)
VD_OF_TWO(remainder)
VD_OF_TWO(copysign)
VD_OF_TWO(hypot)
