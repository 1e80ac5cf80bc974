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
#if VD_LANES == 8 && defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__FMA__)
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
#define vd_fnms(a, b, c) vd_fma1(-(a), b, -(c))

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
#define vd_fnms(a, b, c) ((real)VD_FNMA8(a, b, -(c)))
#define vd_sqrt(a) ((real)VD_SQRT8(a))
#elif VD_LANES == 4 && VD_WIDTH >= 4 && defined(__FMA__)
VD_INLINE int vd_any(vd_mask a) { return VD_ANY4(a); }
VD_INLINE real vd_select(vd_mask m, real a, real b) { return (real)VD_PICK4(m, a, b); }
#define vd_lesser(a, b) ((real)VD_MIN4(a, b))
#define vd_larger(a, b) ((real)VD_MAX4(a, b))
#define vd_fma(a, b, c) ((real)VD_FMA4(a, b, c))
#define vd_fms(a, b, c) ((real)VD_FMA4(a, b, -(c)))
#define vd_fnma(a, b, c) ((real)VD_FNMA4(a, b, c))
#define vd_fnms(a, b, c) ((real)VD_FNMA4(a, b, -(c)))
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
VD_INLINE real vd_fnms(real a, real b, real c) { return vd_fma(-a, b, -c); }
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
