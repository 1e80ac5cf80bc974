"""C that all kernels share: the loop over steps, events, elementary functions."""
