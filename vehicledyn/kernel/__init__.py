"""Kernels: equations made ready to run, compiled, interpreted or in SIMD lanes."""
