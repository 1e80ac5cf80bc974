"""Make equations run: compile, integrate, balance, linearise."""
