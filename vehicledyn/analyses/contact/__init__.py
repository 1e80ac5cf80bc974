"""Contact geometry of profiles, and railway tracks looked at."""
