"""What was derived before, kept on disk by all that it follows from."""
