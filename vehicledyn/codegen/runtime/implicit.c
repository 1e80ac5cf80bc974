/* Rates and residuals with their Jacobian, as CasADi's integrators call functions of other
   libraries: vd_dae (t, x, z, c) -> (rates, residuals), and jac_vd_dae of the same arguments and
   results, with the derivative of each result by each argument. Those by c are never asked for,
   so they have no entries. */

void vd_columns(const double *t, const double *x, const double *z, const double *c,
                double *columns);

VD_EXPORT long long vd_dae_n_in(void) { return 4; }
VD_EXPORT long long vd_dae_n_out(void) { return 2; }
VD_EXPORT const long long *vd_dae_sparsity_in(long long k) { return arguments[k]; }
VD_EXPORT const long long *vd_dae_sparsity_out(long long k) { return results[k]; }

VD_EXPORT int vd_dae(const double **arg, double **res, long long *iw, double *w, int mem) {
  double rates[NX1], residuals[NZ1];
  dae(arg[0], arg[1], arg[2], arg[3], rates, residuals);
  if (res[0]) memcpy(res[0], rates, NX * sizeof(double));
  if (res[1]) memcpy(res[1], residuals, NZ * sizeof(double));
  return 0;
}

VD_EXPORT long long jac_vd_dae_n_in(void) { return 6; }
VD_EXPORT long long jac_vd_dae_n_out(void) { return 8; }
VD_EXPORT const long long *jac_vd_dae_sparsity_in(long long k) {
  return k < 4 ? arguments[k] : results[k - 4];
}
VD_EXPORT const long long *jac_vd_dae_sparsity_out(long long k) { return slopes[k]; }
VD_EXPORT int jac_vd_dae_work(long long *n_arg, long long *n_res, long long *n_iw,
                              long long *n_w) {
  *n_arg = 6, *n_res = 8, *n_iw = 0, *n_w = NCOLOUR * NROW;
  return 0;
}

VD_EXPORT int jac_vd_dae(const double **arg, double **res, long long *iw, double *w, int mem) {
  vd_columns(arg[0], arg[1], arg[2], arg[3], w);
  for (int k = 0; k < 8; k++)
    if (res[k])
      for (int i = 0; i < n_slopes[k]; i++) res[k][i] = w[place_of[k][i]];
  return 0;
}

VD_EXPORT void vd_dae_prepare(const double *p, double *c) { prepare(p, c); }
