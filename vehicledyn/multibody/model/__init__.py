"""What a system is, as data: bodies, joints, cuts, constraints, parts, the tree and its motion."""
