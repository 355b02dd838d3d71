#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Writes what pages of docs/ repeat from elsewhere: the help of subcommands into docs/command.md, and
docs/cpp_api.md from the public headers. tests/docs/docs_test.py fails while they differ.

    write_pages.py LAMINA
"""
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


if __name__ == "__main__":
    (ROOT / "docs/command.md").write_text(command_page(sys.argv[1]))
    (ROOT / "docs/cpp_api.md").write_text(api_page())
