# SPDX-License-Identifier: Apache-2.0
"""Where on Earth coordinates are: latitude and longitude in metres of a projected system, and back, by PROJ.

Latitude and longitude are taken to be of WGS 84 (EPSG:4326), in degrees, north and east positive. Needs the extra
`geo`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from signum.common.arrays import Floats
from signum.common.errors import SignumError, lacking

if TYPE_CHECKING:
    from pyproj import CRS

WGS84 = 4326
UTM_NORTH, UTM_SOUTH = 32600, 32700
"""EPSG codes of the UTM zones of WGS 84, less the zone's number."""
UTM_LATITUDES = -80.0, 84.0
"""Where UTM ends, degrees."""
MARGIN_DEG = 1.0
"""How far a survey may lie outside the area that a system is made for, degrees."""
OWN_ORIGIN_M = 1000.0
"""Coordinates up to this from (0, 0) are metres from a point of the survey's own: no system has its origin where
people dive."""


@dataclass(frozen=True, eq=False)
class Projected:
    """Positions in metres of a projected system.

    Attributes:
        east, north: (n,) metres.
        epsg: of the system.
        accuracy_m: of the step from WGS 84 to the system's datum, metres; 0 where they are the same.
    """

    east: Floats
    north: Floats
    epsg: int
    accuracy_m: float = 0.0


def system(epsg: int) -> CRS:
    """The projected system of an EPSG code, whose axes are metres to the east and to the north.

    Raises:
        SignumError: if there is no such code, or it is none of a projection in metres; if the extra is missing.
    """
    try:
        from pyproj import CRS  # loads slowly
        from pyproj.exceptions import CRSError
    except ModuleNotFoundError as error:
        raise lacking("geo", error) from error

    remedy = "expected a projected system in metres, such as 32755 (WGS 84 / UTM zone 55S)"
    try:
        found = CRS.from_epsg(epsg)
    except CRSError:
        raise SignumError(f"--epsg {epsg}: there is no such system; {remedy}") from None
    label = f"--epsg {epsg} is {found.name}"
    if found.is_geographic:
        raise SignumError(f"{label}, in degrees: a mosaic has metres; give the code of a projected system, or columns "
                          "latitude and longitude without --epsg, for which the UTM zone is found")
    if found.type_name != "Projected CRS":
        raise SignumError(f"{label}, a {found.type_name}; {remedy}")
    if any(axis.unit_conversion_factor != 1 for axis in found.axis_info):
        raise SignumError(f"{label}, in units of {found.axis_info[0].unit_name}; {remedy}")
    if any(axis.direction == "west" for axis in found.axis_info):
        raise SignumError(f"{label}, whose axes count to the west and south; {remedy}")
    return found


def middle_of(latitude: Floats, longitude: Floats) -> tuple[float, float]:
    """Latitude and longitude of the middle of positions (n,), degrees, whatever a few stray ones are."""
    # Longitudes count from that of the first, as a survey may cross the 180th meridian.
    beside = np.mod(longitude - longitude[0] + 180, 360) - 180
    return float(np.median(latitude)), float(np.mod(longitude[0] + np.median(beside) + 180, 360) - 180)


def zone_of(latitude: float, longitude: float) -> int:
    """EPSG code of the UTM zone and hemisphere, WGS 84, that a place lies in, degrees.

    Raises:
        SignumError: if it is nearer to a pole than UTM reaches.
    """
    if not UTM_LATITUDES[0] <= latitude <= UTM_LATITUDES[1]:
        raise SignumError(f"latitude {latitude:.3f} is beyond UTM, which reaches from {UTM_LATITUDES[0]:g} to "
                          f"{UTM_LATITUDES[1]:g}: give the code of a polar system with --epsg")
    return (UTM_NORTH if latitude >= 0 else UTM_SOUTH) + int((longitude + 180) // 6) % 60 + 1


def project(latitude: Floats, longitude: Floats, epsg: int = 0) -> Projected:
    """Positions (n,), degrees, in metres of a projected system: that of `epsg`, or their UTM zone if that is 0. What
    has no place in it becomes infinite.

    Raises:
        SignumError: if most lie outside the system's area, or PROJ knows no way from WGS 84 to its datum.
    """
    middle = middle_of(latitude, longitude)
    epsg = epsg or zone_of(*middle)
    target = system(epsg)
    _check_area(*middle, target, epsg)
    from pyproj import Transformer
    from pyproj.exceptions import ProjError

    try:
        # Without the ballpark, which leaves out the shift between two datums, up to hundreds of metres.
        way = Transformer.from_crs(WGS84, target, always_xy=True, allow_ballpark=False)
        way.transform(*middle[::-1], errcheck=True)
        accuracy = float(way.get_last_used_operation().accuracy)
        east, north = way.transform(longitude, latitude)
    except ProjError as error:
        raise SignumError(f"no way is known from WGS 84 to EPSG {epsg}, {target.name}: give another --epsg, or none "
                          "for the UTM zone") from error
    return Projected(np.asarray(east, np.float64), np.asarray(north, np.float64), epsg, max(accuracy, 0.0))


def degrees_of(east: float, north: float, epsg: int) -> tuple[float, float]:
    """Latitude and longitude of a position in metres of a projected system, degrees; infinite where there is none.

    The step from the system's datum to WGS 84 may be off by metres: this is for orientation.
    """
    target = system(epsg)
    from pyproj import Transformer

    longitude, latitude = Transformer.from_crs(target, WGS84, always_xy=True).transform(east, north)
    return float(latitude), float(longitude)


def check_metres(east: Floats, north: Floats, epsg: int) -> None:
    """Check that positions (n,) in metres, apart from a few stray ones, can be of a projected system.

    Raises:
        SignumError: if they lie outside its area, or count from an origin of their own.
    """
    target = system(epsg)
    middle = float(np.median(east)), float(np.median(north))
    if max(map(abs, middle)) < OWN_ORIGIN_M:
        raise SignumError(f"positions within {OWN_ORIGIN_M:g} m of (0, 0), which is no place of EPSG {epsg}, "
                          f"{target.name}: leave --epsg out for metres from a point of your own, or give the "
                          "coordinates of that system")
    _check_area(*degrees_of(*middle, epsg), target, epsg)


def _check_area(latitude: float, longitude: float, target: CRS, epsg: int) -> None:
    """Check that a place, degrees, lies in the area that a system is made for, with a margin.

    Raises:
        SignumError: if it does not.
    """
    area = target.area_of_use
    if area is None:
        return
    # East of the western bound by less than the area's width, as an area may reach across the 180th meridian.
    width = (area.east - area.west) % 360 or 360.0
    beyond = (longitude - area.west + MARGIN_DEG) % 360 > width + 2 * MARGIN_DEG
    inside = area.south - MARGIN_DEG <= latitude <= area.north + MARGIN_DEG and not beyond
    if not inside:
        spot = f"at {place_text(latitude, longitude)}" if math.isfinite(latitude) else "nowhere on Earth"
        raise SignumError(f"positions {spot}, outside of EPSG {epsg}, {target.name}, which is for latitudes "
                          f"{area.south:g} to {area.north:g}, longitudes {area.west:g} to {area.east:g}: give the code "
                          "of the system that the coordinates are of, and look whether east and north are swapped")


def place_text(latitude: float, longitude: float) -> str:
    """A place for people: 35.31000 S, 149.05000 E (a metre and a half a digit)."""
    return (f"{abs(latitude):.5f} {'N' if latitude >= 0 else 'S'}, "
            f"{abs(longitude):.5f} {'E' if longitude >= 0 else 'W'}")
