"""Results of linear analyses, hunting studies and geometry as tables and files."""
