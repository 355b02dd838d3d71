# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""The examples in docstrings say what is true."""

from __future__ import annotations

import doctest

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
