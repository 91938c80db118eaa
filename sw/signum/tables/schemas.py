# SPDX-License-Identifier: Apache-2.0
"""The columns of every table, and what they mean.

`frame` is the frame's name as its source gives it. A column that ends in _px is in original pixels unless its table
states otherwise, in _m in metres, in _deg in degrees, in _s in seconds. `time_s` is the frame's time on its source's
own clock (see `Frame`), empty where the source has no times. A score is a matching fraction (0..1, chance
0.5), a margin its difference from the second-best match. Flags are 0 or 1.
"""

from __future__ import annotations

TRACK = "frame", "time_s", "feature", "x_px", "y_px", "dx_px", "dy_px", "score", "margin", "valid"
"""`track.csv`: a feature is at (x, y), which is (dx, dy) from where it was first seen."""
DRIFT = "frame", "time_s", "valid", "direct", "links", "error_px"
"""`drift.csv`: number of valid features of a frame; how many of them rest on one measurement against their initial
image; the longest chain of measurements behind one; and the distance that 98 % of such positions are within by the
tracker's estimate, for the worst of them. The last two are empty if no feature is valid."""
FLOW = "frame_a", "frame_b", "time_s", "step_s", "x_px", "y_px", "dx_px", "dy_px", "score", "valid"
"""`flow.csv`: displacement (dx, dy) in frame b of the window at (x, y) of frame a, empty where not valid. The
time is frame b's, the step that from frame a to it."""
MOVING = ("frame_a", "frame_b", "time_s", "step_s", "object", "x_px", "y_px", "left_px", "top_px", "width_px",
          "height_px", "area_px", "dx_px", "dy_px", "own_dx_px", "own_dy_px", "score", "margin", "confidence")
"""`moving.csv`: what moves by itself in frame a, one row an object: its number, the largest is 1; centroid and box;
area, original pixels; displacement of the centroid in frame b, and the same less the background's there; score of its
windows by its motion, and by how much it exceeds that by the background's; confidence, 0..100, the percentage of its
windows whose own search found its motion. A pair of frames without such an object has no row."""
DISPARITY = "frame", "time_s", "x_px", "y_px", "disparity_px", "range_m", "score", "margin", "valid"
"""`disparity.csv`: disparity and range at (x, y) of the rectified left frame; empty where not valid or not known."""
HOLD = ("frame", "time_s", "x_m", "y_m", "rot_deg", "scale", "range_m", "confidence", "agreed", "tried", "error_m",
        "reference")
"""`hold.csv`: seconds after the first frame; x ahead and y to the right of the station, rotation clockwise seen from
above, scale and range of the paper's equations 6 and 7, empty where confidence is 0; confidence, 0..100, the share of
the windows that agree in percent, less where their median score is below 0.75; windows that agree, and that were
tried; standard error of x and of y, with all that adds up over changes of the reference, without that of the assumed
range; number of changes of the reference, or of its range, so far. The last two are empty where confidence is 0."""
HOLD_TRUTH = "true_x_m", "true_y_m", "true_rot_deg", "true_range_m"
"""`hold.csv` of a simulated hold: the truth, after the columns of HOLD."""
FOLLOW = "frame", "time_s", "state", "x_px", "y_px", "width_px", "height_px", "windows", "range_m"
"""`follow.csv`: seconds after the first frame; the place of the fish, empty when it is lost; extent of its blob, number
of the blob's windows, and its range, empty where not measured."""
FOLLOW_TRUTH = "true_x_px", "true_y_px", "true_range_m", "pan_deg", "tilt_deg"
"""`follow.csv` of a simulated chase: the truth, after the columns of FOLLOW."""
NAVIGATE = "frame", "time_s", "x_px", "y_px", "rot_deg", "scale", "score", "confidence"
"""`navigate.csv`: the frame's centre, rotation and scale in mosaic.png, in pixels of mosaic.png; empty, with confidence
0, where the frame was not found."""
GOTO = "frame", "time_s", "right_px", "down_px", "sharp"
"""`goto.csv`: displacement of the target from the middle of the frame, empty where not known; whether it was measured
at the target itself."""
PLACES = "name", "x_px", "y_px"
"""`places.csv`, an optional table beside a mosaic: named places, in pixels of mosaic.png."""
EDGES = "frame_a", "frame_b", "dx_px", "dy_px", "score", "margin", "accepted"
"""`edges.csv`: displacement of a's centre in b from b's centre."""
POSES = "frame", "time_s", "x_px", "y_px", "rot_deg", "scale"
"""`poses.csv`: the frame's time when it was taken in, its centre, rotation and scale in the mosaic plane, the pixel
plane of the first frame."""
SURVEY_EDGES = (*EDGES, "kind", "rot_deg", "scale", "middle_x_px", "middle_y_px", "spread_px", "rms_px", "agreed",
                "tried", "reason")
"""Columns of a survey's `edges.csv`: those of `EDGES`, the kind of edge, rotation and scale from a to b, centroid (in
a), spread and residual of the windows that agree, original pixels, their number, the number tried, and the reason of a
refusal."""
ACCURACY = "method", "error", "unit", "rmse", "mean", "median", "std", "min", "max", "pairs"
"""`accuracy.csv`: statistics of a mosaic's errors, over frames (APE) or pairs of consecutive frames (RPE)."""
GROUND = "component", "pixel_m", "turn_deg", "east_m", "north_m", "epsg"
"""`ground.csv`: how the mosaic plane of `poses.csv` (component 1), `poses-2.csv`, ... lies on the ground, where that is
known: metres that its pixel covers, angle by which it is turned clockwise to be north up, place of its pixel (0, 0),
and the EPSG code of these coordinates; 0 where it is not known, as for metres from the first frame."""
SCENE_TRUTH = "north_m", "east_m", "altitude_m", "roll_deg", "pitch_deg", "heading_deg"
"""`truth.csv` of a simulated scene, after frame and time_s: pose of the camera; altitude is the median depth of what it
sees."""
VIEWS = "frame", "camera", "used", "corners", "rms_px", "range_m", "tilt_deg"
"""`views.csv` of a calibration: a view of the board by the left (or only) or right camera; whether the camera was
computed from it; its corners and their distance from the computed ones; distance of the board's corner from the camera,
and angle of the board to the picture's plane."""
CORNERS = "frame", "camera", "used", "x_px", "y_px", "dx_px", "dy_px"
"""`corners.csv` of a calibration: a corner of the board is at (x, y), which is (dx, dy) from the computed place."""
BARS = "section", "figure", "measured", "relation", "bound", "met"
"""`bars.csv` of the reproduction: each measured figure, the bound it is held to, and whether it meets it."""
