"""Wheel on the ground: contact point, slip, relaxation, the wheel as a part."""
