"""Systems as parts of systems: assemblies, mirror images and repetition, carried out."""
