# SPDX-License-Identifier: Apache-2.0
"""Sources of frames: files, ROS bags, cameras and the simulated world."""
