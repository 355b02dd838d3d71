# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""The types that the package declares, checked by mypy where it is installed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = Path(os.environ.get("LAMINA_SOURCE", Path(__file__).parents[2]))


def test_types_hold(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    config = ["--config-file", str(SOURCE / "python/mypy.ini"), "--cache-dir", str(tmp_path)]
    examples = map(str, sorted((SOURCE / "examples/python").glob("*.py")))
    done = subprocess.run(
        [sys.executable, "-m", "mypy", *config, str(SOURCE / "python/lamina"), *examples],
        capture_output=True, text=True, cwd=SOURCE,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
