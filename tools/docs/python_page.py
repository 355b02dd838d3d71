#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""The Python package as a page, from its docstrings, each beside what it is in C++.

usage: PYTHONPATH=BUILD/python python3 tools/docs/python_page.py > PAGE.md
"""

import csv
import inspect
import re
import sys
from pathlib import Path

import lamina

ROOT = Path(__file__).resolve().parents[2]


def cpp_names():
    """Python name: [what it is in C++]."""
    names = {}
    with open(ROOT / "python/cpp_names.csv", newline="") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            for name in row["python"].split():
                names.setdefault(name.split(".")[0], []).append(row["cpp"])
    return names


def docstring(text):
    """`:param x: y` as a list, examples as code."""
    lines, in_example = [], False
    for line in inspect.cleandoc(text).splitlines():
        is_code = line.startswith((">>>", "...")) or (in_example and line.strip() != "")
        if is_code != in_example:
            lines.append("```pycon" if is_code else "```")
            if not is_code:
                lines.append("")
            in_example = is_code
        if is_code:
            lines.append(line)
            continue
        line = re.sub(r"^:param ([\w, ]+):", r"- **\1**:", line)
        line = re.sub(r"^:(raises|return|returns) ?(.*?):", r"- *\1* `\2`:", line)
        line = re.sub(r"^    (\w+): ", r"- **\1**: ", line)
        if line.startswith("- ") and lines and lines[-1] and not lines[-1].startswith(("- ", "  ")):
            lines.append("")
        lines.append(line)
    if in_example:
        lines.append("```")
    return "\n".join(lines)


def signature(thing):
    try:
        text = f"{thing.__name__}{inspect.signature(thing)}"
    except (TypeError, ValueError):
        return thing.__name__
    text = re.sub(r"(: |-> )'([^']*)'", r"\1\2", text)
    text = re.sub(r"(numpy\.|np\.)", "", text)
    if len(text) > 88:
        head, _, rest = text.partition("(")
        body, _, tail = rest.rpartition(")")
        depth, part, parts = 0, "", []
        for character in body:
            depth += {"[": 1, "(": 1, "]": -1, ")": -1}.get(character, 0)
            if character == "," and depth == 0:
                parts.append(part.strip())
                part = ""
            else:
                part += character
        parts.append(part.strip())
        text = head + "(\n    " + ",\n    ".join(parts) + ",\n)" + tail
    return text


def main(out=sys.stdout):
    in_cpp = cpp_names()
    write = lambda *text: print(*text, file=out)
    write("# The Python package\n")
    write(inspect.cleandoc(lamina.__doc__) + "\n")
    write("How to get it, shapes, errors: [Python](python.md). The same in C++: [headers](cpp_api.md).\n")
    functions = [n for n in lamina.__all__ if inspect.isfunction(getattr(lamina, n))]
    classes = [n for n in lamina.__all__ if inspect.isclass(getattr(lamina, n))]
    for title, names in (("Functions", functions), ("Classes", classes)):
        write(f"## {title}\n")
        write(" · ".join(f"[{n}](#{n.lower()})" for n in sorted(names, key=str.lower)) + "\n")
        for name in sorted(names, key=str.lower):
            thing = getattr(lamina, name)
            write(f"### {name}\n")
            if inspect.isfunction(thing):
                write(f"```python\n{signature(thing)}\n```\n")
            write(docstring(thing.__doc__ or "") + "\n")
            if inspect.isclass(thing):
                for member, value in vars(thing).items():
                    doc = value.__doc__ if isinstance(value, property) or inspect.isfunction(value) else None
                    if doc and not member.startswith("_"):
                        call = f"{member}{inspect.signature(value)}" if inspect.isfunction(value) else member
                        call = re.sub(r"(: |-> )'([^']*)'", r"\1\2", call).replace("(self, ", "(").replace("(self)", "()")
                        write(f"- **`{call}`**: {' '.join(inspect.cleandoc(doc).split())}")
                write()
            if name in in_cpp:
                write("In C++: " + ", ".join(f"`{cpp}`" for cpp in dict.fromkeys(in_cpp[name])) + "\n")


if __name__ == "__main__":
    main()
