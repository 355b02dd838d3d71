#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Notebooks of percent scripts: `# %%` begins a cell, `# %% [markdown]` one of text.

usage: tools/docs/make_notebooks.py OUT [--run] [SCRIPT...]    writes OUT/SCRIPT.ipynb; all of examples/python if none is named

With --run cells are executed (python3-nbclient, python3-ipykernel), and the notebook holds what they show; figures that they
save lie in the script's folder.
"""

import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def cells_of(text):
    for part in re.split(r"^# %%", text, flags=re.MULTILINE)[1:]:
        head, _, body = part.partition("\n")
        is_text = "[markdown]" in head
        body = body.strip("\n")
        if is_text:
            body = "\n".join(re.sub(r"^# ?", "", line) for line in body.splitlines())
        if body:
            yield is_text, body


def notebook_of(text):
    cells = []
    for number, (is_text, body) in enumerate(cells_of(text)):
        cell = {"cell_type": "markdown" if is_text else "code", "id": f"cell-{number}", "metadata": {},
                "source": body.splitlines(keepends=True)}
        if not is_text:
            cell.update(execution_count=None, outputs=[])
        cells.append(cell)
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}


def main(arguments):
    if not arguments:
        sys.exit(__doc__)
    is_run = "--run" in arguments
    out, *scripts = [argument for argument in arguments if argument != "--run"]
    Path(out).mkdir(parents=True, exist_ok=True)
    for script in map(Path, scripts) if scripts else sorted((ROOT / "examples/python").glob("0*.py")):
        notebook = notebook_of(script.read_text())
        if is_run:
            import nbclient
            import nbformat

            parsed = nbformat.reads(json.dumps(notebook), as_version=4)
            place = {"metadata": {"path": str(script.resolve().parent)}}
            nbclient.NotebookClient(parsed, timeout=600, resources=place).execute()
            notebook = json.loads(nbformat.writes(parsed))
        target = Path(out) / f"{script.stem}.ipynb"
        target.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n")
        print(target)


if __name__ == "__main__":
    main(sys.argv[1:])
