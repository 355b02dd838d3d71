#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""The documentation as a site that needs no network: docs/, the API of Python, the formats by their schemas.

usage: PYTHONPATH=BUILD/python tools/docs/build_site.py OUT      writes OUT/site; OUT/pages is what mkdocs reads

It ends with an error if a page links to what is not there.
"""

import html.parser
import io
import re
import shutil
import subprocess
import sys
import urllib.parse
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import python_page  # noqa: E402
import schema_page  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
TOP_PAGES = ("CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md")


def moved(link, page, pages):
    """A link of a page in docs/ to a file outside of it: to a page of the site, or to a copy of the file."""
    address, mark, anchor = link.partition("#")
    if not address or "://" in link or link.startswith("mailto:"):
        return link
    target = (page.parent / address).resolve()
    depth = "../" * (len(page.relative_to(ROOT / "docs").parts) - 1) if ROOT / "docs" in page.parents else ""
    if ROOT / "docs" in target.parents:
        return depth + str(target.relative_to(ROOT / "docs")) + mark + anchor
    if not target.exists():
        sys.exit(f"{page}: links to {link}, which is not there")
    inside = target.relative_to(ROOT)
    if str(inside) == "README.md":
        return depth + "index.md"
    if str(inside) in TOP_PAGES:
        return depth + str(inside) + mark + anchor
    if target.is_dir():
        copy = pages / "files" / f"{inside}.txt"
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_text("\n".join(sorted(str(f.relative_to(ROOT)) for f in target.rglob("*") if f.is_file())) + "\n")
        return f"{depth}files/{inside}.txt"
    copy = pages / "files" / inside
    copy.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(target, copy)
    return f"{depth}files/{inside}"


def with_titles(text, page):
    """Links that are called by the name of a file are called by its title."""

    def titled(match):
        target = (page.parent / match[2]).resolve()
        heading = re.search(r"^# (.+)$", target.read_text(), re.MULTILINE) if target.exists() else None
        return f"[{heading[1]}]({match[2]})" if heading else match[0]

    return re.sub(r"\[(?:[\w-]+/)*([\w-]+\.md)\]\(([\w./-]+\.md)\)", titled, text)


def with_lists(text):
    """mkdocs wants an empty line before a list, and four spaces before what belongs to its items."""
    lines, in_code = [], False
    for line in text.splitlines():
        if line.lstrip().startswith("```"):
            in_code = not in_code
        is_item = re.match(r"\s*([-*]|\d+\.) ", line) is not None and not in_code
        if is_item and lines and lines[-1].strip() and not re.match(r"\s*([-*]|\d+\.) |\s{2,}", lines[-1]):
            lines.append("")
        lines.append(line)
    return "\n".join(lines) + "\n"


def copy_pages(pages):
    for source in sorted((ROOT / "docs").rglob("*")):
        if source.is_dir():
            continue
        target = pages / source.relative_to(ROOT / "docs")
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.suffix != ".md":
            shutil.copyfile(source, target)
            continue
        text = re.sub(r"(\]\()([^)\s]+)(\))", lambda m: m[1] + moved(m[2], source, pages) + m[3],
                      with_titles(source.read_text(), source))
        target.write_text(with_lists(text))
    for name in TOP_PAGES:
        source = ROOT / name
        text = re.sub(r"(\]\()([^)\s]+)(\))", lambda m: m[1] + moved(m[2], source, pages) + m[3], source.read_text())
        (pages / name).write_text(with_lists(text))


class Links(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.links, self.anchors = [], set()

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        for name in ("id", "name"):
            if given.get(name):
                self.anchors.add(given[name])
        for name in ("href", "src"):
            if given.get(name):
                self.links.append(given[name])


def check_links(site):
    """What pages of the site link to is there, anchors included; nothing comes from elsewhere."""
    read = {}
    for page in site.rglob("*.html"):
        read[page] = Links()
        read[page].feed(page.read_text())
    wrong = []
    for page, found in read.items():
        for link in found.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme in ("http", "https", "mailto", "data") or link in ("#", "."):
                continue
            path = urllib.parse.unquote(parts.path)
            target = (site / path.lstrip("/") if path.startswith("/") else page.parent / path).resolve() if path else page
            if target.is_dir():
                target = target / "index.html"
            if not target.exists():
                wrong.append(f"{page.relative_to(site)}: {link}")
            elif parts.fragment and target in read and urllib.parse.unquote(parts.fragment) not in read[target].anchors:
                wrong.append(f"{page.relative_to(site)}: {link}: there is no such heading")
    return wrong


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    if shutil.which("mkdocs") is None:
        print("skipped: mkdocs-material is not installed", file=sys.stderr)
        sys.exit(77)
    out = Path(sys.argv[1]).resolve()
    pages, site = out / "pages", out / "site"
    for folder in (pages, site):
        shutil.rmtree(folder, ignore_errors=True)
    pages.mkdir(parents=True)
    copy_pages(pages)
    shutil.copyfile(ROOT / "tools/docs/site.css", pages / "site.css")
    text = io.StringIO()
    python_page.main(text)
    (pages / "python_api.md").write_text(with_lists(text.getvalue()))
    for schema in sorted((ROOT / "schema").glob("*.schema.json")):
        page = pages / "formats" / f"{schema.name.split('.')[0]}.md"
        page.parent.mkdir(exist_ok=True)
        page.write_text(schema_page.page(schema))
        copy = pages / "files/schema" / schema.name
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(schema, copy)
    config = out / "mkdocs.yml"
    config.write_text((ROOT / "tools/docs/mkdocs.yml").read_text() + f"docs_dir: {pages}\nsite_dir: {site}\n")
    subprocess.run([sys.executable, "-m", "mkdocs", "build", "--quiet", "--config-file", str(config)], check=True)
    wrong = check_links(site)
    for line in sorted(set(wrong)):
        print(line, file=sys.stderr)
    if wrong:
        sys.exit(f"{len(set(wrong))} links lead nowhere")
    print(f"{site}/index.html")


if __name__ == "__main__":
    main()
