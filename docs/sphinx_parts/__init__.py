"""What the documentation needs beyond Sphinx: generated reference, docstrings, links, formulas."""
