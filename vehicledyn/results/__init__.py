"""Result files: store, description, comparison, plots and scalar metrics; no mechanics."""
