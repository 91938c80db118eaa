# SPDX-License-Identifier: Apache-2.0
"""Navigation logs as loggers and spreadsheets write them: read right, or refused in a line."""

from pathlib import Path

import numpy as np
import pytest

from signum.applications.mosaic.georeference import ground_by_log
from signum.applications.mosaic.pose import Pose
from signum.applications.mosaic.track import TimedTrack, Track
from signum.applications.mosaic.track_reader import read_navigation, read_track
from signum.common.errors import SignumError
from signum.geometry.earth import project

E0, N0, PIXEL = 690_000.0, 6_090_000.0, 0.002
SPOTS = [complex(40 * k, 25 * (k % 3)) for k in range(8)]
"""Of the frames' centres, pixels of the mosaic plane, which is north up."""
POSES = [Pose(f"{k:03d}", z.real, z.imag, 0.0, 1.0, 100.0 + 0.1 * k) for k, z in enumerate(SPOTS)]
EAST = [E0 + PIXEL * z.real for z in SPOTS]
NORTH = [N0 - PIXEL * z.imag for z in SPOTS]
METRES = [f"{e:.4f},{n:.4f}" for e, n in zip(EAST, NORTH, strict=True)]


def _log(path: Path, head: str, rows: list[str]) -> Path:
    path.write_text("\n".join([head, *rows]) + "\n")
    return path


def _placed(path: Path, epsg: int = 32755, poses: list[Pose] = POSES) -> dict[str, complex]:
    return read_navigation(path, "survey", epsg).of(poses).positions


def _expected(epsg: int = 32755) -> dict[str, complex]:
    return {p.frame: complex(e, -n) for p, e, n in zip(POSES, EAST, NORTH, strict=True)}


NAMES = {"padded": "{:03d}", "unpadded": "{}", "with ending": "{:03d}.png", "with folder": "C:\\dive\\{:03d}.JPG",
         "raw file": "dcim/{:03d}.NEF"}


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("kind", NAMES)
def test_names_and_separators(tmp_path: Path, kind: str, separator: str) -> None:
    rows = [f"{NAMES[kind].format(k)},{place}".replace(",", separator) for k, place in enumerate(METRES)]
    path = _log(tmp_path / "n.csv", "Frame,Easting,Northing".replace(",", separator), rows)
    assert _placed(path) == pytest.approx(_expected())


def test_a_number_that_two_frames_have_is_none(tmp_path: Path) -> None:
    path = _log(tmp_path / "n.csv", "frame,x,y", ["1,0,0", "01,5,5", "2,1,1"])
    assert set(read_track(path).of(POSES).positions) == {"002"}


@pytest.mark.parametrize("cell", ["nan", "", "inf", "-Infinity", "1e999", "N/A"])
def test_rows_without_a_position_are_left_out_and_named(tmp_path: Path, cell: str, capsys: pytest.CaptureFixture[str]
                                                        ) -> None:
    rows = [f"{k:03d},{place}" for k, place in enumerate(METRES)]
    rows[4] = f"004,{cell},{NORTH[4]}"
    found = _placed(_log(tmp_path / "n.csv", "frame,east_m,north_m", rows))
    said = capsys.readouterr().err
    assert f"1 of 8 rows have no position and are left out: frame 004: east_m is {cell or 'empty'}" in said
    assert found == pytest.approx({k: v for k, v in _expected().items() if k != "004"})
    with pytest.raises(SignumError, match="no row has a position: frame 000: east_m is nan"):
        read_navigation(_log(tmp_path / "m.csv", "frame,east_m,north_m", ["000,nan,1", "001,,"]))


def test_a_receiver_without_a_fix_is_no_place_off_africa(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = ["000,-35.31,149.05", "001,0.0,0.0", "002,-35.31001,149.05001"]
    track = read_navigation(_log(tmp_path / "n.csv", "frame,lat,lon", rows))
    assert isinstance(track, Track) and set(track.positions) == {"000", "002"}
    assert "frame 001: latitude and longitude are 0" in capsys.readouterr().err


@pytest.mark.parametrize(("latitude", "longitude", "epsg"), [
    (-35.31, 149.05, 32755), (60.0, 5.0, 32631), (0.5, -179.999, 32601), (-0.5, 179.999, 32760), (83.9, 0.0, 32631),
    (10.0, 180.0, 32601)])
def test_zone_and_hemisphere_are_found(tmp_path: Path, latitude: float, longitude: float, epsg: int) -> None:
    rows = [f"{k:03d},{latitude + 1e-6 * k:.7f},{longitude:.7f}" for k in range(4)]
    track = read_navigation(_log(tmp_path / "n.csv", "frame,latitude,longitude", rows))
    assert track.epsg == epsg and track.accuracy_m == 0
    places = track.of(POSES).positions
    # A meridian's degree is 110.6 to 111.7 km long, UTM's scale 0.9996 to 1.001.
    assert abs(places["003"] - places["000"]) == pytest.approx(3e-6 * 111_150, rel=0.008)


def test_a_survey_across_the_180th_meridian_stays_together() -> None:
    found = project(np.full(5, -17.0), np.array([179.9999, -179.9999, 179.9999, 180.0, -180.0]))
    assert found.epsg in (32701, 32760) and np.ptp(found.east) < 25


def test_degrees_in_columns_of_metres(tmp_path: Path) -> None:
    degrees = [f"{k:03d},{149.05 + 2.2e-8 * z.real:.9f},{-35.31 - 1.8e-8 * z.imag:.9f}" for k, z in enumerate(SPOTS)]
    path = _log(tmp_path / "n.csv", "frame,east_m,north_m", degrees)
    with pytest.raises(SignumError, match=r"n.csv: east_m and north_m look like degrees: 149.05.* mm wide") as error:
        read_navigation(path)
    assert "\n" not in str(error.value)
    # One stray fix hides how small the survey is; that a pixel covers nanometres cannot be hidden.
    path = _log(tmp_path / "n.csv", "frame,east_m,north_m", [*degrees, "099,10,10"])
    with pytest.raises(SignumError, match=r"a pixel would cover 2.*e-08 m, which no camera"):
        ground_by_log(POSES, read_navigation(path))
    # Real metres about a point of one's own, however near to it, are no degrees.
    near = [f"{k:03d},{PIXEL * z.real / 100:.6f},{PIXEL * z.imag / 100:.6f}" for k, z in enumerate(SPOTS)]
    assert read_navigation(_log(tmp_path / "n.csv", "frame,east_m,north_m", near)).epsg == 0


@pytest.mark.parametrize(("epsg", "says"), [
    (4326, "4326 is WGS 84, in degrees"), (7844, "in degrees"), (4978, "a Geocentric CRS"), (2225, "US survey foot"),
    (2053, "count to the west and south"), (5698, "a Compound CRS"), (32767, "there is no such system"),
    (27700, r"75\.26.* N, 167\.739.* E, outside of EPSG 27700, OSGB36"), (32654, "")])
def test_systems_that_the_coordinates_cannot_be_of(tmp_path: Path, epsg: int, says: str) -> None:
    path = _log(tmp_path / "n.csv", "frame,east_m,north_m", [f"{k:03d},{place}" for k, place in enumerate(METRES)])
    if says:
        with pytest.raises(SignumError, match=says):
            read_navigation(path, epsg=epsg)
    else:
        assert read_navigation(path, epsg=epsg).epsg == epsg


@pytest.mark.parametrize(("rows", "says"), [
    ([f"{k:03d},{n:.3f},{e:.3f}" for k, (e, n) in enumerate(zip(EAST, NORTH, strict=True))], "swapped"),
    ([f"{k:03d},{k}.0,{k % 3}.5" for k in range(8)], "within 1000 m of"),
    ([f"{k:03d},{e / 1000:.6f},{n / 1000:.6f}" for k, (e, n) in enumerate(zip(EAST, NORTH, strict=True))], "outside")])
def test_metres_that_are_not_of_the_system(tmp_path: Path, rows: list[str], says: str) -> None:
    with pytest.raises(SignumError, match=says):
        read_navigation(_log(tmp_path / "n.csv", "frame,east_m,north_m", rows), epsg=32755)


def test_degrees_come_in_the_system_that_is_asked_for(tmp_path: Path) -> None:
    """The water tower of Caister on the British grid, an example in the Ordnance Survey's guide to its coordinates; the
    CN Tower in UTM, 17T 630084 4833438, as encyclopaedias have it."""
    path = _log(tmp_path / "n.csv", "frame,lat,lon", ["000,52.65798,1.71605", "001,52.65799,1.71605"])
    track = read_navigation(path, epsg=27700)
    assert isinstance(track, Track) and track.epsg == 27700 and 0 < track.accuracy_m <= 5
    assert abs(track.positions["000"] - complex(651_409.9, -313_177.3)) < 5
    tower = project(np.array([43.642567]), np.array([-79.387139]))
    assert tower.epsg == 32617
    assert (tower.east[0], tower.north[0]) == pytest.approx((630_084, 4_833_438), abs=1)  # which leave out the metre
    for text, says in (("000,91,0", "lat is 91; expected a number from -90 to 90"),
                       ("000,690000,6090000", "lat is 690000"), ("000,85,10", "beyond UTM")):
        with pytest.raises(SignumError, match=says):
            read_navigation(_log(tmp_path / "n.csv", "frame,lat,lon", [text]))


def test_metres_are_taken_where_their_system_is_given(tmp_path: Path) -> None:
    path = _log(tmp_path / "n.csv", "frame,lat,lon,east_m,north_m", ["000,-35.3,149.0,690000,6090000"])
    assert _placed(path) == {"000": complex(E0, -N0)}
    assert abs(_placed(path, 0)["000"] - complex(E0, -N0)) > 1000
    assert read_track(path).positions == {"000": complex(E0, -N0)}


def _timed(path: Path, times: list[object], places: list[complex], clock: str = "time_s") -> TimedTrack:
    rows = [f"{t},{z.real},{z.imag}" for t, z in zip(times, places, strict=True)]
    track = read_navigation(_log(path, f"{clock},east_m,north_m", rows))
    assert isinstance(track, TimedTrack)
    return track


def test_a_log_by_time_is_read_between_its_fixes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Fixes at 99.9 to 100.3 s and 104 to 104.3 s: frames 000 to 003 lie between fixes, 004 to 007 in the gap."""
    early, late = [99.9, 100.05, 100.3], [104.0, 104.1, 104.2, 104.3]
    track = _timed(tmp_path / "n.csv", [*early, *late], [complex(10 * t, 5) for t in (*early, *late)])
    found = track.of(POSES).positions
    assert found == pytest.approx({f"{k:03d}": complex(1000 + k, -5) for k in range(4)})
    assert "4 frames (004, 005, 006, 007) lie in a gap of the log" in capsys.readouterr().err
    short = _timed(tmp_path / "n.csv", [100.15, 100.35, 100.55], [0j, 2 + 0j, 4 + 0j])
    assert set(short.of(POSES).positions) == {"002", "003", "004", "005"}
    assert "4 frames (000, 001, 006, 007) lie outside the log, its times are 100.15 s to 100.55 s" in (
        capsys.readouterr().err)
    with pytest.raises(SignumError, match=r"times are 0 s to 0.9 s, those of the frames 100 s to 100.7 s; .*--start"):
        _timed(tmp_path / "n.csv", [0, 0.9], [0j, 1j]).of(POSES)
    with pytest.raises(SignumError, match="all positions are of one time"):
        _timed(tmp_path / "n.csv", [3, 3], [0j, 1j])


def test_clocks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Dates with and without a zone, rows out of order and of one time; a start moves the frames onto that clock."""
    times: list[object] = ["2026-03-01T10:00:00.1Z", "2026-03-01 10:00:00", "2026-03-01T20:00:00.2+10:00",
                           "2026-03-01T10:00:00.2"]
    track = _timed(tmp_path / "n.csv", times, [1 + 0j, 0j, 2 + 0j, 4 + 0j], "UTC")
    assert track.times == pytest.approx(np.array([0, 0.1, 0.2]) + 1772359200)
    assert track.positions == pytest.approx([0, 1, 3]) and "1 rows have the time of another" in capsys.readouterr().err
    moved = TimedTrack(track.path, track.times, track.positions, start=1772359200.0, first=lambda: 100.0)
    assert moved.of(POSES).positions == pytest.approx({"000": 0, "001": 1, "002": 3})
    with pytest.raises(SignumError, match=r"2026-03-01T10:00:00Z to 2026-03-01T10:00:00Z, those of the frames 100 s"):
        track.of(POSES)
    with pytest.raises(SignumError, match=r"row 1: time is '1/3/26'; expected seconds, or a date"):
        _timed(tmp_path / "n.csv", ["1/3/26", 2], [0j, 1j], "time")


def _track(places: list[complex]) -> Track:
    return Track({p.frame: z for p, z in zip(POSES, places, strict=True)}, {}, "m")


def test_a_log_of_another_shape_is_refused() -> None:
    right = [PIXEL * z for z in SPOTS]
    geo = ground_by_log(POSES, _track(right))
    assert geo.pixel_m == pytest.approx(PIXEL) and geo.fixes == geo.frames == 8 and not geo.left_out
    with pytest.raises(SignumError, match="mirror image"):
        ground_by_log(POSES, _track([z.conjugate() for z in right]))
    with pytest.raises(SignumError, match="mirror image"):
        ground_by_log(POSES, _track([complex(z.imag, z.real) for z in right]))
    rng = np.random.default_rng(1)
    with pytest.raises(SignumError, match="is not the mosaic's"):
        ground_by_log(POSES, _track([complex(*rng.normal(size=2)) for _ in right]))
    with pytest.raises(SignumError, match=r"covers 2 m, by --range and the focal length 0.002 m"):
        ground_by_log(POSES, _track([1000 * z for z in right]), PIXEL)
    stray = ground_by_log(POSES, _track([*right[:5], right[5] + 500, *right[6:]]))
    ((name, far),) = stray.left_out
    assert stray.pixel_m == pytest.approx(PIXEL) and name == "005" and far == pytest.approx(500)


def test_three_fixes_are_all_kept() -> None:
    """Of three, two fit any third being wrong: none can be told from the others."""
    track = Track({"000": 0j, "003": PIXEL * SPOTS[3] + 0.01j, "007": PIXEL * SPOTS[7]}, {}, "m")
    geo = ground_by_log(POSES, track)
    assert geo.fixes == 3 and not geo.left_out and geo.residual_m > 0.001
    track.positions["003"] += 500
    with pytest.raises(SignumError, match="is not the mosaic's"):
        ground_by_log(POSES, track)


def test_names_that_are_too_long_for_numbers(tmp_path: Path) -> None:
    path = _log(tmp_path / "n.csv", "frame,x,y", ["9" * 5000 + ",0,0", "2,1,1"])
    assert set(read_track(path).of(POSES).positions) == {"002"}
    with pytest.raises(SignumError, match="expected seconds, or a date"):
        _timed(tmp_path / "n.csv", ["0001-01-01T00:00:00+14:00x", 2], [0j, 1j])
