# SPDX-License-Identifier: Apache-2.0
"""Errors against truth, worked out by hand; edges and tracks read back; mosaics on the ground."""

import math
from pathlib import Path

import numpy as np
import pytest
import tifffile

from signum.applications.mosaic.accuracy import accuracy_rows, pose_errors
from signum.applications.mosaic.blend import Mosaic
from signum.applications.mosaic.edges import LOOP, Edge
from signum.applications.mosaic.georeference import ground_by_log, ground_by_range, world_of
from signum.applications.mosaic.geotiff import write_geotiff, write_world_file
from signum.applications.mosaic.pose import Pose
from signum.applications.mosaic.track import Track
from signum.applications.mosaic.track_reader import read_track
from signum.common.errors import SignumError
from signum.geometry.similarity import Similarity
from signum.tables.schemas import SURVEY_EDGES


def _square(unit: float, turn_deg: float, nudge: complex = 0j) -> list[Pose]:
    """Poses of a square of side 100 px, seen turned and scaled; `nudge` moves the last."""
    corners = [0, 100, 100 + 100j, 100j]
    onto = Similarity.of(turn_deg, unit, (7.0, -3.0))
    placed = [onto.factor * z + onto.shift for z in corners]
    placed[3] += nudge
    return [Pose(str(k), z.real, z.imag, turn_deg, unit) for k, z in enumerate(placed)]


def test_similarity_is_taken_out_and_rigid_leaves_the_scale() -> None:
    truth = Track({str(k): z for k, z in enumerate([0j, 10 + 0j, 10 + 10j, 10j])}, {}, "m")
    free = pose_errors(_square(0.5, 30.0), truth)
    assert free.ape == pytest.approx(np.zeros(4), abs=1e-12) and free.rpe == pytest.approx(np.zeros(3), abs=1e-12)
    assert free.onto.scale == pytest.approx(0.2) and free.onto.rot_deg == pytest.approx(-30)
    # A square of side 50 onto one of side 10 about the same middle: corners 40/sqrt(2) apart, sides 40 longer.
    rigid = pose_errors(_square(0.5, 30.0), truth, scaled=False)
    assert rigid.ape == pytest.approx(np.full(4, 40 / math.sqrt(2))) and rigid.rpe == pytest.approx(np.full(3, 40))


def test_ape_and_rpe_by_hand() -> None:
    """Three points on a line, the middle one 3 off across: a rigid motion moves all by 1, so errors are 1, 2, 1. The
    best similarity shrinks by 200/206 as well."""
    truth = Track({"a": 0j, "b": 10 + 0j, "c": 20 + 0j}, {"a": 0.0, "b": 10.0, "c": 350.0}, "px")
    poses = [Pose("a", 0, 0, 0, 1), Pose("b", 10, 3, 12, 1), Pose("c", 20, 0, -11, 1)]
    error = pose_errors(poses, truth, scaled=False)
    assert error.ape == pytest.approx([1, 2, 1]) and error.rpe == pytest.approx([3, 3])
    free = pose_errors(poses, truth)
    assert free.ape == pytest.approx(np.array([math.hypot(200, 60), 400, math.hypot(200, 60)]) / 206)
    assert error.turn == pytest.approx([2, 3])
    line = accuracy_rows("all links", error, "px")
    assert line[0][:4] == ["all links", "APE after similarity", "px", f"{math.sqrt(2):.4f}"]
    assert line[1][3] == "3.0000" and line[2][1:4] == ["RPE, rotation", "deg", f"{math.sqrt(6.5):.4f}"]


def test_tracks_are_read_and_bad_ones_named(tmp_path: Path) -> None:
    def write(text: str) -> Path:
        path = tmp_path / "t.csv"
        path.write_text(text)
        return path

    track = read_track(write("Frame,East_m,North_m,heading_deg\na.png,1,2,90\nb.png,3,5,\n"))
    assert track.positions == {"a": 1 - 2j, "b": 3 - 5j} and track.headings == {"a": 90.0} and track.unit == "m"
    assert read_track(write("frame,x_px,y_px\n1,1,2\n")).positions == {"1": 1 + 2j}
    runs = "frame,path,E_centre_m,N_centre_m\n1,x/test1/1.tif,1,1\n1,x/test5/1.tif,9,9\n"
    assert read_track(write(runs), "data/test5").positions == {"1": 9 - 9j}
    for text, says in (("frame,x\n1,2\n", "no column for metres to the north"), ("a,b\n1,2\n", "the frame's name"),
                       ("frame,x,y\n1,2,3\n1,2,3\n", "listed twice"), ("frame,x,y\n1,two,3\n", "expected a number"),
                       ("frame,x,y\n", "no rows")):
        with pytest.raises(SignumError, match=says):
            read_track(write(text))
    with pytest.raises(SignumError, match="at least 3 must"):
        pose_errors(_square(1, 0), read_track(write("frame,x,y\n1,2,3\n9,2,3\n")))


def test_an_edge_has_all_its_bits_in_the_table() -> None:
    edge = Edge("a,1", "b", LOOP, Similarity.of(-7.7, 1.08, (-286.5, 192.6)), (287.5, 191.5), 0.71, 0.12, True,
                (201.25, 80.5), 133.25, 1 / 3, 15, 24, "")
    row = dict(zip(SURVEY_EDGES, map(str, edge.row), strict=True))
    assert (float(row["dx_px"]), float(row["dy_px"])) == edge.shift and float(row["rms_px"]) == 1 / 3
    assert float(row["rot_deg"]) == edge.similarity.rot_deg and float(row["scale"]) == edge.similarity.scale
    assert (row["frame_a"], row["accepted"], row["kind"]) == ("a,1", "1", "loop")


def _tags(path: Path) -> dict[str, object]:
    with tifffile.TiffFile(path) as file:
        page = file.pages[0]
        assert isinstance(page, tifffile.TiffPage)
        return {str(tag.name): tag.value for tag in page.tags.values()}


@pytest.mark.parametrize("colour", [False, True])
def test_geotiff_from_a_navigation_log(tmp_path: Path, colour: bool) -> None:
    """A camera that looks down with image up to the east, 2 cm a pixel, over known ground, one fix far off."""
    rng = np.random.default_rng(0)
    poses = [Pose(str(k), 50.0 + 3 * (k % 3), 40.0 - 30 * k, 0, 1) for k in range(6)]
    # Image up is east, so image right is south.
    log = Track({p.frame: complex(500_000 - 0.02 * p.y_px, -(4_000_000 - 0.02 * p.x_px)) for p in poses}, {}, "m",
                32755)
    log.positions["4"] += 50
    geo = ground_by_log(poses, log)
    assert geo.pixel_m == pytest.approx(0.02) and geo.residual_m < 1e-6
    picture = rng.integers(0, 255, (40, 60, 3) if colour else (40, 60), dtype=np.uint8)
    mosaic = Mosaic(picture, (-100.0, -10.0), 0.5)
    write_geotiff(tmp_path / "m.tif", mosaic, geo)
    write_world_file(tmp_path / "m.pgw", mosaic, geo)
    tags = _tags(tmp_path / "m.tif")
    assert tags["ModelPixelScaleTag"] == pytest.approx((0.04, 0.04, 0))
    keys = np.array(tags["GeoKeyDirectoryTag"]).reshape(-1, 4)
    told = {int(k[0]): int(k[3]) for k in keys[1:]}
    assert keys[0].tolist() == [1, 1, 1, len(keys) - 1] and list(told) == sorted(told)
    assert told[1024] == 1 and told[1025] == 1 and told[3072] == 32755 and told[3076] == 9001
    # Where a point of the plane is on the ground, by the log's own rule, against where the tags put its pixel.
    plane = np.array([12.0, -33.0])
    up = geo.upright(plane)
    pixel = (up - np.array(mosaic.origin)) * mosaic.scale
    tie = np.array(tags["ModelTiepointTag"])
    east, north = tie[3] + (pixel[0] + 0.5) * 0.04, tie[4] - (pixel[1] + 0.5) * 0.04
    assert (east, north) == pytest.approx((500_000 - 0.02 * plane[1], 4_000_000 - 0.02 * plane[0]), abs=1e-6)
    a, d, b, e, c, f = (float(v) for v in (tmp_path / "m.pgw").read_text().split())
    assert (a, d, b, e) == pytest.approx((0.04, 0, 0, -0.04))
    assert (c + a * pixel[0], f + e * pixel[1]) == pytest.approx((east, north), abs=1e-6)
    back = tifffile.imread(tmp_path / "m.tif")
    assert np.array_equal(back[:, :, ::-1] if colour else back, picture)


def test_scale_from_range() -> None:
    geo = ground_by_range(2.0 / 500.0, (287.5, 191.5))
    step, east, north = world_of(Mosaic(np.zeros((4, 4), np.uint8), (287.5, 191.5), 1.0), geo)
    assert step == pytest.approx(0.004) and (east, north) == pytest.approx((0, 0))
    with pytest.raises(SignumError, match="two are needed"):
        ground_by_log(_square(1, 0), Track({"0": 0j}, {}, "m"))
