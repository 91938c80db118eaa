# SPDX-License-Identifier: Apache-2.0
"""`signum demo`: one simulated flight that shows the filter, flow, tracks, a mosaic and station keeping."""
