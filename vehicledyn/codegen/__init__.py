"""Equations to machine code: intermediate representation, passes, printers, compilation."""
