"""The demonstration's report: one HTML file with everything in it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from signum.applications.hold.station import Moment
from signum.demo.flight import DT, FLOW_FRAMES, IMAGES, Flight
from signum.measure.flow import draw_flow
from signum.report.draw import draw_tracks, stages
from signum.report.page import Section, figure, plot, row, table, write_page

CLOCK_MHZ = 150, 205
"""Clocks of a real board for which times are given: the first aim and the next."""


def write_report(flight: Flight, out: Path) -> Path:
    """Write `report.html` into `out`; returns its path."""
    sections = [_filter(flight), _flow(flight), _mosaic(flight), _station(flight), _cost(flight)]
    return write_page(out / "report.html", "Signum: a simulated flight over gravel", sections, _summary(flight))


def _summary(f: Flight) -> str:
    board = "the Verilated RTL" if f.board == "verilated" else "the golden model"
    held = _rms_cm(f.held)
    rows = [
        ("signs equal in bad water, whole image / inner quarter", f"{f.agreement[0]:.3f} / {f.agreement[1]:.3f}"),
        ("flow error, RMS over valid windows", f"{_flow_rms(f):.3f} px"),
        ("track measurements valid, of features in view", f"{f.tracked[1]} of {f.tracked[0]}"),
        ("track error against the truth, RMS", f"{_rms(f.errors):.3f} px"),
        ("mosaic edges accepted", f"{f.edges[1]} of {f.edges[0]}"),
        ("mosaic error at the last image", f"{_mosaic_errors(f)[-1]:.2f} px"),
        ("station: distance from it, RMS after 4 s", f"{held:.1f} cm"),
        ("station: measurement error, RMS", f"{10 * _fix_error_cm(f.held):.2f} mm"),
    ]
    return (f"<p>Every sign bit and every score below came out of {board}; sigma {f.sigma:g} px, windows of "
            f"{f.window}x{f.window} px. The camera is simulated over a photograph, so the truth is known.</p>"
            + table(("measured", ""), rows))


def _filter(f: Flight) -> Section:
    assert f.stage is not None and f.snow is not None
    shown = [figure(p, name) for name, p in stages(f.stage[0], f.stage[1], f.sigma)]
    names = ("original", "its signs", "contrast / 4, uneven light, snow", "its signs")
    snow = [figure(p, name) for p, name in zip(f.snow, names, strict=True)]
    whole, inner = (100 * share for share in f.agreement)
    return Section("The filter", f"<p>Image, smoothed, Laplacian (mid grey is 0), sign: only the last leaves the board "
            f"(the paper's figure 3).</p>{row(shown)}<p>Signs survive what water does to a picture (figure 8): "
            f"{whole:.1f} % of all pixels keep theirs, {inner:.1f} % of the inner quarter, at sigma 1.5.</p>"
            f"{row(snow)}")


def _flow(f: Flight) -> Section:
    assert f.flow is not None and f.first is not None and f.last is not None
    before, after, field, true = f.flow
    flow = [figure(before, "time t"), figure(after, f"time t + {FLOW_FRAMES * DT:g} s"),
            figure(draw_flow(before, field), "flow, arrows twice as long")]
    dx, dy = field.dominant()
    tracks = [figure(draw_tracks(f.first, f.initial, f.window), "initial image"),
              figure(draw_tracks(f.last, f.points, f.window), "last image, red: out of view")]
    return Section("Flow and tracking", f"<p>Between two frames (figure 6): the scene moved by ({true[0]:.2f}, "
            f"{true[1]:.2f}) px; the median of {int(field.valid.sum())} valid windows says ({dx:.2f}, {dy:.2f}).</p>"
            f"{row(flow)}<p>Against the initial image (figure 7): nothing to drift. {f.tracked[1]} of {f.tracked[0]} "
            f"measurements of features in view valid, {_rms(f.errors):.3f} px RMS from the truth, at most "
            f"{float(np.abs(f.errors).max()) if f.errors.size else 0:.2f} px.</p>{row(tracks)}")


def _mosaic(f: Flight) -> Section:
    assert f.mosaic is not None
    errors = _mosaic_errors(f)
    fig, ax = plt.subplots(figsize=(5, 3))
    ax.plot(range(len(errors)), errors, "o-")
    ax.set_xticks(range(len(errors)))
    ax.set(xlabel="image", ylabel="error, px", ylim=(0, None), title="placed against true position")
    return Section("Single-column mosaic", f"<p>The section at the top centre of the stored image is followed in the "
            f"live image and servoed to the bottom centre; then the live image is stored (figure 14). {IMAGES} images, "
            f"{f.edges[1]} of {f.edges[0]} edges accepted.</p><div class='row'><div class='tall'>"
            f"{figure(f.mosaic, 'the mosaic')}</div>{plot(fig, 'error grows with the chain, slowly')}</div>")


def _station(f: Flight) -> Section:
    fig, axes = plt.subplots(2, 1, figsize=(9, 5), sharex=True)
    for axis, (ax, name) in enumerate(zip(axes, ("ahead", "right"), strict=True)):
        for moments, label, style in ((f.free, "drifting free", "--"), (f.held, "held, truth", "-")):
            ax.plot([m.time for m in moments], [100 * m.true[axis] for m in moments], style, label=label)
        good = [m for m in f.held if m.fix.confidence]
        ax.plot([m.time for m in good], [100 * (m.fix.x, m.fix.y)[axis] for m in good], "k.", ms=3, label="measured")
        most = max(2.0, 130 * max(abs(m.true[axis]) for m in f.held))
        ax.set(ylabel=f"{name}, cm", ylim=(-3 * most, 3 * most))
    axes[0].legend(loc="upper right")
    axes[1].set_xlabel("s")
    lost = sum(not m.fix.confidence for m in f.held)
    return Section("Station keeping", f"<p>Current, surge and gusts push the vehicle; every frame is measured against "
            f"the picture it had at the start (equations 2 to 5). {_rms_cm(f.held):.1f} cm RMS from the station after "
            f"the first 4 s, where the free vehicle was {100 * float(np.hypot(*f.free[-1].true)):.0f} cm away after "
            f"{f.free[-1].time:.0f} s. {lost} of {len(f.held)} frames without a fix.</p>"
            f"<div class='row'>{plot(fig, 'distance from the station')}</div>")


def _cost(f: Flight) -> Section:
    counted = "counted" if f.board == "verilated" else "estimated"
    rows = []
    for p in f.phases:
        per = p.clocks / max(p.frames, 1)
        rows.append((p.name, str(p.frames), f"{p.clocks / 1e6:.2f} M",
                     *(f"{per / mhz / 1e3:.2f} ms" for mhz in CLOCK_MHZ), f"{p.seconds:.1f} s"))
    clocks, seconds = sum(p.clocks for p in f.phases), sum(p.seconds for p in f.phases)
    heads = ("", "frames", f"clocks ({counted})", *(f"a frame at {mhz} MHz" for mhz in CLOCK_MHZ), "this run took")
    rows.append(("all", str(sum(p.frames for p in f.phases)), f"{clocks / 1e6:.2f} M",
                 *("" for _ in CLOCK_MHZ), f"{seconds:.1f} s"))
    return Section("What it cost", f"<p>A real board does in milliseconds what this run took seconds for: a frame's "
            f"filter and all its correlations.</p>{table(heads, rows)}")


def _mosaic_errors(f: Flight) -> list[float]:
    return [float(np.hypot(a[0] - b[0], a[1] - b[1])) for a, b in f.poses]


def _rms(errors: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> float:
    """RMS of (x, y) errors along one axis."""
    return float(np.sqrt(np.mean(errors**2))) if errors.size else 0.0


def _flow_rms(f: Flight) -> float:
    assert f.flow is not None
    field, true = f.flow[2], f.flow[3]
    return _rms(np.stack([field.dx - true[0], field.dy - true[1]])[:, field.valid])


def _rms_cm(moments: Sequence[Moment]) -> float:
    """RMS distance from the station after 4 s, cm."""
    late = [m.true for m in moments if m.time >= 4.0]
    return 100 * float(np.sqrt(np.mean(np.sum(np.square(late), axis=1))))


def _fix_error_cm(moments: Sequence[Moment]) -> float:
    """RMS error of the fixes along one axis, cm."""
    return 100 * _rms(np.array([(m.fix.x - m.true[0], m.fix.y - m.true[1]) for m in moments if m.fix.confidence]))
