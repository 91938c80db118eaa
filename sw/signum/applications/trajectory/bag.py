# SPDX-License-Identifier: Apache-2.0
"""Trajectories as ROS 2 bags (MCAP), by rosbags.

| Topic | Message |
|---|---|
| `/odom` | `nav_msgs/Odometry`: pose of `base_link` in `odom` or `map`, mean twist since the frame before |
| `/tf` | the same as a transform |
| `/tf_static` | `base_link` to `camera_optical_frame`, of a camera that looks down |
| `/mosaic/pose` | `geometry_msgs/PoseStamped` in `map`, of a mosaic |
| `/camera_info` | `sensor_msgs/CameraInfo` of every frame, where a calibration is given |

Covariances are 0: not known, by the messages' convention.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from signum.applications.trajectory.path import Trajectory
from signum.common.arrays import Floats
from signum.common.errors import SignumError
from signum.geometry.lens import Lens

STORE = get_typestore(Stores.ROS2_HUMBLE)
BODY, CAMERA = "base_link", "camera_optical_frame"
DOWN = (2**-0.5, -(2**-0.5), 0.0, 0.0)
"""Quaternion x, y, z, w of a camera that looks down in its vehicle: its x is to the right, its y back, its z down."""
NANO = 10**9
LATCHED = Qos(QosHistory.KEEP_LAST, 1, QosReliability.RELIABLE, QosDurability.TRANSIENT_LOCAL, QosTime(0, 0),
              QosTime(0, 0), QosLiveliness.AUTOMATIC, QosTime(0, 0), False)
"""Of a static transform: whoever comes later gets it too."""


def write_bag(path: Path, trajectory: Trajectory, lens: Lens | None = None) -> None:
    """Write a bag.

    Args:
        path: folder of the bag, which must not exist.
        trajectory: see there for the axes.
        lens: of the camera, for CameraInfo; its matrix and distortion are those of the recorded pictures.

    Raises:
        SignumError: if its times are none that a message's stamp can be.
    """
    if not 0 <= trajectory.times[0] <= trajectory.times[-1] < 1 << 31:
        raise SignumError(f"{path}: times from {trajectory.times[0]:g} to {trajectory.times[-1]:g} s are no stamps of "
                          "ROS, which are 0 to 2147483647 s: leave --bag out")
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        topics = {"/odom": "nav_msgs/msg/Odometry", "/tf": "tf2_msgs/msg/TFMessage",
                  "/tf_static": "tf2_msgs/msg/TFMessage"}
        topics |= {"/mosaic/pose": "geometry_msgs/msg/PoseStamped"} if trajectory.world == "map" else {}
        topics |= {"/camera_info": "sensor_msgs/msg/CameraInfo"} if lens else {}
        links = {topic: writer.add_connection(topic, kind, typestore=STORE,
                                              offered_qos_profiles=[LATCHED] if topic == "/tf_static" else [])
                 for topic, kind in topics.items()}

        def write(topic: str, stamp: int, message: Any) -> None:
            writer.write(links[topic], stamp, STORE.serialize_cdr(message, topics[topic]))

        stamps = [round(float(t) * NANO) for t in trajectory.times]
        write("/tf_static", stamps[0], _tf(stamps[0], BODY, CAMERA, np.zeros(3), DOWN))
        for k, (stamp, place, yaw) in enumerate(zip(stamps, trajectory.positions, trajectory.yaws, strict=True)):
            turn = (0.0, 0.0, float(np.sin(yaw / 2)), float(np.cos(yaw / 2)))
            write("/odom", stamp, _odometry(trajectory, k, stamp, turn))
            write("/tf", stamp, _tf(stamp, trajectory.world, BODY, place, turn))
            if "/mosaic/pose" in links:
                write("/mosaic/pose", stamp, _of("geometry_msgs/msg/PoseStamped")(
                    _header(stamp, trajectory.world), _pose(place, turn)))
            if lens:
                write("/camera_info", stamp, _camera_info(lens, stamp))


Quaternion = tuple[float, float, float, float]


def _of(kind: str) -> Any:
    """The class of a message."""
    return STORE.types[kind]


def _header(stamp: int, frame: str) -> Any:
    return _of("std_msgs/msg/Header")(_of("builtin_interfaces/msg/Time")(stamp // NANO, stamp % NANO), frame)


def _vector(values: Floats) -> Any:
    return _of("geometry_msgs/msg/Vector3")(*map(float, values))


def _pose(place: Floats, turn: Quaternion) -> Any:
    return _of("geometry_msgs/msg/Pose")(_of("geometry_msgs/msg/Point")(*map(float, place)),
                                         _of("geometry_msgs/msg/Quaternion")(*turn))


def _tf(stamp: int, parent: str, child: str, place: Floats, turn: Quaternion) -> Any:
    transform = _of("geometry_msgs/msg/Transform")(_vector(place), _of("geometry_msgs/msg/Quaternion")(*turn))
    return _of("tf2_msgs/msg/TFMessage")(
        [_of("geometry_msgs/msg/TransformStamped")(_header(stamp, parent), child, transform)])


def _odometry(trajectory: Trajectory, k: int, stamp: int, turn: Quaternion) -> Any:
    """Pose of a frame, and the mean velocity since the one before in the vehicle's axes; 0 of the first."""
    speed, spin = np.zeros(3), np.zeros(3)
    step = float(trajectory.times[k] - trajectory.times[k - 1]) if k else 0.0
    if step > 0:
        x, y, z = (trajectory.positions[k] - trajectory.positions[k - 1]) / step
        c, s = np.cos(trajectory.yaws[k]), np.sin(trajectory.yaws[k])
        speed = np.array([c * x + s * y, c * y - s * x, z])
        spin[2] = np.angle(np.exp(1j * (trajectory.yaws[k] - trajectory.yaws[k - 1]))) / step
    unknown = np.zeros(36)
    return _of("nav_msgs/msg/Odometry")(
        _header(stamp, trajectory.world), BODY,
        _of("geometry_msgs/msg/PoseWithCovariance")(_pose(trajectory.positions[k], turn), unknown),
        _of("geometry_msgs/msg/TwistWithCovariance")(
            _of("geometry_msgs/msg/Twist")(_vector(speed), _vector(spin)), unknown))


def _camera_info(lens: Lens, stamp: int) -> Any:
    model = "equidistant" if lens.fisheye else "plumb_bob" if len(lens.distortion) <= 5 else "rational_polynomial"
    projection = np.hstack([lens.matrix, np.zeros((3, 1))])
    return _of("sensor_msgs/msg/CameraInfo")(
        _header(stamp, CAMERA), lens.size[1], lens.size[0], model, np.asarray(lens.distortion, np.float64),
        lens.matrix.ravel(), np.eye(3).ravel(), projection.ravel(), 0, 0,
        _of("sensor_msgs/msg/RegionOfInterest")(0, 0, 0, 0, False))
