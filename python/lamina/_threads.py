# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""How many cores calls use."""

from __future__ import annotations

from . import _lamina
from ._input import whole


def threads() -> int:
    """The number of threads that calls use."""
    return _lamina.thread_count()


def set_threads(count: int) -> None:
    """Limits the threads of all later calls in this process; 0 means all that there are.

    :raises InvalidInput: unless a whole number in [0, 4096].
    """
    _lamina.set_thread_count(whole("count", count, 0, 4096))
