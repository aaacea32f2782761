"""Rigid bodies that stand, roll, fall and collide, and repeat to the bit."""

from ._headpin._engine import (
    Body,
    Compound,
    Cone,
    Cylinder,
    Ellipsoid,
    HalfSpace,
    MassProperties,
    Part,
    Polyhedron,
    World,
    about_centre,
    closest_points,
    mass_properties,
)

__all__ = [
    "Body",
    "Compound",
    "Cone",
    "Cylinder",
    "Ellipsoid",
    "HalfSpace",
    "MassProperties",
    "Part",
    "Polyhedron",
    "World",
    "about_centre",
    "closest_points",
    "mass_properties",
]
