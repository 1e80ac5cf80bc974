"""From a model and what a scenario chooses for it to a system or a vehicle: a builder a kind."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vehicledyn.base.errors import InputError
from vehicledyn.files.building.road_choice import RoadChoice
from vehicledyn.road.vehicle import RoadOptions, RoadVehicle

if TYPE_CHECKING:
    from vehicledyn.files.scenario.catalogue_models import CatalogueModel
    from vehicledyn.files.scenario.python_models import PythonModel
    from vehicledyn.files.system.read import SystemModel
    from vehicledyn.multibody.model.system import System


class SystemBuilder:
    """Builds what a system file describes; without choices it takes the file's own parts."""

    @staticmethod
    def system(model: SystemModel, choice: RoadChoice | None) -> System:
        """Return the system."""
        from vehicledyn.files.building.construct import build_system

        return build_system(model, choice)

    @staticmethod
    def vehicle(model: SystemModel, choice: RoadChoice | None) -> RoadVehicle:
        """Return the road vehicle, not yet steered."""
        from vehicledyn.files.building.construct import build_vehicle

        return build_vehicle(model, choice or RoadChoice())


class PythonBuilder:
    """Takes a system that was built in Python as it is."""

    @staticmethod
    def system(model: PythonModel, _: RoadChoice | None) -> System:
        """Return the system."""
        return model.system


class CatalogueBuilder:
    """Lets an entry of the catalogue build its vehicle; without choices with its usual parts."""

    @staticmethod
    def vehicle(model: CatalogueModel, choice: RoadChoice | None) -> RoadVehicle:
        """Return the road vehicle, not yet steered.

        Raises
        ------
        InputError
            If tyres or road are missing.
        """
        options = model.entry.standard_options() if choice is None else _options(model, choice)
        vehicle: RoadVehicle = model.entry.build(model.parameters, options)
        return vehicle


def _options(model: CatalogueModel, choice: RoadChoice) -> RoadOptions:
    tyres = (choice.front_tyre, choice.rear_tyre)
    missing = [
        f"{model.name}: {key}: missing: {why}"
        for key, values, why in (
            ("tyres", tyres, "a road vehicle needs a tyre law, such as 'kind: calspan'"),
            ("road", (choice.surface,), "a road vehicle needs a road, such as 'kind: flat'"),
        )
        if None in values
    ]
    if missing:
        raise InputError("\n".join(missing))
    return RoadOptions(
        front_tyre=choice.front_tyre,  # type: ignore[arg-type]
        rear_tyre=choice.rear_tyre,  # type: ignore[arg-type]
        surface=choice.laid(choice.surface),  # type: ignore[arg-type]
        free_wheels=choice.free_wheels,
        speed=choice.speed,
        contact=choice.contact,
        relaxation=choice.relaxation,  # type: ignore[arg-type]
    )


BUILDERS: dict[str, Any] = {
    "system": SystemBuilder,
    "python": PythonBuilder,
    "catalogue": CatalogueBuilder,
}
"""Builders by the kind of a model."""
