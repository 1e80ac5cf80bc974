"""Models looked at: description, export, templates."""
