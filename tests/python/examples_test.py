# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""The examples in docstrings say what is true."""

from __future__ import annotations

import doctest
import os
import re
import subprocess
import sys
from pathlib import Path

import lamina
import pytest

NAMES = [name for name in lamina.__all__ if callable(getattr(lamina, name))]


@pytest.mark.parametrize("name", NAMES)
def test_examples_run(name: str) -> None:
    finder = doctest.DocTestFinder(recurse=False)
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    for example in finder.find(getattr(lamina, name), name, globs={}):
        assert runner.run(example).failed == 0


@pytest.mark.parametrize("name", NAMES)
def test_everything_says_what_it_is(name: str) -> None:
    doc = getattr(lamina, name).__doc__
    assert doc and len(doc) > 20


EXAMPLES = sorted((Path(os.environ.get("LAMINA_SOURCE", Path(__file__).parents[2])) / "examples/python").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_programs_run(example: Path, tmp_path: Path) -> None:
    place = {**os.environ, "PYTHONPATH": str(Path(lamina.__file__).parents[1]), "LAMINA_DRAFT": "1", "MPLBACKEND": "agg"}
    done = subprocess.run([sys.executable, str(example)], cwd=tmp_path, env=place, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


SOURCE = Path(os.environ.get("LAMINA_SOURCE", Path(__file__).parents[2]))


@pytest.mark.parametrize("page", ["docs/python.md", "README.md"])
def test_the_guide_runs(page: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(SOURCE)
    blocks = re.findall(r"```python\n(.*?)```", (SOURCE / page).read_text(), re.DOTALL)
    assert blocks
    for block in blocks:
        draft = block.replace("width=200, samples=16", "width=24, samples=1, profile=\"diffusion\"").replace('.save("arm.png")', "")
        exec(compile(draft, page, "exec"), {})
