#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Writes what pages repeat from elsewhere: the help of subcommands into docs/command.md, docs/cpp_api.md
from the public headers, and the verdicts of reproduce/summary.json into docs/reproduction.md and
README.md. tests/docs/docs_test.py fails while they differ.

    write_pages.py LAMINA
"""
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
MARK = "<!-- from here on written by tools/docs/write_pages.py -->\n"


def help_of(lamina, *words):
    return subprocess.run([lamina, *words, "--help"], capture_output=True, text=True, check=True).stdout


def command_page(lamina):
    """docs/command.md: what stands there up to the mark, then the help of each subcommand."""
    head = (ROOT / "docs/command.md").read_text().split(MARK)[0]
    names = re.findall(r"^  (\w+)  ", help_of(lamina).split("Subcommands:")[1], re.MULTILINE)
    blocks = [f"\n### lamina {name}\n\n```text\n{help_of(lamina, name).strip()}\n```\n" for name in names]
    return head + MARK + "\n## Subcommands\n" + "".join(blocks)


def first_sentence(comment):
    text = " ".join(line.strip() for line in comment).strip().split("  ")[0]
    return re.split(r"(?<=[.;:])\s(?=[A-Z@])|(?<=[a-z)\]])\. |@\w+|\n", text + " ")[0].strip().rstrip(".;:")


def declarations(text):
    """(first sentence or "", name) of what a header declares directly in namespace lamina."""
    comment, found, depth = [], [], 0
    for line in text.split("namespace lamina {", 1)[-1].splitlines():
        if depth == 0 and line.startswith("///"):
            comment.append(line[3:])
            continue
        line = re.sub(r"^template <.*?>(?= |$) ?", "", line)
        name = re.match(r"(?:class|struct|enum class|enum|concept) (?:\[\[\w+\]\] )?(\w+)(?=[^;]*$| \{)", line) \
            or re.match(r"using (\w+) =", line) \
            or re.match(r"(?:\[\[nodiscard\]\] |inline |constexpr |extern |static |template <[^>]*> )*"
                        r"(?!return|namespace|requires)[\w:<>,&* ]+?[\s&*](\w+)(?:\(|\{| =|;)", line)
        if depth == 0 and name and not line.startswith((" ", "}", "#", "//")):
            found.append((first_sentence(comment), name.group(1)))
        if line.strip() and not line.startswith("requires"):
            comment = []
        code = re.sub(r'//.*|"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])\'', "", line)
        depth += code.count("{") - code.count("}")
    return found


def api_page():
    """docs/cpp_api.md: every public header, with its first sentence and the names that it declares."""
    source = ROOT / "src/lamina"
    rooms = {}
    for header in sorted(source.rglob("*.h")):
        if "internal" not in header.parts and not header.name.endswith("-inl.h"):
            rooms.setdefault(str(header.parent.relative_to(source)), []).append(header)
    page = ["# The C++ headers\n\n"
            "Public headers by room: what the first declaration of each is, and all names that it declares in namespace\n"
            "`lamina`. Include them as `\"lamina/ROOM/HEADER\"`; the comments there say units, ranges, errors and sources.\n"
            "What a room is for: [architecture.md](architecture.md). Written by `tools/docs/write_pages.py`.\n"]
    for room, headers in rooms.items():
        page.append(f"\n## {room}\n\n| header | | declares |\n|---|---|---|\n")
        for header in headers:
            found = declarations(header.read_text())
            sentence = next((text for text, _ in found if text), "").replace("|", "\\|").replace("<", "&lt;")
            names = ", ".join(f"`{name}`" for name in dict.fromkeys(name for _, name in found))
            page.append(f"| `{header.name}` | {sentence} | {names} |\n")
    return "".join(page)


VERDICTS = {"agrees": "agree", "agrees_in_shape": "agree in shape", "differs": "differ", "not_made": "not made"}
PAPERS = {"hanrahan_krueger_1993": "Hanrahan & Krueger 1993", "xu_sun_2008": "Xu & Sun 2008", "hery_2003": "Hery 2003",
          "donner_jensen_2005": "Donner & Jensen 2005", "donner_2008": "Donner et al. 2008"}


def reproductions():
    """{item: what reproduce/summary.json says of it}"""
    return json.loads((ROOT / "reproduce/summary.json").read_text())["items"]


def counts_of(items):
    """As in "12 agree, 3 agree in shape", without verdicts that no item has."""
    verdicts = [item["verdict"] for item in items]
    return ", ".join(f"{verdicts.count(key)} {text}" for key, text in VERDICTS.items() if key in verdicts)


def reproduction_page():
    """docs/reproduction.md: what stands there up to the mark, then the verdicts of all items."""
    items = reproductions()
    page = [(ROOT / "docs/reproduction.md").read_text().split(MARK)[0], MARK,
            f"\n## What agrees\n\nOf {len(items)} items in draft quality {counts_of(items.values())}. "
            "The third column is what decides: a feature, or the number\nthat is nearest to what it may be off.\n"]
    for paper, title in PAPERS.items():
        page.append(f"\n### {title}\n\n| item | verdict | | shows |\n|---|---|---|---|\n")
        for name, item in items.items():
            if item["paper"] == paper:
                cells = (f"`{name}`", item["verdict"].replace("_", " "), item["reason"], item["title"])
                page.append("| " + " | ".join(cell.replace("|", "\\|").replace("<", "&lt;") for cell in cells) + " |\n")
    return "".join(page)


def readme():
    """README.md, with the numbers of items by verdict."""
    items = reproductions().values()
    line = f"of {len(items)} tables and figures of the five papers, {counts_of(items)}"
    return re.sub(r"of \d+ tables and figures of the five papers, [^(|]*?(?= \()", line, (ROOT / "README.md").read_text())


def pages(lamina):
    """(file, what it should hold) for every page that is written here, in part or whole."""
    return ((ROOT / "docs/command.md", command_page(lamina)), (ROOT / "docs/cpp_api.md", api_page()),
            (ROOT / "docs/reproduction.md", reproduction_page()), (ROOT / "README.md", readme()))


if __name__ == "__main__":
    for file, text in pages(sys.argv[1]):
        file.write_text(text)
