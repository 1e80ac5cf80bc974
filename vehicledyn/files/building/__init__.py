"""From a system file to a multibody system, and back."""
