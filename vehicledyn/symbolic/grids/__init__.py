"""Tables over two places, as of roads: heights and slopes in grids of numbers."""
