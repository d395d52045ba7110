"""What MkDocs needs beside its configuration: the pages are written for a code host, and the site works from a disk."""
import json
import os
import pathlib
import re

HERE = pathlib.Path(__file__).resolve().parent


def anchor(heading, separator="-"):
    """The anchor that code hosts give a heading: letters, digits and hyphens stay, each space becomes a hyphen."""
    heading = re.sub(r"<[^>]+>", "", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", heading).replace(" ", separator)


def terms(docs):
    """The glossary's words with their anchors, the longest first, so that `shape buffer` is not linked as `shape`."""
    found = re.findall(r'<a id="([^"]+)"></a>([^|]+?) \|', (docs / "glossary.md").read_text())
    return sorted(found, key=lambda row: -len(row[1]))


def with_terms(markdown, words, glossary):
    """Links each word at its first use in running text: not in headings, tables, code, links or quoted pictures."""
    parts = re.split(r"(^```[\s\S]*?^```$|^    .*$|^[#|>!<].*$|`[^`]*`|!?\[[^\]]*\]\([^)]*\)|<[^>]+>)", markdown, flags=re.M)
    for anchor_of, word in words:
        pattern = re.compile(rf"(?<![\w*-])({re.escape(word)}(?:e?s)?)(?![\w*-])")
        for i in range(0, len(parts), 2):
            linked, count = pattern.subn(rf"[\1]({glossary}#{anchor_of}){{.term}}", parts[i], count=1)
            if count:
                # What has been linked is not looked at again.
                at = linked.index(f"]({glossary}#{anchor_of})")
                begin, end = linked.rindex("[", 0, at), linked.index("}", at) + 1
                parts[i:i + 1] = [linked[:begin], linked[begin:end], linked[end:]]
                break
    return "".join(parts)


def on_config(config):
    config["mdx_configs"].setdefault("toc", {})["slugify"] = anchor
    return config


def on_page_markdown(markdown, page, config, files):
    docs = pathlib.Path(config["docs_dir"]).resolve()
    here = (docs / page.file.src_path).parent

    def inside(match):
        """A link that leaves docs/ has no target in the site; its text stays."""
        text, target = match.groups()
        if re.match(r"[a-z]+:|#", target):
            return match[0]
        path = pathlib.Path(os.path.normpath(here / target.split("#")[0]))
        return match[0] if docs in path.parents else text

    markdown = re.sub(r"(?<!!)\[([^\]]*)\]\(([^)\s]+)\)", inside, markdown)
    if not page.file.src_path.startswith(("index", "glossary", "reference/", "internals/data/")):
        markdown = with_terms(markdown, terms(docs), os.path.relpath(docs / "glossary.md", here))
    markdown = re.sub(r"^```(\w+) \w+$", r"```\1", markdown, flags=re.M)  # the tests' words behind the language
    return re.sub(r"^(<!--.*?-->)$", r"\n\1\n", markdown, flags=re.M)     # a table begins behind an empty line


def on_post_build(config):
    """Browsers let a page of a disk run scripts and fetch nothing: there the index of the search comes as a script."""
    site = pathlib.Path(config["site_dir"])
    (site / "site.css").write_text((HERE / "site.css").read_text())
    index = json.loads((site / "search/search_index.json").read_text())
    text = json.dumps(index, separators=(",", ":")).replace("</", "<\\/")
    (site / "search/search_index.js").write_text(f"var __search = {{index: Promise.resolve({text})}};\n")
    for name in ("sitemap.xml", "sitemap.xml.gz"):   # for search engines, and with the time of the build in it
        (site / name).unlink(missing_ok=True)
    (site / "search/offline.js").write_text((HERE / "offline.js").read_text())
