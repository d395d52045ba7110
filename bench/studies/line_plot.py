"""Small line plots as SVG, for studies: one panel after another, values over a few named positions."""

COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#8c564b")
PANEL, HEIGHT, LEFT, TOP, BOTTOM = 300, 260, 56, 56, 44


def nice_step(span):
    """Of 1, 2, 5, 10 and so on the least that makes six steps at most of the span."""
    for exponent in range(-6, 12):
        for factor in (1, 2, 5):
            if span / (factor * 10.0 ** exponent) <= 6:
                return factor * 10.0 ** exponent


def panel(index, title, positions, lines, bounds):
    """`lines` has a list of values for each name; `bounds` are the least and greatest of the axis."""
    x0, lo, hi = index * PANEL + LEFT, *bounds
    x = lambda i: x0 + i * (PANEL - LEFT - 24) / (len(positions) - 1)
    y = lambda v: TOP + (hi - v) / (hi - lo) * (HEIGHT - TOP - BOTTOM)
    out = [f"<text x='{x0}' y='{TOP - 14}' font-weight='bold'>{title}</text>"]
    step = nice_step(hi - lo)
    tick = -(-lo // step) * step
    while tick <= hi + 1e-9:
        out.append(f"<line x1='{x0}' y1='{y(tick):.1f}' x2='{x(len(positions) - 1):.1f}' y2='{y(tick):.1f}' stroke='#ddd'/>"
                   f"<text x='{x0 - 6}' y='{y(tick) + 4:.1f}' text-anchor='end'>{tick:g}</text>")
        tick += step
    out += [f"<text x='{x(i):.1f}' y='{HEIGHT - BOTTOM + 18}' text-anchor='middle'>{p}</text>" for i, p in enumerate(positions)]
    for colour, values in zip(COLOURS, lines.values()):
        points = " ".join(f"{x(i):.1f},{y(v):.1f}" for i, v in enumerate(values))
        out.append(f"<polyline points='{points}' fill='none' stroke='{colour}' stroke-width='2'/>")
        out += [f"<circle cx='{x(i):.1f}' cy='{y(v):.1f}' r='3' fill='{colour}'/>" for i, v in enumerate(values)]
    return out


def plot(title, below, positions, panels):
    """An SVG of panels, each a title and lines by name: the same names in each, on one scale."""
    values = [v for _, lines in panels for line in lines.values() for v in line]
    bounds = (min(0.0, min(values)), 1.05 * max(values))
    names = list(panels[0][1])
    width, height = len(panels) * PANEL + 190, HEIGHT + 20
    out = [f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {width} {height}' width='{width}' height='{height}' "
           "font-family='sans-serif' font-size='11'>", "<rect width='100%' height='100%' fill='white'/>",
           f"<text x='{LEFT}' y='14' font-size='13'>{title}</text>",
           f"<text x='{LEFT}' y='{height - 8}'>{below}</text>"]
    for index, (name, lines) in enumerate(panels):
        out += panel(index, name, positions, lines, bounds)
    for index, (colour, name) in enumerate(zip(COLOURS, names)):
        at = TOP + 10 + 18 * index
        out.append(f"<line x1='{len(panels) * PANEL + 4}' y1='{at}' x2='{len(panels) * PANEL + 24}' y2='{at}' stroke='{colour}' "
                   f"stroke-width='2'/><text x='{len(panels) * PANEL + 30}' y='{at + 4}'>{name}</text>")
    return "\n".join(out + ["</svg>", ""])
