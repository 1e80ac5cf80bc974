"""Printers: functions as C and CUDA, and the sources of whole kernels."""
