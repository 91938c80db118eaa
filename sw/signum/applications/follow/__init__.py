# SPDX-License-Identifier: Apache-2.0
"""Object following: an object that is near, or moves against the terrain, is kept in the middle of the view."""
