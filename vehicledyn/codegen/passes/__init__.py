"""Passes of the code generator, each from functions or instructions to cheaper ones."""
