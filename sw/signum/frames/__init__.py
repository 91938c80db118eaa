# SPDX-License-Identifier: Apache-2.0
"""Frames: what a source offers, and how a frame is scaled for the board."""
