# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""What to say where the module in C++ is of another Python, which does not find it then."""

from __future__ import annotations

import re
import sys
from pathlib import Path


def refusal(folder: Path = Path(__file__).parent) -> ImportError:
    names = " ".join(path.name for path in folder.glob("_lamina.*"))
    of = re.search(r"cpython-(\d)(\d+)", names)
    if of is None:
        return ImportError("lamina: its module _lamina, which is built from C++, is not here")
    this = f"{sys.implementation.name} {sys.version_info[0]}.{sys.version_info[1]}"
    return ImportError(f"lamina: is built for Python {of[1]}.{of[2]}, but this is {this}; see docs/python.md")
