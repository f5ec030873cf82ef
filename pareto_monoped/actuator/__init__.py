"""Stage 1: from a motor to the lightest actuator for every gear ratio.

Order of imports, lowest first: assumptions, bearings, rating.geometry, windings; motor, rating.load, settings; gearset,
motors, needles; rating.capacity, webs; layout, rating.stage; features, rating.sheet, rating.strike, service.loads;
external_housing, planet_bearings, rating.build; front, rating.width; external, internal, rules; actuator; ratiomap,
service.bearing_life, service.stiffness; judge, service.sheet; explain, search, tolerances.
"""

__all__ = [
    "actuator",
    "assumptions",
    "bearings",
    "explain",
    "gearset",
    "layout",
    "motor",
    "motors",
    "needles",
    "rating",
    "ratiomap",
    "search",
    "service",
    "settings",
    "tolerances",
    "windings",
]
