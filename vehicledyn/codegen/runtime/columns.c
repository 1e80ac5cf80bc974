/* A Jacobian by its colours, a lane for each: a colour holds columns of which no two share a row,
   so one slope along all of them is the entries of each. There are NROW rows, NCOLUMN columns
   (time, states, unknowns) in NCOLOUR colours. */

/* columns (NCOLOUR, NROW); c holds the constants and the rows of the tables. */
void vd_columns(const double *t, const double *x, const double *z, const double *c,
                double *columns) {
  real time = vd_all(*t), state[NX1], unknown[NZ1], constants[NC + NT + 1], direction[NCOLUMN];
  real slopes[NROW];
  vd_spread(NX, x, state);
  vd_spread(NZ, z, unknown);
  vd_spread(NC + NT, c, constants);
  for (int first = 0; first < NCOLOUR; first += VD_LANES) {
    for (int k = 0; k < NCOLUMN; k++)
      for (int lane = 0; lane < VD_LANES; lane++)
        ((double *)(direction + k))[lane] = colour_of[k] == first + lane;
    slope(&time, state, unknown, direction, constants, slopes);
    for (int lane = 0; lane < VD_LANES && first + lane < NCOLOUR; lane++)
      for (int k = 0; k < NROW; k++) *columns++ = VD_LANE(slopes[k], lane);
  }
}
