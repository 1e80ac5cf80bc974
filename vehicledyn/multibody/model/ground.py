"""What stands still: the name of the ground, as the parent of bodies and the end of links."""

GROUND = "ground"
