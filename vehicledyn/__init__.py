"""Road- and rail-vehicle dynamics from symbolic multibody equations."""

__version__ = "0.1.0"
