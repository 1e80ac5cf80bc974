"""Loop closure: constraint equations, coordinate partitioning, redundancy, reactions."""
