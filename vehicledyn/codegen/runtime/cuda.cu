/* What a kernel offers to a GPU. Numbers of a case lie n_cases apart from one another, so that
   neighbouring threads read neighbouring places. */

VD_INLINE long long this_case(void) {
  return (long long)blockIdx.x * blockDim.x + threadIdx.x;
}

VD_INLINE void fetch(int n, const double *all, long long n_cases, long long i, double *own) {
  for (int k = 0; k < n; k++) own[k] = all[k * n_cases + i];
}

VD_INLINE void hand_back(int n, const double *own, long long n_cases, long long i, double *all) {
  for (int k = 0; k < n; k++) all[k * n_cases + i] = own[k];
}

/* Rows of p and c. */
extern "C" {
__constant__ int n_given = NP + NT;
__constant__ int n_constants = NC + NT;
}

/* What depends on the parameters alone: p (NP + NT, n_cases) to c (NC + NT, n_cases). The last NT
   rows of p, handed on to c, hold for each table its origin, 1 / step, step, the number of its
   last cell and the address of its cells in the memory of the GPU, as the bits of a double. */
extern "C" __global__ void vd_prepare_cases(long long n_cases, const double *p, double *c) {
  const long long i = this_case();
  if (i >= n_cases) return;
  double parameters[NP + NT + 1], constants[NC + NT + 1];
  fetch(NP + NT, p, n_cases, i, parameters);
  prepare(parameters, constants);
  for (int k = 0; k < NT; k++) constants[NC + k] = parameters[NP + k];
  hand_back(NC + NT, constants, n_cases, i, c);
}

/* Run each case n_steps steps from a start in x (NX, n_cases), with a close guess of the unknowns
   in z (NZ, n_cases); both hold the end afterwards. Samples (n_samples, n_channels, n_cases) are
   taken at the start and after each whole interval; a case that stops leaves its later samples
   as they are, and tells why and where: status, block or state, and its number of good steps. */
extern "C" __global__ void vd_run_cases(long long n_cases, int method, long long n_steps,
                                        long long per_interval, double start, double interval,
                                        const double *c, double *x, double *z, int n_channels,
                                        const int *channels, double *samples, int *status,
                                        int *where, long long *good) {
  const long long i = this_case();
  if (i >= n_cases) return;
  double constants[NC + NT + 1], state[NX1], unknowns[NZ1], again[NZ1], memory[1 + 2 * NZ1], y[NY + 1];
  fetch(NC + NT, c, n_cases, i, constants);
  fetch(NX, x, n_cases, i, state);
  fetch(NZ, z, n_cases, i, unknowns);
  for (int k = 0; k < 1 + 2 * NZ; k++) memory[k] = 0.0;
  const struct march march = begin_march(method, per_interval, start, interval);
  struct course course;
  begin_course(&course);
  solve_blocks(start, state, unknowns, constants, &course);
  check_residuals(start, state, unknowns, constants, &course);
  if (course.alive) {
    for (int k = 0; k < NZ; k++) again[k] = unknowns[k];
    solve_blocks(start, state, again, constants, &course);
    outputs(&start, state, again, constants, y);
    for (int k = 0; k < n_channels; k++) samples[k * n_cases + i] = y[channels[k]];
  }
  long long step = 0;
  while (step < n_steps && course.alive) {
    take_step(&march, step, 0.0, 1.0, constants, state, unknowns, memory, &course);
    if (!course.alive) break;
    step++;
    if (step % per_interval) continue;
    const double end = time_of(step, 0.0, start, interval, per_interval);
    check_residuals(end, state, unknowns, constants, &course);
    if (!course.alive) break;
    outputs(&end, state, unknowns, constants, y);
    const long long row = step / per_interval * n_channels;
    for (int k = 0; k < n_channels; k++) samples[(row + k) * n_cases + i] = y[channels[k]];
  }
  hand_back(NX, state, n_cases, i, x);
  hand_back(NZ, unknowns, n_cases, i, z);
  status[i] = course.status[0];
  where[i] = course.where[0];
  good[i] = step;
}
