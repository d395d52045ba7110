"""Maps of ratios over two axes as SVG: blue cells are above one, orange ones below, each with its number."""
from chart_drawing import STYLE, text as lettered


def colour(ratio):
    """White at 1; the strongest colour from a factor of 2 on."""
    share = min(abs(ratio - 1 if ratio > 1 else 1 / ratio - 1), 1.0)
    full = (0, 114, 178) if ratio > 1 else (230, 159, 0)
    return "#" + "".join(f"{round(255 - share * (255 - part)):02x}" for part in full)


PANELS = 4  # in a line


def heat_table(title, row_name, rows, column_name, columns, panels):
    """`panels` is a list of names, in two lines parted by ": ", each with the ratio of each row and column."""
    cell, left, top, gap = 64, 84, 74, 44
    down = len(rows) * 40 + 92  # from a line of panels to the next
    width = left + min(PANELS, len(panels)) * (len(columns) * cell + gap)
    height = top + -(-len(panels) // PANELS) * down - 46
    out = [f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {width} {height}' width='{width}' height='{height}' "
           "font-family='sans-serif' font-size='12'>", f"<title>{title}</title>", STYLE, "<rect class='ground' width='100%' height='100%'/>",
           lettered(8, 20, title, weight="bold")]
    for index, (name, at) in enumerate(panels):
        x0, y0 = left + index % PANELS * (len(columns) * cell + gap), top + index // PANELS * down
        out += [lettered(x0, y0 - 26 + 16 * line, text, weight="bold") for line, text in enumerate(name.split(": "))]
        if index % PANELS == 0:
            out.append(lettered(8, y0 - 8, row_name, "soft"))
        for i, row in enumerate(rows):
            y = y0 + i * 40
            if index % PANELS == 0:
                out.append(lettered(left - 8, y + 25, f"{row:,}", anchor="end"))
            for j, column in enumerate(columns):
                ratio = at[row, column]
                out.append(f"<rect x='{x0 + j * cell}' y='{y}' width='{cell - 2}' height='38' fill='{colour(ratio)}' stroke='#9aa4b2'/>"
                           f"<text x='{x0 + j * cell + cell / 2 - 1}' y='{y + 24}' text-anchor='middle' fill='#16202b'>{ratio:.2f}</text>")
        for j, column in enumerate(columns):
            out.append(lettered(x0 + j * cell + cell / 2, y0 + len(rows) * 40 + 16, str(column), anchor="middle"))
        out.append(lettered(x0, y0 + len(rows) * 40 + 34, column_name, "soft"))
    return "\n".join(out + ["</svg>", ""])
