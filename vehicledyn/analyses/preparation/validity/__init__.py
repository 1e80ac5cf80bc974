"""Where a model stops being valid: what it leaves out or rounds, reported as warnings."""
