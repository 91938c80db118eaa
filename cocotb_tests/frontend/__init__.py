# SPDX-License-Identifier: Apache-2.0
"""Tests of the front end and its parts, from video input to packer."""
