"""Contact geometry of wheel and rail: contact points, conicity, contact ellipse."""
