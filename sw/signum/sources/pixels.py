# SPDX-License-Identifier: Apache-2.0
"""Raw pictures of messages, in any of the encodings of sensor_msgs/Image, as frames have them."""

from __future__ import annotations

import struct
from typing import Any

import cv2
import numpy as np

from signum.common.arrays import Image
from signum.common.checks import check_pixels
from signum.common.errors import SourceError
from signum.frames.eight import EightBits
from signum.frames.frame import decode_picture, plain

CHANNELS = {"mono": 1, "rgb": 3, "bgr": 3, "rgba": 4, "bgra": 4}
PLAIN: dict[str, tuple[str, int]] = {
    **{f"{name}{bits}": (f"u{bits // 8}", n) for name, n in CHANNELS.items() for bits in (8, 16)},
    **{f"{bits}{kind}C{n}": (f"{code}{bits // 8}", n) for kind, code, sizes in (
        ("U", "u", (8, 16)), ("S", "i", (8, 16, 32)), ("F", "f", (32, 64))) for bits in sizes for n in (1, 3, 4)},
    **{f"bayer_{order}{bits}": (f"u{bits // 8}", 1) for order in ("rggb", "bggr", "gbrg", "grbg") for bits in (8, 16)}}
"""Encodings with one number a channel: type and number of channels."""
PACKED = {"yuv422": cv2.COLOR_YUV2BGR_UYVY, "uyvy": cv2.COLOR_YUV2BGR_UYVY,
          "yuv422_yuy2": cv2.COLOR_YUV2BGR_YUY2, "yuyv": cv2.COLOR_YUV2BGR_YUY2}
"""Encodings of two bytes a pixel, colour at every second pixel."""
PLANAR = {"nv12": cv2.COLOR_YUV2BGR_NV12, "nv21": cv2.COLOR_YUV2BGR_NV21}
"""Encodings of a plane of grey and one of colour of half its height."""
# OpenCV names a Bayer pattern by its second row, ROS by its first.
BAYER = {"rggb": cv2.COLOR_BayerBG2BGR, "bggr": cv2.COLOR_BayerRG2BGR, "gbrg": cv2.COLOR_BayerGR2BGR,
         "grbg": cv2.COLOR_BayerGB2BGR}
DEPTH_HEADER = 12
"""Bytes of compressed_depth_image_transport before the picture: format, and two numbers of the quantisation."""


def raw_picture(message: Any, label: str, eight: EightBits) -> Image:
    """The picture of a sensor_msgs/Image, or of anything with its fields.

    Args:
        message: has encoding, width, height, step, data and is_bigendian.
        label: of the frame, for messages.
        eight: maps deeper pictures to 8 bits.

    Raises:
        SourceError: if its encoding is not known, or it has too few bytes.
    """
    encoding = str(message.encoding)
    height, width, step = int(message.height), int(message.width), int(message.step)
    check_pixels(width, height, label, SourceError)
    data = np.frombuffer(np.ascontiguousarray(message.data), np.uint8)
    if encoding in PLAIN:
        kind, channels = PLAIN[encoding]
        dtype = np.dtype(kind).newbyteorder(">" if message.is_bigendian else "<")
        rows, used = height, width * channels * dtype.itemsize
    elif encoding in PACKED:
        dtype, channels, rows, used = np.dtype(np.uint8), 2, height, 2 * width
    elif encoding in PLANAR:
        dtype, channels, rows, used = np.dtype(np.uint8), 1, height * 3 // 2, width
    else:
        known = ", ".join(sorted({*PLAIN, *PACKED, *PLANAR}))
        raise SourceError(f"{label}: encoding {encoding!r}; signum reads {known}: "
                          "convert the topic, e.g. with image_proc")
    step = step or used
    if step < used or data.size < rows * step or data.size > rows * step + step:
        raise SourceError(f"{label}: {data.size} bytes for {width}x{height} {encoding} pixels: the message is broken")
    cells = np.ascontiguousarray(data[:rows * step].reshape(rows, step)[:, :used])
    if encoding in PACKED or encoding in PLANAR:
        return _yuv(cells, encoding, width, height, label)
    picture = cells.view(dtype).reshape((rows, width) if channels == 1 else (rows, width, channels))
    picture = eight(np.asarray(picture, dtype.newbyteorder("=")), label)
    return _blue_green_red(picture, encoding)


def _yuv(cells: Image, encoding: str, width: int, height: int, label: str) -> Image:
    if width % 2 or (height % 2 and encoding in PLANAR):
        raise SourceError(f"{label}: {width}x{height} {encoding} pixels: expected even sides; the message is broken")
    if encoding in PLANAR:
        return np.asarray(cv2.cvtColor(cells, PLANAR[encoding]), np.uint8)
    return np.asarray(cv2.cvtColor(cells.reshape(height, width, 2), PACKED[encoding]), np.uint8)


def _blue_green_red(picture: Image, encoding: str) -> Image:
    if encoding.startswith("bayer_"):
        return np.asarray(cv2.cvtColor(picture, BAYER[encoding[6:10]]), np.uint8)
    if encoding.startswith("rgb"):
        return np.ascontiguousarray(picture[:, :, 2::-1])
    return plain(picture)


def compressed_picture(message: Any, label: str, eight: EightBits) -> Image:
    """The picture of a sensor_msgs/CompressedImage, depth of compressed_depth_image_transport included.

    Depth that was quantised from 32-bit floating point is shown as the inverse depth that the file holds.

    Args:
        message: has format and data.
        label: of the frame, for messages.
        eight: maps deeper pictures to 8 bits.

    Raises:
        SourceError: if it cannot be decoded.
    """
    data = np.ascontiguousarray(message.data).tobytes()
    kind = str(message.format)
    if "compressedDepth" in kind:
        if "rvl" in kind.lower():
            raise SourceError(f"{label}: {kind}: RVL is not read; record the depth as PNG, or the raw topic")
        if len(data) > DEPTH_HEADER and struct.unpack_from("<i", data)[0] in (0, 1):
            data = data[DEPTH_HEADER:]
    return plain(eight(decode_picture(data, label), label))
