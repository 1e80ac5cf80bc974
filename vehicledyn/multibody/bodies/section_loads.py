"""Forces, moments and stresses in a section of a beam, as channels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from vehicledyn.multibody.bodies.beam_sections import Section
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class SectionLoads:
    """What the outer part of a beam exerts on the inner one in a section, in the section's axes.

    ``axial`` force and ``shear`` along y and z [N], ``torque`` about the axis and ``moment_y`` and
    ``moment_z`` about y and z [N m]. What a beam has no coordinate for is None: its forces are
    those of a constraint.
    """

    axial: Scalar | None
    shear_y: Scalar | None
    shear_z: Scalar | None
    torque: Scalar | None
    moment_y: Scalar | None
    moment_z: Scalar | None

    def channels(self, name: str, section: Section | None) -> Iterator[tuple[Channel, Scalar]]:
        """Yield channels with their values; stresses where the shape of the section is known."""
        known = {
            "axial_force": (self.axial, "N", "Axial force, positive in tension"),
            "shear_force_y": (self.shear_y, "N", "Shear force along y"),
            "shear_force_z": (self.shear_z, "N", "Shear force along z"),
            "torque": (self.torque, "N*m", "Torque about the axis"),
            "moment_y": (self.moment_y, "N*m", "Bending moment about y"),
            "moment_z": (self.moment_z, "N*m", "Bending moment about z"),
        }
        for word, (value, unit, text) in known.items():
            if value is not None:
                yield Channel(f"{name}.{word}", unit, f"{text} in a section", name), value
        if section is not None:
            text = "Largest normal stress in a section, positive"
            yield Channel(f"{name}.stress", "Pa", text, name), self.stress(section)

    def stress(self, section: Section) -> Scalar:
        """Return the largest normal stress of the section by amount [Pa].

        |N|/A + |M_y| z/I + |M_z| y/I at the corner of a shape with corners, and
        |N|/A + √(M_y² + M_z²) r/I on the circumference of a round one.
        """
        numbers, (far_y, far_z) = section.numbers, section.reach
        axial, about_y, about_z = (
            ops.scalar(0.0 if item is None else item)
            for item in (self.axial, self.moment_y, self.moment_z)
        )
        along = ops.absolute(axial) / numbers.area
        if section.shape in ("circle", "tube"):
            size = ops.sqrt(about_y * about_y + about_z * about_z)
            return along + size * far_y / numbers.along_y
        bent = ops.absolute(about_z) * far_y / numbers.along_y
        return along + bent + ops.absolute(about_y) * far_z / numbers.along_z
