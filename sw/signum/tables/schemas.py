"""The columns of every table, with their units."""

from __future__ import annotations

TRACK = "frame", "feature", "x_px", "y_px", "dx_px", "dy_px", "score", "margin", "valid"
"""Of `track.csv`, original pixels: (x, y) is where the feature is, (dx, dy) how far from where it was first seen."""


DRIFT = "frame", "valid", "direct", "links", "error_px"
"""Of `drift.csv`: valid features of a frame, how many of them rest on one measurement against their initial image, the
longest chain of measurements behind one, and the distance in original pixels that 98 % of its positions are within by
the tracker's estimate, for the worst of them; the last two are empty where none is valid."""


FLOW = "frame_a", "frame_b", "x_px", "y_px", "dx_px", "dy_px", "score", "valid"
"""Of `flow.csv`, original pixels: the window at (x, y) of frame a lies (dx, dy) further on in frame b; empty where not
valid."""


DISPARITY = "frame", "x_px", "y_px", "disparity_px", "range_m", "score", "margin", "valid"
"""Of `disparity.csv`, original pixels of the rectified left picture; empty where not valid or not known."""


NAVIGATE = "frame", "x_px", "y_px", "rot_deg", "scale", "score", "confidence"
"""Of `navigate.csv`: the frame's centre, rotation and zoom in mosaic.png, its pixels; empty and confidence 0 where it
was not found."""


GOTO = "frame", "right_px", "down_px", "sharp"
"""Of `goto.csv`: the way from the middle of the frame to the target, original pixels, empty where not known; 1 where it
was measured about the target itself."""


EDGES = "frame_a", "frame_b", "dx_px", "dy_px", "score", "margin", "accepted"
"""Of `edges.csv`: where a's centre lands in b, minus b's centre, original pixels."""


POSES = "frame", "x_px", "y_px", "rot_deg", "scale"
"""Of `poses.csv`: the frame's centre in the mosaic plane, which is the pixel plane of the first frame."""
