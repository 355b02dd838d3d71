# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Every public name of C++ is in Python, or python/cpp_names.csv says why not."""

from __future__ import annotations

import csv
import inspect
import os
import re
from fnmatch import fnmatchcase
from pathlib import Path

import lamina

SOURCE = Path(os.environ.get("LAMINA_SOURCE", Path(__file__).parents[2]))


def cpp_names() -> list[str]:
    """ROOM/HEADER:NAME of all that docs/cpp_api.md lists, which a test holds against the headers."""
    names, room = [], ""
    for line in (SOURCE / "docs/cpp_api.md").read_text().splitlines():
        if line.startswith("## "):
            room = line[3:].strip()
        elif match := re.match(r"\| `([^`]+)` \| .* \| (`.*`) \|", line):
            names += [f"{room}/{match[1]}:{name}" for name in re.findall(r"`([^`]+)`", match[2])]
    return names


def rows() -> list[dict[str, str]]:
    with open(SOURCE / "python/cpp_names.csv", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def test_every_name_of_cpp_has_its_place() -> None:
    names, table = cpp_names(), rows()
    assert len(names) > 1000
    used = set()
    for name in names:
        found = next((i for i, row in enumerate(table) if fnmatchcase(name, row["cpp"])), None)
        assert found is not None, f"{name}: python/cpp_names.csv does not say where it is, or why not"
        used.add(found)
    stale = [row["cpp"] for i, row in enumerate(table) if i not in used]
    assert not stale, "rows that fit nothing, or come too late"


def test_what_the_table_names_is_there() -> None:
    for row in rows():
        assert row["python"] or row["why"], row["cpp"]
        for name in row["python"].split():
            thing, _, member = name.partition(".")
            assert thing in lamina.__all__, name
            value = getattr(lamina, thing)
            fields = getattr(value, "__dataclass_fields__", {})
            is_argument = inspect.isfunction(value) and member in inspect.signature(value).parameters
            assert not member or hasattr(value, member) or member in fields or is_argument, name


def test_every_name_of_python_is_in_the_table() -> None:
    """But for values, which C++ has no counterpart of its own for."""
    named = {name.partition(".")[0] for row in rows() for name in row["python"].split()}
    values = {"FittedNumber", "FittedSeries", "PatchLight", "__version__"}
    assert set(lamina.__all__) - named <= values, set(lamina.__all__) - named - values
