# SPDX-License-Identifier: Apache-2.0
"""The undamaged inputs: a small folder of each kind, and the command that reads it."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore
from skimage import data

from signum.common.arrays import Image
from signum.common.files import write_picture

DISPARITY = 8
"""Of the stereo pair, pixels."""
FRAMES, SIZE, STEP = 4, (160, 120), (8, 6)
"""Number of frames, width and height, and how far the view moves from one to the next, pixels."""
SMALL = "--window", "32"


@dataclass(frozen=True)
class Kind:
    """A kind of input.

    Attributes:
        command: the command line, with {in} and {out} for the folders.
        victims: glob patterns of the files that are damaged.
        checksum: whether the files carry checksums, so that no damage may pass.
        weight: how often it is drawn.
        resumed: whether the command continues in a copy of the input's folder `survey`.
    """

    command: tuple[str, ...]
    victims: tuple[str, ...] = ("*",)
    checksum: bool = False
    weight: int = 4
    resumed: bool = False


FLOW = "flow", "--step", "64", *SMALL, "--out", "{out}"
TRACK = "track", "--features", "6", *SMALL, "--out", "{out}"
MOSAIC = "mosaic", "{in}/pictures", "--no-live", "--columns", "single", *SMALL, "--out"
KINDS = {
    **{kind: Kind(("filter", f"{{in}}/a.{kind}", "--out", "{out}"), checksum=kind == "png", weight=3)
       for kind in ("png", "jpg", "tif", "bmp", "pgm", "webp")},
    "folder": Kind((*TRACK, "{in}"), checksum=True),
    "mp4": Kind((*FLOW, "{in}/dive.mp4")),
    "avi": Kind((*FLOW, "{in}/dive.avi")),
    "npy": Kind((*FLOW, "{in}/dive.npy"), weight=6),
    "bag": Kind((*FLOW, "{in}/dive.bag"), weight=6),
    "db3": Kind((*FLOW, "{in}/dive"), ("dive/*",), weight=6),
    "mcap": Kind((*FLOW, "{in}/dive.mcap"), checksum=True, weight=6),
    "plain": Kind((*FLOW, "{in}/dive.mcap"), weight=6),
    "jpegs": Kind((*FLOW, "{in}/dive.bag"), weight=3),
    "calibration": Kind((*FLOW, "{in}/dive.npy", "--calibration", "{in}/c.yaml"), ("c.yaml",), weight=9),
    "camera_info": Kind((*FLOW, "{in}/dive.npy", "--calibration", "{in}/c.yaml"), ("c.yaml",), weight=5),
    "kalibr": Kind((*FLOW, "{in}/dive.npy", "--calibration", "{in}/c.yaml"), ("c.yaml",), weight=4),
    "stereo": Kind(("stereo", "{in}/l.png", "{in}/r.png", "--step", "48", "--calibration", "{in}/c.yaml", "--out",
                    "{out}"), ("c.yaml",), weight=9),
    "navigation": Kind((*MOSAIC, "{out}", "--navigation", "{in}/n.csv"), ("n.csv",), weight=5),
    "fixes": Kind((*MOSAIC, "{out}", "--rate", "10", "--navigation", "{in}/n.csv"), ("n.csv",), weight=3),
    "truth": Kind((*MOSAIC, "{out}", "--truth", "{in}/n.csv"), ("n.csv",), weight=3),
    "resume": Kind((*MOSAIC, "{in}/survey", "--resume"), ("survey/*.csv", "survey/run.json", "survey/frames/*"),
                   weight=5, resumed=True),
    "report": Kind(("report", "{in}/track"), ("track/*.csv", "track/track.png"), weight=3),
    "chart": Kind(("navigate", "{in}", "{in}/dive.npy", "--goto", "rock", *SMALL, "--out", "{out}"),
                  ("places.csv", "mosaic.png"), weight=3),
    "options": Kind(("flow", "{in}/dive.npy", "--out", "{out}"), weight=9),
    "names": Kind((*TRACK, "{in}"), weight=4),
}
"""Every kind of input that a command reads."""

CAMERA_INFO = """image_width: 160
image_height: 120
camera_name: narrow
camera_matrix:
  rows: 3
  cols: 3
  data: [160.0, 0.0, 79.5, 0.0, 160.0, 59.5, 0.0, 0.0, 1.0]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [0.05, 1e-2, 0.0, 0.0, 0.0]
"""
"""A camera as ROS writes it."""
KALIBR = """cam0:
  camera_model: pinhole
  distortion_coeffs: [0.05, 0.01, 0.0, 0.0]
  distortion_model: equidistant
  intrinsics: [160.0, 160.0, 79.5, 59.5]
  resolution: [160, 120]
"""
"""A fisheye camera as Kalibr writes it."""


def frames() -> list[Image]:
    """A straight flight over a photograph of gravel."""
    floor = np.asarray(data.gravel(), np.uint8)
    (width, height), (dx, dy) = SIZE, STEP
    return [np.ascontiguousarray(floor[60 + k * dy:60 + k * dy + height, 60 + k * dx:60 + k * dx + width])
            for k in range(FRAMES)]


def build(folder: Path) -> None:
    """Write the inputs of every kind but `resume` and `report`, which are made by commands, into folders of their
    names."""
    pictures = frames()
    for kind in KINDS:
        (folder / kind).mkdir(parents=True)
    for kind in ("png", "jpg", "tif", "bmp", "pgm", "webp"):
        write_picture(folder / kind / f"a.{kind}", pictures[0])
    for name in ("folder", "names", "navigation/pictures", "fixes/pictures", "truth/pictures", "resume/pictures"):
        (folder / name).mkdir(exist_ok=True)
        for k, picture in enumerate(pictures):
            write_picture(folder / name / f"{k}.png", picture)
    for kind, code in (("mp4", "mp4v"), ("avi", "MJPG")):
        writer = cv2.VideoWriter(str(folder / kind / f"dive.{kind}"), cv2.VideoWriter.fourcc(*code), 10, SIZE)
        for picture in pictures:
            writer.write(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR))
        writer.release()
    for kind in ("npy", "calibration", "camera_info", "kalibr", "chart", "options"):
        np.save(folder / kind / "dive.npy", np.stack(pictures))
    _bag(folder / "bag" / "dive.bag", pictures)
    _bag(folder / "jpegs" / "dive.bag", pictures, jpeg=True)
    _bag(folder / "db3" / "dive", pictures)
    for kind in ("mcap", "plain"):
        _bag(folder / kind / "made", pictures, StoragePlugin.MCAP)
        (folder / kind / "made" / "made.mcap").rename(folder / kind / "dive.mcap")
        (folder / kind / "made" / "metadata.yaml").unlink()
        (folder / kind / "made").rmdir()
    sign_mcap(folder / "mcap" / "dive.mcap")
    for kind in ("calibration", "stereo"):
        calibration(folder / kind / "c.yaml")
    (folder / "camera_info" / "c.yaml").write_text(CAMERA_INFO)
    (folder / "kalibr" / "c.yaml").write_text(KALIBR)
    for side, left in zip("lr", (60, 60 + DISPARITY), strict=True):
        view = data.gravel()[50:50 + SIZE[1], left:left + SIZE[0]]
        write_picture(folder / "stereo" / f"{side}.png", np.ascontiguousarray(view, np.uint8))
    rows = "".join(f"{k},{500000 + 0.02 * k},{6090000 - 0.015 * k}\n" for k in range(FRAMES))
    for kind in ("navigation", "truth"):
        (folder / kind / "n.csv").write_text(f"frame,east_m,north_m\n{rows}")
    rows = "".join(f"{k / 10};{-35.31 - 1e-7 * k:.9f};{149.05 + 2e-7 * k:.9f}\n" for k in range(FRAMES))
    (folder / "fixes" / "n.csv").write_text(f"time_s;latitude;longitude\n{rows}")
    write_picture(folder / "chart" / "mosaic.png", np.asarray(data.gravel()[40:280, 40:320], np.uint8))
    (folder / "chart" / "places.csv").write_text("name,x_px,y_px\nrock,120.5,100\nweed,60,60\n")


def calibration(path: Path, **changed: Any) -> Path:
    """Write a camera and a stereo pair in OpenCV's YAML; entries given by name replace the good ones, None leaves one
    out."""
    matrix = np.array([[160.0, 0, 79.5], [0, 160.0, 59.5], [0, 0, 1]])
    lens = np.array([[0.05, 0.01, 0, 0, 0]])
    values: dict[str, Any] = {
        "image_width": SIZE[0], "image_height": SIZE[1], "camera_matrix": matrix, "distortion_coefficients": lens,
        "K1": matrix, "D1": lens, "K2": matrix, "D2": lens, "R": np.eye(3), "T": np.array([[-0.1], [0.0], [0.0]])}
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for name, value in (values | changed).items():
        if value is not None:
            storage.write(name, value)
    storage.release()
    return path


def _bag(path: Path, pictures: list[Image], plugin: StoragePlugin = StoragePlugin.SQLITE3, jpeg: bool = False) -> None:
    """A ROS 1 bag, if the path ends in .bag, or the folder of a ROS 2 bag."""
    ros1 = path.suffix == ".bag"
    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    kind = f"sensor_msgs/msg/{'CompressedImage' if jpeg else 'Image'}"
    writer: Any = Writer1(path) if ros1 else Writer2(path, version=9, storage_plugin=plugin)
    with writer:
        connection = writer.add_connection("/camera", kind, typestore=store)
        for k, picture in enumerate(pictures):
            time = store.types["builtin_interfaces/msg/Time"](k, 0)
            header = store.types["std_msgs/msg/Header"](**({"seq": k} if ros1 else {}), stamp=time, frame_id="camera")
            height, width = picture.shape
            message = store.types[kind](header, "jpeg", np.asarray(cv2.imencode(".jpg", picture)[1], np.uint8).ravel()
                                        ) if jpeg else store.types[kind](header, height, width, "mono8", 0, width,
                                                                         picture.ravel())
            serialize = store.serialize_ros1 if ros1 else store.serialize_cdr
            writer.write(connection, 10**9 * k, serialize(message, kind))


def sign_mcap(path: Path) -> None:
    """Write the checksums of chunks, data section and summary into an MCAP file that carries none, as most recorders
    do."""
    raw = bytearray(path.read_bytes())
    at = 8
    while True:
        opcode, length = struct.unpack_from("<BQ", raw, at)
        if opcode == 0x06:  # chunk: its records are not compressed
            named, = struct.unpack_from("<I", raw, at + 9 + 28)
            struct.pack_into("<I", raw, at + 9 + 24, zlib.crc32(raw[at + 9 + 32 + named + 8:at + 9 + length]))
        if opcode == 0x0F:  # end of the data
            struct.pack_into("<I", raw, at + 9, zlib.crc32(raw[:at]))
            break
        at += 9 + length
    footer = len(raw) - 8 - 29
    summary, = struct.unpack_from("<Q", raw, footer + 9)
    struct.pack_into("<I", raw, footer + 25, zlib.crc32(raw[summary:footer + 25]))
    path.write_bytes(bytes(raw))
