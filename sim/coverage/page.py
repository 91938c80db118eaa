# SPDX-License-Identifier: Apache-2.0
"""The page of a coverage run: shares by module, points not hit, exclusions, functional coverage, outputs compared."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from html import escape

from sim.coverage.functional import Functional
from sim.coverage.points import KINDS, Point
from sim.coverage.verdict import BARS, Verdict

_STYLE = """body{font:15px/1.45 system-ui,sans-serif;margin:2em auto;max-width:70em;padding:0 1em;color:#1a2230}
table{border-collapse:collapse;margin:.6em 0}td,th{padding:.15em .8em;text-align:right;border-bottom:1px solid #dde3ea}
td:first-child,th:first-child{text-align:left}.low{color:#a40000;font-weight:600}code{font-size:.93em}
summary{cursor:pointer}pre{margin:.3em 0 .8em}"""


def page(hits: Mapping[Point, int], reasons: Mapping[Point, str], functional: Functional,
         plan: Mapping[tuple[str, str], str], verdict: Verdict) -> str:
    """The whole page as HTML."""
    parts = ["<!doctype html><html lang=en><meta charset=utf-8><title>Coverage</title>", f"<style>{_STYLE}</style>",
             "<h1>Coverage of the RTL</h1>", _bars(verdict), _faults(verdict.faults),
             "<h2>By module</h2>", _modules(hits, reasons),
             "<h2>Points not hit</h2>", _missing(verdict.missing),
             "<h2>Excluded points</h2>", _excluded(reasons),
             "<h2>Functional coverage</h2>", _functional(functional, plan),
             "<h2>Outputs compared</h2>",
             "<p>Clocks in which each output was compared with the cycle model, and in which the model leaves it "
             "undefined.</p>", _compared(functional)]
    return "\n".join(parts) + "\n"


def _table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    cells = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><tr>{''.join(f'<th>{name}</th>' for name in head)}</tr>{cells}</table>"


def _share(hit: int, total: int, bar: float = 100.0) -> str:
    share = 100.0 * hit / total if total else 100.0
    return f"<span class={'low' if share < bar else 'ok'}>{share:.2f} %</span>"


def _bars(verdict: Verdict) -> str:
    rows = [(kind, verdict.hit[kind], verdict.total[kind], _share(verdict.hit[kind], verdict.total[kind], bar),
             f"{bar:g} %", verdict.excluded[kind]) for kind, bar in BARS.items()]
    return _table(("kind", "hit", "points", "share", "bar", "excluded"), rows)


def _faults(faults: Sequence[str]) -> str:
    if not faults:
        return "<p>Every bar is reached.</p>"
    return "<ul>" + "".join(f"<li class=low>{escape(fault)}</li>" for fault in faults) + "</ul>"


def _modules(hits: Mapping[Point, int], reasons: Mapping[Point, str]) -> str:
    """Shares of each source; generated ones too, which have no bars."""
    total: Counter[tuple[str, str]] = Counter()
    hit: Counter[tuple[str, str]] = Counter()
    generated = {}
    for point, count in hits.items():
        name = point.file.stem
        generated[name] = point.generated
        if point not in reasons:
            total[name, point.kind] += 1
            hit[name, point.kind] += bool(count)
    rows = [(f"<code>{name}</code>" + " (generated)" * generated[name],
             *(f"{_share(hit[name, kind], total[name, kind])} of {total[name, kind]}" for kind in KINDS))
            for name in sorted(generated)]
    return _table(("module", *KINDS), rows)


def _missing(points: Sequence[Point]) -> str:
    """The points not hit, one line a name."""
    by_module: dict[str, list[Point]] = defaultdict(list)
    for point in points:
        by_module[point.file.stem].append(point)
    return "".join(
        f"<details open><summary><code>{name}</code>: {len(found)}</summary><pre>"
        + escape("\n".join(f"{p.line:5} {p.kind:7} {p.name}" for p in sorted(found))) + "</pre></details>"
        for name, found in sorted(by_module.items())) or "<p>None.</p>"


def _excluded(reasons: Mapping[Point, str]) -> str:
    by_reason: dict[tuple[str, str, str], list[Point]] = defaultdict(list)
    for point, reason in reasons.items():
        by_reason[point.file.stem, point.kind, reason].append(point)
    return "".join(
        f"<details><summary><code>{module}</code>, {kind}: {len(found)}. {escape(reason)}</summary><pre>"
        + escape("\n".join(p.name for p in sorted(found))) + "</pre></details>"
        for (module, kind, reason), found in sorted(by_reason.items())) or "<p>None.</p>"


def _functional(functional: Functional, plan: Mapping[tuple[str, str], str]) -> str:
    groups: dict[str, list[tuple[str, str, str]]] = defaultdict(list)
    for (group, what), reason in plan.items():
        count = functional.counts[group, what]
        seen = f"cannot: {escape(reason)}" if reason else str(count) if count else "<span class=low>never</span>"
        groups[group].append((escape(what), seen, ""))
    return "".join(
        f"<details><summary>{escape(group)}: {sum('never' in seen for _, seen, _ in rows)} of {len(rows)} missing"
        f"</summary>{_table(('what', 'times'), [row[:2] for row in rows])}</details>"
        for group, rows in sorted(groups.items()))


def _compared(functional: Functional) -> str:
    rows = [(f"<code>{module}.{output}</code>", functional.clocks[module] - undefined, undefined)
            for (module, output), undefined in sorted(functional.undefined.items())]
    return _table(("output", "clocks compared", "clocks undefined"), rows)
