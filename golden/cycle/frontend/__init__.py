# SPDX-License-Identifier: Apache-2.0
"""Cycle models from the video input to packed sign bits: video in, LoG and its parts, packer."""
