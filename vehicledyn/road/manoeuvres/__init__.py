"""What manoeuvres are made of: signals, paths, pedals, key figures and figures."""
