#!/usr/bin/env python3
"""The first sentence of a declaration's comment names the thing, or says what the function does.

usage: plain_words_test.py ROOT
"""
import pathlib
import re
import sys

# Words that a reader has to solve: what they stand for comes later, or was said elsewhere.
RIDDLE = re.compile(r"(What|Of|As|The same|Those|It|They|That|This|These|Them|Its|Their|Which|Whose|Who)\b")


def is_comment(line):
    return line.startswith("///") and not line.startswith("///<")


def riddles(text):
    """The lines of first sentences that begin so, with their numbers."""
    lines = [line.strip() for line in text.split("\n")]
    for i, line in enumerate(lines):
        is_first = is_comment(line) and not (i and is_comment(lines[i - 1]))
        if is_first and RIDDLE.match(line.removeprefix("///").strip()):
            yield i + 1, line


def main():
    assert list(riddles("/// What is read.\nint a;")), "the rule finds nothing"
    assert not list(riddles("/// Numbers that are read.\n/// What else.\nint a;  ///< What it is"))
    root = pathlib.Path(sys.argv[1])
    headers = [h for folder in ("src", "cli", "python", "tests", "tools", "benchmarks")
               for h in (root / folder).rglob("*.h")]
    assert len(headers) > 300, len(headers)
    found = [f"{h.relative_to(root)}:{number}: {line}"
             for h in sorted(headers) for number, line in riddles(h.read_text(encoding="utf-8"))]
    print("\n".join(found))
    return 1 if found else 0


sys.exit(main())
