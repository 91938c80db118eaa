# SPDX-License-Identifier: Apache-2.0
"""Where the camera was, frame by frame, in the formats of other programs."""
