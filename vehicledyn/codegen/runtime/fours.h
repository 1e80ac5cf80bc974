/* Operations on four places of one case, in functions of one lane. Each place rounds as the
   operation of real.h does, so a result does not depend on what is computed beside it. */
#if VD_LANES != 1
#error "fours.h is for one lane"
#endif

typedef double vd_four_at __attribute__((vector_size(32), aligned(8), may_alias));
typedef long long vd_mask4 __attribute__((vector_size(32)));
#define VD_FOUR_AT(place) (*(const vd_four_at *)(place))
#define VD_FOUR_TO(place, value) (*(vd_four_at *)(place) = (value))

VD_INLINE vd_four vd4_all(double a) { return a - (vd_four){0.0}; }
#if VD_WIDTH >= 4 && defined(__FMA__)
#define vd4_fma(a, b, c) ((vd_four)VD_FMA4(a, b, c))
#define vd4_fms(a, b, c) ((vd_four)VD_FMA4(a, b, -(c)))
#define vd4_fnma(a, b, c) ((vd_four)VD_FNMA4(a, b, c))
#define vd4_fnms(a, b, c) ((vd_four)VD_FNMA4(a, b, -(c)))
#define vd4_sqrt(a) ((vd_four)VD_SQRT4(a))
#define vd4_lesser(a, b) ((vd_four)VD_MIN4(a, b))
#define vd4_larger(a, b) ((vd_four)VD_MAX4(a, b))
#define vd4_select(m, a, b) ((vd_four)VD_PICK4(m, a, b))
#else
/* For compilers told to do without AVX2 or fused sums: place by place. */
VD_INLINE vd_four vd4_fma(vd_four a, vd_four b, vd_four c) {
  for (int k = 0; k < 4; k++) a[k] = vd_fma(a[k], b[k], c[k]);
  return a;
}
VD_INLINE vd_four vd4_sqrt(vd_four a) {
  for (int k = 0; k < 4; k++) a[k] = vd_sqrt(a[k]);
  return a;
}
VD_INLINE vd_four vd4_select(vd_mask4 m, vd_four a, vd_four b) {
  return (vd_four)((m & (vd_mask4)a) | (~m & (vd_mask4)b));
}
VD_INLINE vd_four vd4_lesser(vd_four a, vd_four b) { return vd4_select(a < b, a, b); }
VD_INLINE vd_four vd4_larger(vd_four a, vd_four b) { return vd4_select(a > b, a, b); }
#define vd4_fms(a, b, c) vd4_fma(a, b, -(c))
#define vd4_fnma(a, b, c) vd4_fma(-(a), b, c)
#define vd4_fnms(a, b, c) vd4_fma(-(a), b, -(c))
#endif
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
