#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""Holds a JSON schema against the corpus that the decoder is tested on.

    schema_test.py SCHEMA BAD_FOLDER GOOD_FILE_OR_FOLDER_OR_PAGE...

Every good file must pass, and every bad file must fail where BAD_FOLDER/expected.txt says so:
"syntax" in a strict JSON reader, "schema" in the schema, "beyond" in neither. Of a Markdown page
the ```jsonc blocks are taken. Exits with 77, which ctest counts as skipped, without jsonschema.
"""
import json
import pathlib
import re
import sys

try:
    import jsonschema
except ImportError:
    print("skipped: the Python package jsonschema (Debian: python3-jsonschema) is not installed")
    sys.exit(77)

TOKEN = re.compile(r'"(?:\\.|[^"\\])*"|//[^\n]*|/\*.*?\*/', re.DOTALL)


def without_comments(text):
    return TOKEN.sub(lambda m: m.group() if m.group().startswith('"') else " ", text)


def refuse(message):
    raise ValueError(message)


def entries(pairs):
    if len({key for key, _ in pairs}) < len(pairs):
        refuse("a key is there twice")
    return dict(pairs)


def finite(text):
    value = float(text)
    return value if abs(value) < float("inf") else refuse(text + " is too large")


def read(data):
    """Strict JSON. Raises ValueError (RecursionError where brackets nest deeply)."""
    text = without_comments(data.decode("utf-8-sig"))
    return json.loads(text, object_pairs_hook=entries, parse_float=finite, parse_constant=refuse)


def good_texts(argument):
    path = pathlib.Path(argument)
    if path.suffix == ".md":
        blocks = re.findall(r"```jsonc\n(.*?)```", path.read_text(), re.DOTALL)
        return [(f"{path} block {i}", block.encode()) for i, block in enumerate(blocks)]
    files = sorted(path.glob("*.json")) if path.is_dir() else [path]
    return [(str(file), file.read_bytes()) for file in files]


def main(schema_file, bad_folder, *good):
    schema = json.loads(pathlib.Path(schema_file).read_text())
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    faults = []
    texts = [text for argument in good for text in good_texts(argument)]
    for name, data in texts:
        error = jsonschema.exceptions.best_match(validator.iter_errors(read(data)))
        if error is not None:
            faults.append(f"{name} is good, but: {error.message}")
    bad = 0
    for line in (pathlib.Path(bad_folder) / "expected.txt").read_text().splitlines():
        if line.startswith("#"):
            continue
        name, level = line.split()[:2]
        bad += 1
        try:
            value = read((pathlib.Path(bad_folder) / name).read_bytes())
            found = "beyond" if validator.is_valid(value) else "schema"
        except (ValueError, RecursionError):
            found = "syntax"
        if found != level:
            faults.append(f"{name} is said to fail in '{level}', but '{found}' was found")
    print("\n".join(faults) or f"{len(texts)} good and {bad} bad files as expected")
    return 1 if faults or not texts or not bad else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
