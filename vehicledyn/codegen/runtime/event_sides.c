/* Tell whether an event fires between a point whose signs are in sides and this one; where none
   does, the signs become those of this point. A value of zero lies on no side: an event fires
   when it is reached, and the sign of a value that does not fire there stays. */
static int event_fires(double t, const double *x, const double *z, const double *c, int *sides) {
  double values[NE1];
  events(&t, x, z, c, values);
  for (int k = 0; k < NE; k++) {
    if (sides[k] < 0 && values[k] >= 0.0 && fires_rising[k]) return 1;
    if (sides[k] > 0 && values[k] <= 0.0 && fires_falling[k]) return 1;
  }
  for (int k = 0; k < NE; k++)
    if (values[k] != 0.0) sides[k] = values[k] > 0.0 ? 1 : -1;
  return 0;
}
