"""Parts of general systems: springs, bushings, links, drives, transmissions, sensors."""
