# SPDX-License-Identifier: Apache-2.0
"""The demonstration's report: one HTML file that contains its pictures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from signum.applications.hold.judge import Moment
from signum.common.arrays import Floats
from signum.demo.flight import COLUMN_IMAGES, DT, FLOW_FRAMES, DemoFlight
from signum.demo.overview import draw_held, draw_paths
from signum.report.draw import draw_flow, draw_tracks, stages
from signum.report.page import Section, figure, plot, row, table, write_page

CLOCK_MHZ = 150
"""Clock frequency of a real board for which times are given, MHz."""
SETTLED_S = 4.0
"""Time after which the station's error is judged, seconds."""


def write_demo_report(flight: DemoFlight, out: Path) -> Path:
    """Write `report.html` into `out`; returns its path."""
    sections = [_filter(flight), _flow(flight), _mosaic(flight), _station(flight), _cost(flight)]
    return write_page(out / "report.html", "Signum: a simulated flight over gravel", sections, _summary(flight))


def _summary(f: DemoFlight) -> str:
    board = "the Verilated RTL" if f.board == "verilated" else "the golden model"
    held = _rms_cm(f.held)
    rows = [
        ("signs equal in bad water, whole image / inner quarter", f"{f.agreement[0]:.3f} / {f.agreement[1]:.3f}"),
        ("flow error, RMS over valid windows", f"{_rms(f.flow_errors):.3f} px"),
        ("track measurements valid, of features in view", f"{f.tracked[1]} of {f.tracked[0]}"),
        ("track error against the truth, RMS", f"{_rms(f.errors):.3f} px"),
        ("mosaic edges accepted", f"{f.edges[1]} of {f.edges[0]}"),
        ("mosaic error at the last image", f"{_mosaic_errors(f)[-1]:.2f} px"),
        (f"station: distance from it, RMS after {SETTLED_S:g} s", f"{held:.1f} cm"),
        ("station: measurement error, RMS", f"{1000 * _reading_error_m(f.held):.2f} mm"),
    ]
    return (f"<p>Every sign bit and every score below came out of {board}; sigma {f.sigma:g} px, windows of "
            f"{f.window}x{f.window} px. The camera and the vehicle are simulated, so the truth is known.</p>"
            + table(("measured", ""), rows))


def _filter(f: DemoFlight) -> Section:
    assert f.stage is not None and f.snow is not None
    shown = [figure(p, name) for name, p in stages(f.stage[0], f.stage[1], f.sigma)]
    names = ("original", "its signs", "contrast / 4, uneven light, snow", "its signs")
    snow = [figure(p, name) for p, name in zip(f.snow, names, strict=True)]
    whole, inner = (100 * share for share in f.agreement)
    return Section("The filter", f"<p>Image, smoothed, Laplacian (mid grey is 0), sign: only the last leaves the board "
            f"(the paper's figure 3).</p>{row(shown)}<p>Most signs are unchanged in turbid water (figure 8): "
            f"{whole:.1f} % of all pixels, {inner:.1f} % of the inner quarter, at sigma 1.5.</p>"
            f"{row(snow)}")


def _flow(f: DemoFlight) -> Section:
    assert f.flow is not None and f.first is not None and f.last is not None
    before, after, field, true = f.flow
    flow = [figure(before, "time t"), figure(after, f"time t + {FLOW_FRAMES * DT:g} s"),
            figure(draw_flow(before, field), "flow, arrows twice as long")]
    dx, dy = field.dominant()
    tracks = [figure(draw_tracks(f.first, f.initial, f.window), "initial image"),
              figure(draw_tracks(f.last, f.points, f.window), "last image, red: out of view")]
    return Section("Flow and tracking", f"<p>Between two frames (figure 6): the scene moved by ({true[0]:.2f}, "
            f"{true[1]:.2f}) px; the median of {int(field.valid.sum())} valid windows is ({dx:.2f}, {dy:.2f}).</p>"
            f"{row(flow)}<p>Against the initial image (figure 7), so that errors do not accumulate: {f.tracked[1]} of "
            f"{f.tracked[0]} measurements of features in view valid, {_rms(f.errors):.3f} px RMS from the truth, at "
            f"most {float(np.abs(f.errors).max()) if f.errors.size else 0:.2f} px.</p>{row(tracks)}")


def _mosaic(f: DemoFlight) -> Section:
    assert f.mosaic is not None
    errors = _mosaic_errors(f)
    fig, ax = plt.subplots(figsize=(5, 3))
    ax.plot(range(len(errors)), errors, "o-")
    ax.set_xticks(range(len(errors)))
    ax.set(xlabel="image", ylabel="error, px", ylim=(0, None), title="placed against true position")
    return Section("Single-column mosaic", f"<p>The section at the top centre of the stored image is followed in the "
            f"live image and servoed to the bottom centre; then the live image is stored (figure 14). {COLUMN_IMAGES} "
            f"images, {f.edges[1]} of {f.edges[0]} edges accepted.</p><div class='row'><div class='tall'>"
            f"{figure(f.mosaic, 'the mosaic')}</div>{plot(fig, 'distance from the true position')}</div>")


def _station(f: DemoFlight) -> Section:
    fig, axes = plt.subplots(2, 1, figsize=(9, 5), sharex=True)
    for axis, (ax, name) in enumerate(zip(axes, ("ahead", "right"), strict=True)):
        for moments, label, style in ((f.free, "drifting free", "--"), (f.held, "held, truth", "-")):
            ax.plot([m.time for m in moments], [100 * m.truth[axis] for m in moments], style, label=label)
        good = [m for m in f.held if m.reading.valid]
        measured = [100 * (m.reading.forward, m.reading.right)[axis] for m in good]
        ax.plot([m.time for m in good], measured, "k.", ms=3, label="measured")
        most = max(2.0, 130 * max(abs(m.truth[axis]) for m in f.held))
        ax.set(ylabel=f"{name}, cm", ylim=(-3 * most, 3 * most))
    axes[0].legend(loc="upper right")
    axes[1].set_xlabel("s")
    lost = sum(not m.reading.valid for m in f.held)
    away = 100 * float(np.hypot(*f.free[-1].truth[:2]))
    shown = row([figure(draw_held(f), "the last frame, its features"), figure(draw_paths(f), "over ground")])
    return Section("Station keeping", "<p>A current of 0.2 m/s with surge pushes a vehicle of six degrees of freedom; "
            "every frame is measured against the first one (equations 2 to 7), the range once by stereo, roll and "
            f"pitch by an ideal sensor. {_rms_cm(f.held):.1f} cm RMS from the station after the first {SETTLED_S:g} s; "
            f"without control the vehicle was {away:.0f} cm away after {f.free[-1].time:.0f} s. {lost} of "
            f"{len(f.held)} frames without a reading.</p>{shown}"
            f"<div class='row'>{plot(fig, 'offset from the station')}</div>")


def _cost(f: DemoFlight) -> Section:
    counted = "counted" if f.board == "verilated" else "estimated"
    rows = []
    for p in f.phases:
        per = p.clocks / max(p.frames, 1)
        rows.append((p.name, str(p.frames), f"{p.clocks / 1e6:.2f} M",
                     f"{per / CLOCK_MHZ / 1e3:.2f} ms", f"{p.seconds:.1f} s"))
    clocks, seconds = sum(p.clocks for p in f.phases), sum(p.seconds for p in f.phases)
    heads = ("", "frames", f"clocks ({counted})", f"a frame at {CLOCK_MHZ} MHz", "this run took")
    rows.append(("all", str(sum(p.frames for p in f.phases)), f"{clocks / 1e6:.2f} M",
                 "", f"{seconds:.1f} s"))
    return Section("What it cost", "<p>The clocks are those of a frame's filter and all its correlations; a real board "
            f"needs milliseconds for them.</p>{table(heads, rows)}")


def _mosaic_errors(f: DemoFlight) -> list[float]:
    return [float(np.hypot(a[0] - b[0], a[1] - b[1])) for a, b in f.poses]


def _rms(errors: Floats) -> float:
    """RMS of (x, y) errors along one axis."""
    return float(np.sqrt(np.mean(errors**2))) if errors.size else 0.0


def _rms_cm(moments: Sequence[Moment]) -> float:
    """RMS distance from the station after SETTLED_S, cm."""
    late = [m.truth[:2] for m in moments if m.time >= SETTLED_S]
    return 100 * float(np.sqrt(np.mean(np.sum(np.square(late), axis=1))))


def _reading_error_m(moments: Sequence[Moment]) -> float:
    """RMS error of the readings along one axis, metres."""
    return _rms(np.array([(m.reading.forward - m.truth[0], m.reading.right - m.truth[1])
                          for m in moments if m.reading.valid]))
