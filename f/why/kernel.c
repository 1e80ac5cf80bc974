/* The numbers of a kernel: a `real` holds VD_LANES doubles, one of each case, or one double.
   Every operation acts on each lane by itself and rounds as the scalar one does, so a result
   does not depend on the number of lanes. Fused operations are asked for by name; the compiler
   adds none (-ffp-contract=off). */
#include <float.h>
#include <math.h>
#include <string.h>
#ifndef VD_LANES
#define VD_LANES 1
#endif
#if defined(_WIN32)
#define VD_EXPORT __declspec(dllexport)
#else
#define VD_EXPORT __attribute__((visibility("default")))
#endif
#define VD_APART __attribute__((noinline))
/* The bits of a double that hold an address, see table_rows.py: all of its fraction. */
#define VD_ADDRESS 0xfffffffffffffLL
#define VD_INLINE static inline __attribute__((always_inline))

/* Doubles in the widest registers that elementary functions fill; those of one case alone come in
   fours. */
#if VD_LANES == 8 && defined(__AVX512F__) && defined(__AVX512DQ__)
#define VD_WIDTH 8
#elif defined(__AVX2__)
#define VD_WIDTH 4
#else
#define VD_WIDTH 2
#endif

/* Operations on whole registers: fused sums a b + c and c - a b, roots, the lesser and larger of
   two (the second where one is no number), choices a where m holds and else b. Masks of eight
   are bits, those of four hold as signs. Where the compiler offers these operations without,
   immintrin.h is left out: it takes longer to compile than a small kernel. */
typedef double vd_four __attribute__((vector_size(32)));
typedef double vd_eight __attribute__((vector_size(64)));
#if !defined(__has_builtin)
#define __has_builtin(name) 0
#endif
#if VD_WIDTH >= 4
#if __has_builtin(__builtin_ia32_vfmaddpd256) && __has_builtin(__builtin_ia32_vfnmaddpd256) && \
    __has_builtin(__builtin_ia32_sqrtpd256) && __has_builtin(__builtin_ia32_movmskpd256) &&    \
    __has_builtin(__builtin_ia32_minpd256) && __has_builtin(__builtin_ia32_blendvpd256)
#define VD_DO4(name, ...) __builtin_ia32_##name(__VA_ARGS__)
#define VD_FMA4(a, b, c) VD_DO4(vfmaddpd256, (vd_four)(a), (vd_four)(b), (vd_four)(c))
#define VD_FNMA4(a, b, c) VD_DO4(vfnmaddpd256, (vd_four)(a), (vd_four)(b), (vd_four)(c))
#define VD_SQRT4(a) VD_DO4(sqrtpd256, (vd_four)(a))
#define VD_MIN4(a, b) VD_DO4(minpd256, (vd_four)(a), (vd_four)(b))
#define VD_MAX4(a, b) VD_DO4(maxpd256, (vd_four)(a), (vd_four)(b))
#define VD_PICK4(m, a, b) VD_DO4(blendvpd256, (vd_four)(b), (vd_four)(a), (vd_four)(m))
#define VD_ANY4(a) (VD_DO4(movmskpd256, (vd_four)(a)) != 0)
#else
#include <immintrin.h>
#define VD_FMA4(a, b, c) _mm256_fmadd_pd((__m256d)(a), (__m256d)(b), (__m256d)(c))
#define VD_FNMA4(a, b, c) _mm256_fnmadd_pd((__m256d)(a), (__m256d)(b), (__m256d)(c))
#define VD_SQRT4(a) _mm256_sqrt_pd((__m256d)(a))
#define VD_MIN4(a, b) _mm256_min_pd((__m256d)(a), (__m256d)(b))
#define VD_MAX4(a, b) _mm256_max_pd((__m256d)(a), (__m256d)(b))
#define VD_PICK4(m, a, b) _mm256_blendv_pd((__m256d)(b), (__m256d)(a), (__m256d)(m))
#define VD_ANY4(a) (_mm256_movemask_pd((__m256d)(a)) != 0)
#endif
#endif
#if VD_WIDTH == 8
#define VD_LT8(a, b) VD_IS8(a, b, 17)
#define VD_LE8(a, b) VD_IS8(a, b, 18)
#define VD_EQ8(a, b) VD_IS8(a, b, 0)
#define VD_NE8(a, b) VD_IS8(a, b, 4)
#if __has_builtin(__builtin_ia32_vfmaddpd512_mask) &&                                             \
    __has_builtin(__builtin_ia32_vfnmaddpd512_mask) &&                                            \
    __has_builtin(__builtin_ia32_sqrtpd512_mask) && __has_builtin(__builtin_ia32_minpd512_mask) && \
    __has_builtin(__builtin_ia32_cmppd512_mask) && __has_builtin(__builtin_ia32_blendmpd_512_mask)
#define VD_DO8(name, ...) __builtin_ia32_##name##_mask(__VA_ARGS__, -1, 4)
#define VD_ZERO8 ((vd_eight){0.0})
#define VD_FMA8(a, b, c) VD_DO8(vfmaddpd512, (vd_eight)(a), (vd_eight)(b), (vd_eight)(c))
#define VD_FNMA8(a, b, c) VD_DO8(vfnmaddpd512, (vd_eight)(a), (vd_eight)(b), (vd_eight)(c))
#define VD_SQRT8(a) VD_DO8(sqrtpd512, (vd_eight)(a), VD_ZERO8)
#define VD_MIN8(a, b) VD_DO8(minpd512, (vd_eight)(a), (vd_eight)(b), VD_ZERO8)
#define VD_MAX8(a, b) VD_DO8(maxpd512, (vd_eight)(a), (vd_eight)(b), VD_ZERO8)
#define VD_IS8(a, b, kind) ((unsigned char)VD_DO8(cmppd512, (vd_eight)(a), (vd_eight)(b), kind))
#define VD_PICK8(m, a, b) __builtin_ia32_blendmpd_512_mask((vd_eight)(b), (vd_eight)(a), m)
#else
#include <immintrin.h>
#define VD_FMA8(a, b, c) _mm512_fmadd_pd((__m512d)(a), (__m512d)(b), (__m512d)(c))
#define VD_FNMA8(a, b, c) _mm512_fnmadd_pd((__m512d)(a), (__m512d)(b), (__m512d)(c))
#define VD_SQRT8(a) _mm512_sqrt_pd((__m512d)(a))
#define VD_MIN8(a, b) _mm512_min_pd((__m512d)(a), (__m512d)(b))
#define VD_MAX8(a, b) _mm512_max_pd((__m512d)(a), (__m512d)(b))
#define VD_IS8(a, b, kind) _mm512_cmp_pd_mask((__m512d)(a), (__m512d)(b), kind)
#define VD_PICK8(m, a, b) _mm512_mask_blend_pd(m, (__m512d)(b), (__m512d)(a))
#endif
#endif

typedef double vd_wide __attribute__((vector_size(8 * VD_WIDTH), aligned(8), may_alias));
typedef long long vd_whole __attribute__((vector_size(8 * VD_WIDTH), aligned(8), may_alias));

#if defined(__FMA__) || defined(__ARM_FEATURE_FMA)
#define VD_FUSED 1
#define vd_fma1(a, b, c) __builtin_fma(a, b, c)
#else
#define VD_FUSED 0
#define vd_fma1(a, b, c) ((a) * (b) + (c))
#endif

#if VD_WIDTH == 8
#define vd_fma_wide(a, b, c) ((vd_wide)VD_FMA8(a, b, c))
#elif VD_WIDTH == 4 && defined(__FMA__)
#define vd_fma_wide(a, b, c) ((vd_wide)VD_FMA4(a, b, c))
#else
VD_INLINE vd_wide vd_fma_wide(vd_wide a, vd_wide b, vd_wide c) {
  for (int i = 0; i < VD_WIDTH; i++) a[i] = vd_fma1(a[i], b[i], c[i]);
  return a;
}
#endif

/* A vd_pack holds four reals that are given to elementary.c; in one case alone it is made in a
   register and stored whole, so that it is read without waiting for four stores. */

#if VD_LANES == 1

typedef double real;
typedef int vd_mask;
typedef double vd_pack __attribute__((vector_size(32)));
#define VD_PACK(a, b, c, d) {a, b, c, d}
#define VD_LANE(value, lane) (value)
#define VD_HOLDS(mask, lane) (mask)
VD_INLINE real vd_whole_part(real a) { return floor(a); }
VD_INLINE real vd_entry(real cell, const real *t, int width, int power) {
  unsigned long long bits;
  memcpy(&bits, t + 4, sizeof bits);
  return ((const double *)(bits & VD_ADDRESS))[(long long)cell * width + power];
}
VD_INLINE void vd_four_entries(real cell, const real *t, real *r) {
  for (int k = 0; k < 4; k++) r[k] = vd_entry(cell, t, 4, k);
}
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
VD_INLINE real vd_lesser(real a, real b) { return a < b ? a : b; }
VD_INLINE real vd_larger(real a, real b) { return a > b ? a : b; }
#define vd_abs(a) fabs(a)
#define vd_sqrt(a) sqrt(a)
#define vd_fma(a, b, c) vd_fma1(a, b, c)
#define vd_fms(a, b, c) vd_fma1(a, b, -(c))
#define vd_fnma(a, b, c) vd_fma1(-(a), b, c)

#else

typedef double real __attribute__((vector_size(8 * VD_LANES), may_alias));
typedef long long vd_bits __attribute__((vector_size(8 * VD_LANES), may_alias));
typedef struct { real item[4]; } vd_pack;
#define VD_PACK(a, b, c, d) {{a, b, c, d}}
#define VD_LANE(value, lane) ((value)[lane])
VD_INLINE real vd_all(double a) { return a - (real){0.0}; }
VD_INLINE real vd_abs(real a) {
  return (real)((vd_bits)a & (0x7fffffffffffffffLL - (vd_bits){0}));
}

#if VD_LANES == 8 && VD_WIDTH == 8
typedef unsigned char vd_mask;
#define VD_HOLDS(mask, lane) ((mask) >> (lane) & 1)
VD_INLINE vd_mask vd_lt(real a, real b) { return VD_LT8(a, b); }
VD_INLINE vd_mask vd_le(real a, real b) { return VD_LE8(a, b); }
VD_INLINE vd_mask vd_eq(real a, real b) { return VD_EQ8(a, b); }
VD_INLINE vd_mask vd_ne(real a, real b) { return VD_NE8(a, b); }
VD_INLINE vd_mask vd_not(vd_mask a) { return ~a; }
VD_INLINE vd_mask vd_every(int a) { return a ? 255 : 0; }
VD_INLINE int vd_any(vd_mask a) { return a != 0; }
VD_INLINE real vd_select(vd_mask m, real a, real b) { return (real)VD_PICK8(m, a, b); }
VD_INLINE real vd_only(vd_mask m, real a) { return vd_select(m, a, vd_all(0.0)); }
#else
typedef vd_bits vd_mask;
#define VD_HOLDS(mask, lane) ((mask)[lane])
VD_INLINE vd_mask vd_lt(real a, real b) { return a < b; }
VD_INLINE vd_mask vd_le(real a, real b) { return a <= b; }
VD_INLINE vd_mask vd_eq(real a, real b) { return a == b; }
VD_INLINE vd_mask vd_ne(real a, real b) { return a != b; }
VD_INLINE vd_mask vd_not(vd_mask a) { return ~a; }
VD_INLINE vd_mask vd_every(int a) { return -(long long)(a != 0) - (vd_mask){0}; }
VD_INLINE real vd_only(vd_mask m, real a) { return (real)(m & (vd_mask)a); }
#endif
VD_INLINE real vd_real(vd_mask a) { return vd_only(a, vd_all(1.0)); }

#if VD_LANES == 8 && VD_WIDTH == 8
#define vd_lesser(a, b) ((real)VD_MIN8(a, b))
#define vd_larger(a, b) ((real)VD_MAX8(a, b))
#define vd_fma(a, b, c) ((real)VD_FMA8(a, b, c))
#define vd_fms(a, b, c) ((real)VD_FMA8(a, b, -(c)))
#define vd_fnma(a, b, c) ((real)VD_FNMA8(a, b, c))
#define vd_sqrt(a) ((real)VD_SQRT8(a))
#elif VD_LANES == 4 && VD_WIDTH >= 4 && defined(__FMA__)
VD_INLINE int vd_any(vd_mask a) { return VD_ANY4(a); }
VD_INLINE real vd_select(vd_mask m, real a, real b) { return (real)VD_PICK4(m, a, b); }
#define vd_lesser(a, b) ((real)VD_MIN4(a, b))
#define vd_larger(a, b) ((real)VD_MAX4(a, b))
#define vd_fma(a, b, c) ((real)VD_FMA4(a, b, c))
#define vd_fms(a, b, c) ((real)VD_FMA4(a, b, -(c)))
#define vd_fnma(a, b, c) ((real)VD_FNMA4(a, b, c))
#define vd_sqrt(a) ((real)VD_SQRT4(a))
#else
VD_INLINE int vd_any(vd_mask a) {
  long long found = 0;
  for (int i = 0; i < VD_LANES; i++) found |= a[i];
  return found != 0;
}
VD_INLINE real vd_select(vd_mask m, real a, real b) {
  return (real)((m & (vd_mask)a) | (~m & (vd_mask)b));
}
VD_INLINE real vd_lesser(real a, real b) { return vd_select(a < b, a, b); }
VD_INLINE real vd_larger(real a, real b) { return vd_select(a > b, a, b); }
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

/* Of numbers from 0 to 2^51: a sum with 2^52 has no fraction, its last bits are the number. */
VD_INLINE real vd_whole_part(real a) {
  const real whole = (a + 0x1p52) - 0x1p52;
  return whole - vd_only(vd_lt(a, whole), vd_all(1.0));
}
VD_INLINE vd_bits vd_place(real cell, const real *t, int width) {
  const vd_bits number = (vd_bits)(cell * (double)width + 0x1p52) & VD_ADDRESS;
  return ((vd_bits)t[4] & VD_ADDRESS) + (number << 3);
}
VD_INLINE real vd_entry(real cell, const real *t, int width, int power) {
  const vd_bits place = vd_place(cell, t, width);
#define VD_AT(lane) ((const double *)place[lane])[power]
#if VD_LANES == 8
  return (real){VD_AT(0), VD_AT(1), VD_AT(2), VD_AT(3), VD_AT(4), VD_AT(5), VD_AT(6), VD_AT(7)};
#else
  return (real){VD_AT(0), VD_AT(1), VD_AT(2), VD_AT(3)};
#endif
#undef VD_AT
}
/* The four entries of a cell: a load for each lane, then turned. */
#if __has_builtin(__builtin_shufflevector)
typedef double vd_row __attribute__((vector_size(32), aligned(8), may_alias));
#define VD_TURN(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
VD_INLINE void vd_four_entries(real cell, const real *t, real *r) {
  const vd_bits place = vd_place(cell, t, 4);
#define VD_AT(lane) (*(const vd_row *)place[lane])
#if VD_LANES == 8
#define VD_TWO(lane) VD_TURN(VD_AT(lane), VD_AT(lane + 4), 0, 1, 2, 3, 4, 5, 6, 7)
  const real a = VD_TWO(0), b = VD_TWO(1), c = VD_TWO(2), d = VD_TWO(3);
  const real ab0 = VD_TURN(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
  const real ab1 = VD_TURN(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
  const real cd0 = VD_TURN(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
  const real cd1 = VD_TURN(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
  r[0] = VD_TURN(ab0, cd0, 0, 1, 8, 9, 4, 5, 12, 13);
  r[1] = VD_TURN(ab1, cd1, 0, 1, 8, 9, 4, 5, 12, 13);
  r[2] = VD_TURN(ab0, cd0, 2, 3, 10, 11, 6, 7, 14, 15);
  r[3] = VD_TURN(ab1, cd1, 2, 3, 10, 11, 6, 7, 14, 15);
#undef VD_TWO
#else
  const vd_row a = VD_AT(0), b = VD_AT(1), c = VD_AT(2), d = VD_AT(3);
  const vd_row ab0 = VD_TURN(a, b, 0, 4, 2, 6), ab1 = VD_TURN(a, b, 1, 5, 3, 7);
  const vd_row cd0 = VD_TURN(c, d, 0, 4, 2, 6), cd1 = VD_TURN(c, d, 1, 5, 3, 7);
  r[0] = (real)VD_TURN(ab0, cd0, 0, 1, 4, 5);
  r[1] = (real)VD_TURN(ab1, cd1, 0, 1, 4, 5);
  r[2] = (real)VD_TURN(ab0, cd0, 2, 3, 6, 7);
  r[3] = (real)VD_TURN(ab1, cd1, 2, 3, 6, 7);
#endif
#undef VD_AT
}
#else
VD_INLINE void vd_four_entries(real cell, const real *t, real *r) {
  for (int k = 0; k < 4; k++) r[k] = vd_entry(cell, t, 4, k);
}
#endif

#endif

VD_INLINE vd_mask vd_and(vd_mask a, vd_mask b) { return a & b; }
VD_INLINE vd_mask vd_or(vd_mask a, vd_mask b) { return a | b; }
VD_INLINE vd_mask vd_true(real a) { return vd_ne(a, vd_all(0.0)); }
/* Of a number and one that is none these are the number; vd_lesser and vd_larger are so where the
   second is surely a number. */
VD_INLINE real vd_min(real a, real b) { return vd_select(vd_eq(b, b), vd_lesser(a, b), a); }
VD_INLINE real vd_max(real a, real b) { return vd_select(vd_eq(b, b), vd_larger(a, b), a); }
VD_INLINE real vd_sign(real a) {
  const real zero = vd_all(0.0);
  return vd_select(vd_lt(a, zero), vd_all(-1.0), vd_select(vd_lt(zero, a), vd_all(1.0), a));
}

/* Tables: origin, 1/step, step, last cell and address of the cells lie side by side at t. Each
   place has a cell inside the table, one that is no number has the last. */
VD_INLINE real vd_cell(real x, const real *t) {
  const real place = (x - t[0]) * t[1];
  return vd_whole_part(vd_larger(vd_lesser(place, t[3]), vd_all(0.0)));
}
VD_INLINE real vd_knot(real cell, const real *t) { return t[0] + t[2] * cell; }

VD_INLINE vd_mask vd_finite(real a) { return vd_le(vd_abs(a), vd_all(DBL_MAX)); }

/* Give n numbers to all lanes. */
VD_INLINE void vd_spread(int n, const double *a, real *r) {
  for (int k = 0; k < n; k++) r[k] = vd_all(a[k]);
}

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
/* Conditions, choices and roots of wide numbers. */
#if VD_WIDTH == 8
typedef unsigned char vd_test;
#define VD_TRUE(m, k) ((m) >> (k) & 1)
VD_INLINE vd_test vd_less(vd_wide a, vd_wide b) { return VD_LT8(a, b); }
VD_INLINE vd_wide vd_pick(vd_test m, vd_wide a, vd_wide b) { return (vd_wide)VD_PICK8(m, a, b); }
VD_INLINE int vd_some(vd_test m) { return m != 0; }
VD_INLINE vd_wide vd_sqrt_wide(vd_wide a) { return (vd_wide)VD_SQRT8(a); }
#else
typedef vd_whole vd_test;
#define VD_TRUE(m, k) ((m)[k])
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

static VD_APART void vd_sincos(int n, double *a, double *s, double *c) {
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
    const vd_test far = ~vd_less(size, vd_w(VD_LARGE_ANGLE));
    if (vd_some(far))
      for (int k = 0; k < VD_WIDTH; k++)
        if (VD_TRUE(far, k)) s[i + k] = sin(x[k]), c[i + k] = cos(x[k]);
  }
}

/* The sine of vd_sincos. */
static VD_APART void vd_sin(int n, double *a, double *s) {
  VD_EACH(n) {
    const vd_wide x = VD_WIDE(a), size = vd_abs_wide(x);
    if (!vd_some(~vd_less(size, vd_w(VD_NO_TURN)))) {
      VD_STORE(s, vd_sine_near(x + 0.0, x * x));
      continue;
    }
    vd_wide sine;
    vd_turned(x, &sine, 0);
    VD_STORE(s, sine);
    const vd_test far = ~vd_less(size, vd_w(VD_LARGE_ANGLE));
    if (vd_some(far))
      for (int k = 0; k < VD_WIDTH; k++)
        if (VD_TRUE(far, k)) s[i + k] = sin(x[k]);
  }
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
  const vd_whole power = ((vd_whole)shifted << 52) + vd_i(1023LL << 52);
  return value * (vd_wide)power;
}

static VD_APART void vd_exp(int n, double *a, double *r) {
  VD_EACH(n) {
    const vd_wide x = VD_WIDE(a);
    VD_STORE(r, vd_exp_wide(x));
    const vd_test far = ~vd_less(vd_abs_wide(x), vd_w(700.0));
    if (vd_some(far))
      for (int k = 0; k < VD_WIDTH; k++)
        if (VD_TRUE(far, k)) r[i + k] = exp(x[k]);
  }
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
    /* x = m 2^k with sqrt(1/2) <= m < sqrt(2); all k are made positive for the shift. */
    const vd_whole bits = (vd_whole)x - vd_i(0x3fe6a09e667f3bcdLL) + vd_i(1024LL << 52);
    const vd_whole whole = (bits >> 52) - 1024;
    const vd_wide m = (vd_wide)((vd_whole)x - (whole << 52));
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

/* Operations on four places of one case, in functions of one lane. Each place rounds as the
   operation of real.h does, so a result does not depend on what is computed beside it. */
#if VD_LANES != 1 || VD_WIDTH < 4 || !VD_FUSED
#error "fours.h is for one lane, on processors with AVX2 and fused sums"
#endif

typedef double vd_four_at __attribute__((vector_size(32), aligned(8), may_alias));
typedef long long vd_mask4 __attribute__((vector_size(32)));
#define VD_FOUR_AT(place) (*(const vd_four_at *)(place))
#define VD_FOUR_TO(place, value) (*(vd_four_at *)(place) = (value))

VD_INLINE vd_four vd4_all(double a) { return a - (vd_four){0.0}; }
#define vd4_fma(a, b, c) ((vd_four)VD_FMA4(a, b, c))
#define vd4_fms(a, b, c) ((vd_four)VD_FMA4(a, b, -(c)))
#define vd4_fnma(a, b, c) ((vd_four)VD_FNMA4(a, b, c))
#define vd4_sqrt(a) ((vd_four)VD_SQRT4(a))
#define vd4_lesser(a, b) ((vd_four)VD_MIN4(a, b))
#define vd4_larger(a, b) ((vd_four)VD_MAX4(a, b))
#define vd4_select(m, a, b) ((vd_four)VD_PICK4(m, a, b))
/* The places with the sign 1 turned. */
#define vd4_turn(a, ...) ((vd_four)((vd_mask4)(a) ^ ((vd_mask4){__VA_ARGS__} << 63)))
VD_INLINE vd_four vd4_abs(vd_four a) {
  return (vd_four)((vd_mask4)a & (0x7fffffffffffffffLL - (vd_mask4){0}));
}
VD_INLINE vd_mask4 vd4_lt(vd_four a, vd_four b) { return a < b; }
VD_INLINE vd_mask4 vd4_le(vd_four a, vd_four b) { return a <= b; }
VD_INLINE vd_mask4 vd4_eq(vd_four a, vd_four b) { return a == b; }
VD_INLINE vd_mask4 vd4_ne(vd_four a, vd_four b) { return a != b; }
VD_INLINE vd_mask4 vd4_not(vd_mask4 a) { return ~a; }
VD_INLINE vd_mask4 vd4_and(vd_mask4 a, vd_mask4 b) { return a & b; }
VD_INLINE vd_mask4 vd4_or(vd_mask4 a, vd_mask4 b) { return a | b; }
VD_INLINE vd_mask4 vd4_true(vd_four a) { return a != vd4_all(0.0); }
VD_INLINE vd_four vd4_only(vd_mask4 m, vd_four a) { return (vd_four)(m & (vd_mask4)a); }
VD_INLINE vd_four vd4_real(vd_mask4 m) { return vd4_only(m, vd4_all(1.0)); }
VD_INLINE vd_four vd4_min(vd_four a, vd_four b) {
  return vd4_select(vd4_eq(b, b), vd4_lesser(a, b), a);
}
VD_INLINE vd_four vd4_max(vd_four a, vd_four b) {
  return vd4_select(vd4_eq(b, b), vd4_larger(a, b), a);
}
VD_INLINE vd_four vd4_sign(vd_four a) {
  const vd_four zero = vd4_all(0.0);
  return vd4_select(a < zero, vd4_all(-1.0), vd4_select(zero < a, vd4_all(1.0), a));
}

static void law0o(const real *restrict x, const real *restrict c, real *restrict r0) {
  vd_pack a0_0[] = {VD_PACK(x[9], x[9], x[9], x[9])};
  vd_pack a0_1[] = {VD_PACK(x[9], x[9], x[9], x[9])};
  vd_pack b0_0[1];
  vd_atan2(1 * VD_LANES, (double *)a0_0, (double *)a0_1, (double *)b0_0);
  const real w9 = ((real *)b0_0)[0 + 0];
  r0[2] = w9;
  vd_pack a1_0[] = {VD_PACK(c[3], c[3], c[3], c[3])};
  vd_pack b1_0[1], b1_1[1];
  vd_sincos(1 * VD_LANES, (double *)a1_0, (double *)b1_0, (double *)b1_1);
  const real w1 = ((real *)b1_0)[0 + 0];
  const real w2 = ((real *)b1_1)[0 + 0];
  const vd_mask w11 = vd_lt(w9, vd_all(1.0));
  const real w12 = vd_only(w11, w9);
  const vd_mask w19 = vd_lt(c[3], x[9]);
  const vd_mask w21 = vd_lt(vd_all(0.0), x[9]);
  const vd_mask w22 = vd_and(w19, w21);
  const real w25 = -x[9];
  const real w27 = vd_select(w22, c[3], w25);
  const vd_mask w34 = vd_lt(w9, vd_all(1.0));
  const real w35 = vd_only(w34, w9);
  r0[3] = w35;
  const vd_mask w36 = vd_lt(c[3], x[9]);
  const vd_mask w37 = vd_lt(vd_all(0.0), x[9]);
  const vd_mask w38 = vd_and(w36, w37);
  const real w41 = -x[9];
  const real w43 = vd_select(w38, c[3], w41);
  vd_pack a16_0[] = {VD_PACK(x[0], w27, w43, x[0])};
  vd_pack a16_1[] = {VD_PACK(w12, w9, w9, w35)};
  vd_pack b16_0[1];
  vd_atan2(4 * VD_LANES, (double *)a16_0, (double *)a16_1, (double *)b16_0);
  const real w13 = ((real *)b16_0)[0 + 0];
  const real w28 = ((real *)b16_0)[0 + 1];
  const real w44 = ((real *)b16_0)[0 + 2];
  const real w47 = ((real *)b16_0)[0 + 3];
  r0[4] = w44;
  const real w3 = w1 / w2;
  const real w4 = w3 * w3;
  const real w5 = vd_only(vd_true(w4), w4);
  const real w6 = vd_sign(w5);
  const real w15 = vd_larger(w13, vd_all(0.5));
  const real w16 = w12 - w4;
  const real w17 = w15 * w16;
  const vd_mask w18 = vd_le(w6, w17);
  const real w29 = vd_real(w18) / w28;
  const real w30 = vd_min(w29, w28);
  vd_pack a27_0[] = {VD_PACK(w30, w30, w30, w30)};
  vd_pack b27_0[1];
  vd_sin(1 * VD_LANES, (double *)a27_0, (double *)b27_0);
  const real w31 = ((real *)b27_0)[0 + 0];
  r0[0] = w31;
  const real w32 = w1 / w2;
  const real w33 = w32 * w32;
  r0[1] = w33;
  const real w45 = vd_only(vd_true(w33), w33);
  const real w46 = vd_sign(w45);
  const real w48 = vd_larger(w47, vd_all(0.5));
  const real w49 = w35 - w33;
  const real w50 = w48 * w49;
  const vd_mask w51 = vd_le(w46, w50);
  r0[5] = vd_real(w51);
  const real w52 = vd_real(w51) / w44;
  r0[6] = w52;
  const real w53 = vd_real(w51) / w44;
  const real w54 = vd_min(w53, w44);
  r0[7] = w54;
}

VD_EXPORT void door0o(const real *x, real *c, real *r) {  law0o(x, c, r); }