"""Results in memory: labelled arrays of any result file, with conversions, figures and export."""
