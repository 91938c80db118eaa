# SPDX-License-Identifier: Apache-2.0
"""Mosaics of a survey: frames are registered with one another and placed by least squares over all edges."""
