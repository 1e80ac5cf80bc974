"""Numbers of the standard profiles, each with its source."""
