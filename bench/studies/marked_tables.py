"""Tables in documents: the text between `<!-- NAME -->` and `<!-- end -->`, in docs/."""
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]


def markdown(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]) + "\n"


def place(name):
    """The one document with the markers of this name, and what finds the text between them."""
    pattern = re.compile(f"(<!-- {name} -->\n)(.*?)(<!-- end -->)", re.S)
    pages = [page for page in sorted(ROOT.glob("docs/**/*.md")) if pattern.search(page.read_text())]
    assert len(pages) == 1, f"{name}: expected one document with its markers, found {len(pages)}"
    return pages[0], pattern


def replace(name, table):
    """Writes the table between its markers."""
    page, pattern = place(name)
    page.write_text(pattern.sub(lambda m: m[1] + table + m[3], page.read_text()))


def read(name):
    """The head and the rows of the table between its markers."""
    page, pattern = place(name)
    lines = pattern.search(page.read_text())[2].splitlines()
    head, _, *rows = [[cell.strip() for cell in line.strip("|").split(" |")] for line in lines]
    return head, rows
