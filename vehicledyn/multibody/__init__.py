"""General mechanics: bodies, joints, cuts, links, drives, sensors and their equations."""
