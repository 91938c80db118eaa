# SPDX-License-Identifier: Apache-2.0
"""Signum beside OpenCV's methods on the same frames, clear and as the paper's figure 8 has them; `make compare`."""
