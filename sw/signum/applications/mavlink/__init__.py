# SPDX-License-Identifier: Apache-2.0
"""Measurements as MAVLink messages to an autopilot, and what the autopilot tells of its vehicle."""
