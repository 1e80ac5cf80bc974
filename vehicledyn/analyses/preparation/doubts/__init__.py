"""What makes points and motions doubtful: what a model leaves out, or rounds."""
