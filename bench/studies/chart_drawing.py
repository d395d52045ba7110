"""Bars as SVG, in the colours of the program's pages (web/src/page.css, look.js), for a light and a dark ground."""
from html import escape

HUES = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00")
STYLE = """<style>
.ground { fill: #ffffff } .ink { fill: #16202b } .soft { fill: #4a5765 } .line { stroke: #d5dce3 } .mark { stroke: #4a5765 }
.end { fill: #4a5765; stroke: #ffffff; stroke-width: 3; paint-order: stroke }
@media (prefers-color-scheme: dark) {
  .ground { fill: #12171d } .ink { fill: #e8edf2 } .soft { fill: #a9b6c3 } .line { stroke: #36424e } .mark { stroke: #a9b6c3 }
  .end { fill: #a9b6c3; stroke: #12171d }
}
</style>"""
CHARACTER, BAR, GAP, WIDTH, MARGIN = 7.1, 13, 8, 780, 14


def text(x, y, what, kind="ink", anchor="start", weight="normal"):
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-weight="{weight}">{escape(what)}</text>'


def width_of(what):
    return CHARACTER * len(what)


def short(value):
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value + 0:.3g}".replace("-0", "0") if abs(value) < 0.05 else f"{value:.3g}"


def draw(title, head_of_rows, panels, rows, mark, stacked):
    """`panels` are titles with names of series, `rows` labels with the values of all panels in turn; `mark` is a line."""
    left = MARGIN + max(width_of(label) for label in [head_of_rows, *(label for label, _ in rows)]) + 10
    names = list(dict.fromkeys(name for _, series in panels for name in series if name))
    wide = (WIDTH - left - MARGIN) / len(panels)
    out, y = [], MARGIN + 14
    out.append(text(MARGIN, y, title, weight="bold"))
    if names:
        y += 22
        x = MARGIN
        for i, name in enumerate(names):
            if x + width_of(name) + 18 > WIDTH - MARGIN:
                x, y = MARGIN, y + 18
            out.append(f'<rect x="{x:.1f}" y="{y - 9:.1f}" width="11" height="11" fill="{HUES[i]}"/>' + text(x + 16, y, name, "soft"))
            x += width_of(name) + 32
    y += 26
    top = y + 10
    height = GAP + (BAR if stacked else max(len(series) for _, series in panels) * BAR)
    first = 0
    for index, (head, series) in enumerate(panels):
        columns = range(first, first + len(series))
        first += len(series)
        values = [[row[1][i] for i in columns] for row in rows]
        lengths = [sum(v or 0 for v in row) for row in values] if stacked else [v for row in values for v in row if v is not None]
        high, low = max([0, *lengths, *([mark] if mark else [])]), min([0, *lengths])
        ends = [" + ".join(short(v) for v in row if v) if stacked else max((short(v) for v in row if v is not None), key=len, default="")
                for row in values]
        room = max(width_of(end) for end in ends) + 16
        before = room if low < 0 else 0   # for a number on the left of a bar
        x0 = left + index * wide
        scale = (wide - room - 6 - before) / (high - low or 1)
        zero = x0 + before - low * scale
        out.append(text(x0, y, head, "soft"))
        out.append(f'<line class="line" x1="{zero:.1f}" y1="{top - 4:.1f}" x2="{zero:.1f}" y2="{top + height * len(rows) - GAP + 4:.1f}"/>')
        if mark:   # below the numbers, whose ground hides it
            x = zero + mark * scale
            out.append(f'<line class="mark" x1="{x:.1f}" y1="{top - 4:.1f}" x2="{x:.1f}" y2="{top + height * len(rows) - GAP + 4:.1f}" '
                       'stroke-dasharray="3 3"/>')
        for number, row in enumerate(values):
            at, x = top + number * height, zero
            for i, value in enumerate(row):
                hue = HUES[names.index(series[i]) if series[i] else 0]
                if value is None:
                    continue
                begin = x if stacked else zero + min(0, value) * scale
                out.append(f'<rect x="{begin:.1f}" y="{at:.1f}" width="{abs(value) * scale:.1f}" height="{BAR - 1}" fill="{hue}"/>')
                if stacked:
                    x += value * scale
                elif value < 0:
                    out.append(text(begin - 4, at + 10.5, short(value), "end", "end"))
                else:
                    out.append(text(begin + value * scale + 4, at + 10.5, short(value), "end"))
                at += 0 if stacked else BAR
            if stacked:
                out.append(text(x + 5, at + 10.5, ends[number], "end"))
    out.append(text(left - 10, y, head_of_rows, "soft", "end"))
    for number, (label, _) in enumerate(rows):
        out.append(text(left - 10, top + number * height + (height - GAP) / 2 + 4, label, anchor="end"))
    tall = top + height * len(rows) + MARGIN - GAP
    head = (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {tall:.0f}" width="{WIDTH}" height="{tall:.0f}" '
            'font-family="sans-serif" font-size="12">')
    return "\n".join([head, f"<title>{escape(title)}</title>", STYLE, '<rect class="ground" width="100%" height="100%"/>', *out, "</svg>"]) + "\n"
