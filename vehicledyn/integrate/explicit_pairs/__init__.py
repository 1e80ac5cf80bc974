"""Explicit pairs with step size control: DOP853 step by step, and pairs given by coefficients."""
