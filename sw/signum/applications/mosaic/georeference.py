# SPDX-License-Identifier: Apache-2.0
"""Where on earth a mosaic is: scale from the camera's range, or scale, rotation and place from a navigation log.

The mosaic is turned north up where north is known. A log that cannot be right is refused rather than followed to a
wrong place.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signum.applications.mosaic.accuracy import align
from signum.applications.mosaic.blend import Mosaic
from signum.applications.mosaic.pose import Pose
from signum.applications.mosaic.track import TimedTrack, Track, listed
from signum.common.arrays import Complexes, Floats
from signum.common.errors import SignumError
from signum.geometry.earth import degrees_of, place_text, system
from signum.geometry.similarity import Similarity

OUTLIER = 3.0
"""Factor of the usual distance beyond which a fix is left out."""
NEAR_PX = 1.0
"""A fix that is off by up to this, pixels, is never left out."""
PAIRED = 40
"""Most fixes of which all pairs are tried."""
REDUNDANT = 4
"""Fewest fixes of which a wrong one can be told from the others."""
UNLIKE = 0.5
"""A log whose usual distance from the mosaic is more than this share of its extent does not belong to it."""
MIRRORED = 0.3
"""A log that its mirror image fits by this factor better has swapped or reversed axes."""
LEAST_PIXEL_M, LARGEST_PIXEL_M = 1e-5, 100.0
"""What a pixel can cover, metres: finer than any camera's, coarser than any survey's."""
SCALES_AGREE = 2.0
"""Most the scale by the log and by range and focal length differ, as a factor."""


@dataclass(frozen=True)
class Georeference:
    """The mosaic plane on the ground.

    Attributes:
        onto: pixels of the mosaic plane -> metres, east and south (y down).
        known: what is known, for the file's citation: "local" metres from the first frame, or the log's coordinates.
        epsg: code of the projected reference system; 0 where none is given.
        residual_m: root-mean-square distance of the frames from their logged places; 0 without a log.
        fixes: frames whose place the log has.
        frames: all that are placed.
        left_out: frames whose logged place is too far off to count, and the distance, metres.
        accuracy_m: of the step from latitude and longitude to the system's datum, metres.
    """

    onto: Similarity
    known: str
    epsg: int = 0
    residual_m: float = 0.0
    fixes: int = 0
    frames: int = 0
    left_out: tuple[tuple[str, float], ...] = ()
    accuracy_m: float = 0.0

    @property
    def upright(self) -> Similarity:
        """Mosaic plane -> the same turned north up, still in pixels."""
        return Similarity(self.onto.factor / abs(self.onto.factor))

    @property
    def pixel_m(self) -> float:
        """Metres a pixel of the mosaic plane covers."""
        return self.onto.scale


def ground_by_range(pixel_m: float, centre: tuple[float, float]) -> Georeference:
    """Scale from the camera's range and focal length; metres east and north of the first frame's centre, its up being
    north.

    Args:
        pixel_m: metres a pixel of the first frame covers, range over focal length.
        centre: of the first frame, pixels.
    """
    return Georeference(Similarity(complex(pixel_m), -pixel_m * complex(*centre)), "local, metres from the first frame")


def ground_by_log(poses: list[Pose], log: Track | TimedTrack, expected_m: float = 0.0) -> Georeference:
    """Scale, rotation and place from a navigation log, without outlying fixes.

    Args:
        poses: of the frames of a component.
        log: positions in metres, by frame or time.
        expected_m: metres a pixel by the camera's range and focal length; 0 where they are not known.

    Raises:
        SignumError: if it has positions for fewer than two of the frames, is in pixels, or cannot belong to this
            mosaic: its shape is another, or mirrored, or the scale is not that of a camera.
    """
    track = log.of(poses)
    known = [p for p in poses if p.frame in track.positions]
    if track.unit != "m":
        raise SignumError("the navigation log gives pixels: it needs metres, columns east_m and north_m, or latitude "
                          "and longitude")
    if len(known) < 2:
        theirs = f"its frames are called {', '.join(list(log.positions)[:3])}, ..., those of the mosaic " \
                 f"{', '.join(p.frame for p in poses[:3])}, ..." if isinstance(log, Track) else "see its times"
        raise SignumError(f"the navigation log has positions for {len(known)} of the {len(poses)} placed frames, two "
                          f"are needed: {theirs}")
    z = np.array([complex(p.x_px, p.y_px) for p in known])
    w = np.array([track.positions[p.frame] for p in known])
    onto, off, good = _fit(z, w)
    _check_scale(onto.scale, expected_m)
    _check_shape(z, w, off)
    left_out = tuple((p.frame, float(far)) for p, far, used in zip(known, off, good, strict=True) if not used)
    return Georeference(onto, "navigation log, metres", track.epsg, float(np.sqrt(np.mean(off[good]**2))), len(known),
                        len(poses), left_out, track.accuracy_m)


def _fit(z: Complexes, w: Complexes) -> tuple[Similarity, Floats, np.ndarray[tuple[int], np.dtype[np.bool_]]]:
    """The similarity of points z (n,) onto w (n,) without outliers, the distance of each (n,), and which were used."""
    if len(z) < REDUNDANT:
        onto = align(z, w)
        return onto, np.abs(onto.factor * z + onto.shift - w), np.ones(len(z), bool)
    onto = _least_median(z, w)
    for _ in range(10):
        off = np.abs(onto.factor * z + onto.shift - w)
        good = off <= max(OUTLIER * 1.4826 * float(np.median(off)), NEAR_PX * onto.scale)
        better = align(z[good], w[good])
        if better == onto:
            break
        onto = better
    return onto, np.abs(onto.factor * z + onto.shift - w), good


def _check_scale(pixel_m: float, expected_m: float) -> None:
    """Check that a pixel covers what it can, metres.

    Raises:
        SignumError: if it does not.
    """
    if not LEAST_PIXEL_M < pixel_m < LARGEST_PIXEL_M:
        raise SignumError(f"by the navigation log a pixel would cover {pixel_m:.2g} m, which no camera does: it needs "
                          "metres (not degrees or kilometres) of these frames, at fixes that are apart")
    if expected_m and not 1 / SCALES_AGREE < pixel_m / expected_m < SCALES_AGREE:
        raise SignumError(f"by the navigation log a pixel covers {pixel_m:.3g} m, by --range and the focal length "
                          f"{expected_m:.3g} m: one of them is in other units, or the log is of other frames")


def _check_shape(z: Complexes, w: Complexes, off: Floats) -> None:
    """Check that a track w (n,) has the shape of the mosaic's z (n,); `off` (n,) is what the best fit leaves.

    Raises:
        SignumError: if it has another, or is its mirror image.
    """
    if len(z) < 3:
        return
    miss = float(np.median(off))
    if len(z) >= REDUNDANT and float(np.median(_fit(z.conj(), w)[1])) < MIRRORED * miss:
        raise SignumError("the navigation log's track is the mirror image of the mosaic's: east and north are swapped, "
                          "or one of them counts the other way")
    extent = float(np.median(np.abs(w - complex(np.median(w.real), np.median(w.imag)))))
    if miss > UNLIKE * extent:
        raise SignumError(f"the navigation log's track is not the mosaic's: after the best fit its fixes are "
                          f"{miss:.3g} m off, of an extent of {extent:.3g} m; is it the log of these frames, and of "
                          "the same clock?")


def _least_median(z: Complexes, w: Complexes) -> Similarity:
    """The similarity through two points whose median miss is is least: up to half of the fixes may be wrong."""
    chosen = np.unique(np.linspace(0, len(z) - 1, min(len(z), PAIRED)).astype(int))
    best, least = align(z, w), np.inf
    for i in chosen:
        for j in chosen[chosen > i]:
            if z[i] != z[j] and w[i] != w[j]:
                factor = complex((w[j] - w[i]) / (z[j] - z[i]))
                miss = float(np.median(np.abs(factor * (z - z[i]) - (w - w[i]))))
                if miss < least:
                    best, least = Similarity(factor, complex(w[i] - factor * z[i])), miss
    return best


def world_of(mosaic: Mosaic, geo: Georeference) -> tuple[float, float, float]:
    """Metres a pixel, and east and north of the centre of the top left pixel, of a mosaic made in the upright plane."""
    step = geo.pixel_m / mosaic.scale
    corner = geo.onto.factor / geo.upright.factor * complex(*mosaic.origin) + geo.onto.shift
    return step, corner.real, -corner.imag


def ground_lines(name: str, mosaic: Mosaic, geo: Georeference) -> list[str]:
    """What is to be said of where a mosaic lies: by which fixes, in which system, and where on Earth.

    Args:
        name: of the GeoTIFF.
        mosaic: made in the upright plane.
        geo: its place.
    """
    step, east, north = world_of(mosaic, geo)
    about = f"{name}: {step:.4g} m a pixel"
    if not geo.fixes:
        return [f"{about}, in metres from the first frame: it has no place on Earth, for which --navigation or --exif "
                "is needed"]
    lines = [f"{about}, laid by {geo.fixes - len(geo.left_out)} fixes for {geo.frames} frames, which they miss by "
             f"{geo.residual_m:.3g} m RMS"]
    if geo.fixes == 2:
        lines.append(f"{name}: two fixes alone lay it: nothing checks them")
    if geo.left_out:
        far = listed([f"{frame} ({metres:.3g} m)" for frame, metres in geo.left_out])
        lines.append(f"{name}: fixes that do not fit the others are left out: {far}")
    if not geo.epsg:
        lines.append(f"{name}: no --epsg was given: its metres are of an unknown system, and no map program can place "
                     "it on Earth")
        return lines
    height, width = mosaic.picture.shape[:2]
    middle = place_text(*degrees_of(east + step * (width - 1) / 2, north - step * (height - 1) / 2, geo.epsg))
    lines.append(f"{name}: EPSG {geo.epsg}, {system(geo.epsg).name}; its middle is at {middle}")
    if geo.accuracy_m:
        lines.append(f"{name}: latitude and longitude were taken as WGS 84, from which the way to the datum of EPSG "
                     f"{geo.epsg} is known to {geo.accuracy_m:g} m")
    return lines
