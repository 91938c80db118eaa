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


HOLD = "frame", "time_s", "x_m", "y_m", "rot_deg", "zoom", "range_m", "confidence", "agreed", "tried"
"""Of `hold.csv`: x ahead and y to the right of the station, metres; rotation clockwise seen from above, degrees; zoom
and range of equations 6 and 7; confidence 0 to 100; features that agree and were tried. Empty at confidence 0."""


HOLD_TRUTH = "true_x_m", "true_y_m", "true_rot_deg", "true_range_m"
"""Further columns of a simulated hold: true offset from the station, heading and range."""


FOLLOW = "frame", "time_s", "state", "x_px", "y_px", "width_px", "height_px", "windows", "range_m"
"""Of `follow.csv`, original pixels: the fish's position, empty when lost; width, height and number of windows of its
blob, and its range, metres, empty where not measured."""


FOLLOW_TRUTH = "true_x_px", "true_y_px", "true_range_m", "pan_deg", "tilt_deg"
"""Further columns of a simulated chase: the fish's true pixel, empty out of view, and range; the pan/tilt's angles."""


CAMERA_TRUTH = "north_m", "east_m", "altitude_m", "roll_deg", "pitch_deg", "heading_deg"
"""Of `truth.csv`: the camera's true position and attitude; altitude is the median depth of what it sees."""


PLACES = "name", "x_px", "y_px"
"""Of `places.csv`, an optional table beside a mosaic: named places, pixels of mosaic.png."""


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
