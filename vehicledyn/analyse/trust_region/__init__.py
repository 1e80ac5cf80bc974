"""Search of an optimum on models of all figures, made of the values and gradients of few runs."""
