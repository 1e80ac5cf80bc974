/* The numbers of a kernel: a `real` holds VD_LANES doubles, one of each case, or one double.
   Every operation acts on each lane by itself and rounds as the scalar one does, so a result
   does not depend on the number of lanes. Fused operations are asked for by name; the compiler
   adds none (-ffp-contract=off). */
#include <float.h>
#include <math.h>
#include <string.h>
#if defined(__x86_64__) && (defined(__FMA__) || defined(__AVX__))
#include <immintrin.h>
#endif

#ifndef VD_LANES
#define VD_LANES 1
#endif
#if defined(_WIN32)
#define VD_EXPORT __declspec(dllexport)
#else
#define VD_EXPORT __attribute__((visibility("default")))
#endif
#define VD_APART __attribute__((noinline))
#define VD_INLINE static inline __attribute__((always_inline))

/* Doubles in a register of this processor. */
#if defined(__AVX512F__) && defined(__AVX512DQ__)
#define VD_WIDTH 8
#elif defined(__AVX2__)
#define VD_WIDTH 4
#else
#define VD_WIDTH 2
#endif

/* Length of an array for n numbers of elementary.c. */
#define VD_ROOM(n) (((n) * VD_LANES + VD_WIDTH - 1) / VD_WIDTH * VD_WIDTH / VD_LANES)

/* Whether any of the wholes is not zero; they are all bits or none. */
#if VD_WIDTH == 8
#define VD_ANY8(m) (_mm512_movepi64_mask((__m512i)(m)) != 0)
#endif
#if VD_WIDTH >= 4
#define VD_ANY4(m) (_mm256_movemask_pd((__m256d)(m)) != 0)
#endif

typedef double vd_wide __attribute__((vector_size(8 * VD_WIDTH), aligned(8), may_alias));
typedef long long vd_whole __attribute__((vector_size(8 * VD_WIDTH), aligned(8), may_alias));

#if defined(__FMA__) || defined(__ARM_FEATURE_FMA)
#define vd_fma1(a, b, c) __builtin_fma(a, b, c)
#else
#define vd_fma1(a, b, c) ((a) * (b) + (c))
#endif

#if VD_WIDTH == 8
VD_INLINE vd_wide vd_fma_wide(vd_wide a, vd_wide b, vd_wide c) {
  return (vd_wide)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
}
#elif VD_WIDTH == 4 && defined(__FMA__)
VD_INLINE vd_wide vd_fma_wide(vd_wide a, vd_wide b, vd_wide c) {
  return (vd_wide)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
}
#else
VD_INLINE vd_wide vd_fma_wide(vd_wide a, vd_wide b, vd_wide c) {
  for (int i = 0; i < VD_WIDTH; i++) a[i] = vd_fma1(a[i], b[i], c[i]);
  return a;
}
#endif

#if VD_LANES == 1

typedef double real;
typedef int vd_mask;
#define VD_LANE(value, lane) (value)
#define vd_all(a) (a)
VD_INLINE vd_mask vd_lt(real a, real b) { return a < b; }
VD_INLINE vd_mask vd_le(real a, real b) { return a <= b; }
VD_INLINE vd_mask vd_eq(real a, real b) { return a == b; }
VD_INLINE vd_mask vd_ne(real a, real b) { return a != b; }
VD_INLINE vd_mask vd_not(vd_mask a) { return !a; }
VD_INLINE vd_mask vd_every(int a) { return a; }
VD_INLINE int vd_any(vd_mask a) { return a; }
VD_INLINE real vd_real(vd_mask a) { return a ? 1.0 : 0.0; }
VD_INLINE real vd_only(vd_mask m, real a) { return m ? a : 0.0; }
VD_INLINE real vd_select(vd_mask m, real a, real b) { return m ? a : b; }
#define vd_abs(a) fabs(a)
#define vd_sqrt(a) sqrt(a)
#define vd_fma(a, b, c) vd_fma1(a, b, c)
#define vd_fms(a, b, c) vd_fma1(a, b, -(c))
#define vd_fnma(a, b, c) vd_fma1(-(a), b, c)

#else

typedef double real __attribute__((vector_size(8 * VD_LANES), may_alias));
typedef long long vd_mask __attribute__((vector_size(8 * VD_LANES), may_alias));
#define VD_LANE(value, lane) ((value)[lane])
VD_INLINE real vd_all(double a) { return a - (real){0.0}; }
VD_INLINE vd_mask vd_lt(real a, real b) { return a < b; }
VD_INLINE vd_mask vd_le(real a, real b) { return a <= b; }
VD_INLINE vd_mask vd_eq(real a, real b) { return a == b; }
VD_INLINE vd_mask vd_ne(real a, real b) { return a != b; }
VD_INLINE vd_mask vd_not(vd_mask a) { return ~a; }
VD_INLINE vd_mask vd_every(int a) { return -(long long)(a != 0) - (vd_mask){0}; }
VD_INLINE real vd_only(vd_mask m, real a) { return (real)(m & (vd_mask)a); }
VD_INLINE real vd_real(vd_mask a) { return vd_only(a, vd_all(1.0)); }
VD_INLINE real vd_abs(real a) {
  return (real)((vd_mask)a & (0x7fffffffffffffffLL - (vd_mask){0}));
}
#if VD_LANES == 8 && VD_WIDTH == 8
#define vd_any(a) VD_ANY8(a)
#elif VD_LANES == 4 && VD_WIDTH >= 4
#define vd_any(a) VD_ANY4(a)
#else
VD_INLINE int vd_any(vd_mask a) {
  long long found = 0;
  for (int i = 0; i < VD_LANES; i++) found |= a[i];
  return found != 0;
}
#endif
VD_INLINE real vd_select(vd_mask m, real a, real b) {
  return (real)((m & (vd_mask)a) | (~m & (vd_mask)b));
}
#if VD_LANES == 8 && VD_WIDTH == 8
VD_INLINE real vd_fma(real a, real b, real c) { return (real)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c); }
VD_INLINE real vd_fms(real a, real b, real c) { return (real)_mm512_fmsub_pd((__m512d)a, (__m512d)b, (__m512d)c); }
VD_INLINE real vd_fnma(real a, real b, real c) { return (real)_mm512_fnmadd_pd((__m512d)a, (__m512d)b, (__m512d)c); }
VD_INLINE real vd_sqrt(real a) { return (real)_mm512_sqrt_pd((__m512d)a); }
#elif VD_LANES == 4 && VD_WIDTH >= 4 && defined(__FMA__)
VD_INLINE real vd_fma(real a, real b, real c) { return (real)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c); }
VD_INLINE real vd_fms(real a, real b, real c) { return (real)_mm256_fmsub_pd((__m256d)a, (__m256d)b, (__m256d)c); }
VD_INLINE real vd_fnma(real a, real b, real c) { return (real)_mm256_fnmadd_pd((__m256d)a, (__m256d)b, (__m256d)c); }
VD_INLINE real vd_sqrt(real a) { return (real)_mm256_sqrt_pd((__m256d)a); }
#else
VD_INLINE real vd_fma(real a, real b, real c) {
  for (int i = 0; i < VD_LANES; i++) a[i] = vd_fma1(a[i], b[i], c[i]);
  return a;
}
VD_INLINE real vd_fms(real a, real b, real c) { return vd_fma(a, b, -c); }
VD_INLINE real vd_fnma(real a, real b, real c) { return vd_fma(-a, b, c); }
VD_INLINE real vd_sqrt(real a) {
  for (int i = 0; i < VD_LANES; i++) a[i] = sqrt(a[i]);
  return a;
}
#endif

#endif

VD_INLINE vd_mask vd_and(vd_mask a, vd_mask b) { return a & b; }
VD_INLINE vd_mask vd_or(vd_mask a, vd_mask b) { return a | b; }
VD_INLINE vd_mask vd_true(real a) { return vd_ne(a, vd_all(0.0)); }
VD_INLINE real vd_min(real a, real b) { return vd_select(vd_or(vd_lt(a, b), vd_ne(b, b)), a, b); }
VD_INLINE real vd_max(real a, real b) { return vd_select(vd_or(vd_lt(b, a), vd_ne(b, b)), a, b); }
VD_INLINE real vd_sign(real a) {
  const real zero = vd_all(0.0);
  return vd_select(vd_lt(a, zero), vd_all(-1.0), vd_select(vd_lt(zero, a), vd_all(1.0), a));
}
VD_INLINE vd_mask vd_finite(real a) { return vd_le(vd_abs(a), vd_all(DBL_MAX)); }
