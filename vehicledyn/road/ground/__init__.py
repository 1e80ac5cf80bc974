"""Numbers behind road surfaces: random records and the enveloping of obstacles."""
