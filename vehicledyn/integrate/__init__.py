"""Make equations run: compile, integrate, balance, linearise.

Importing the package registers the solvers a scenario may name and loads nothing heavy.
"""

import vehicledyn.integrate.methods  # noqa: F401
