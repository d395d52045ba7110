"""Tables in documents: the text between `<!-- NAME -->` and `<!-- end -->`, in docs/ or docs/data/."""
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]


def markdown(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]) + "\n"


def replace(name, table):
    """Writes the table into the one document with the markers of its name."""
    pattern = re.compile(f"(<!-- {name} -->\n).*?(<!-- end -->)", re.S)
    pages = [page for page in sorted(ROOT.glob("docs/**/*.md")) if pattern.search(page.read_text())]
    assert len(pages) == 1, f"{name}: expected one document with its markers, found {len(pages)}"
    pages[0].write_text(pattern.sub(lambda m: m[1] + table + m[2], pages[0].read_text()))
