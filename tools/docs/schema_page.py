#!/usr/bin/env python3
# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""A JSON schema as a page: every key with its type and range, sub-objects below each other."""

import json
import re


def written(number):
    """As short as it is exact: 1e9, 0.01, 16777216."""
    short = f"{number:g}" if float(f"{number:g}") == number else repr(number)
    return re.sub(r"e\+?(-?)0*(\d+)", r"e\1\2", short)


def number_range(schema):
    low = schema.get("minimum", schema.get("exclusiveMinimum"))
    high = schema.get("maximum", schema.get("exclusiveMaximum"))
    if low is None and high is None:
        return ""
    left = "(" if "exclusiveMinimum" in schema or low is None else "["
    right = ")" if "exclusiveMaximum" in schema or high is None else "]"
    return f" in {left}{'-inf' if low is None else written(low)}, {'inf' if high is None else written(high)}{right}"


def kind(schema, definitions, depth=0):
    """What a value may be, in words."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[-1]
        if name in definitions and definitions[name].get("type") not in ("object",) and depth < 4:
            return kind(definitions[name], definitions, depth + 1)
        has_heading = name in definitions and any(objects(definitions[name]))
        return f"[`{name}`](#{name.lower()})" if has_heading else f"`{name}`"
    if "const" in schema:
        return f"`{json.dumps(schema['const'])}`"
    if "enum" in schema:
        return ", ".join(f"`{json.dumps(value)}`" for value in schema["enum"])
    for choice in ("oneOf", "anyOf"):
        if choice in schema:
            return " or ".join(dict.fromkeys(kind(s, definitions, depth + 1) for s in schema[choice]))
    if "allOf" in schema:
        each = dict.fromkeys(kind(s, definitions, depth + 1) for s in schema["allOf"])
        return " and ".join(one for one in each if one != "anything") or "anything"
    of = schema.get("type")
    if of is None and "items" in schema:
        of = "array"
    if of in ("number", "integer"):
        is_whole = of == "integer" or schema.get("multipleOf") == 1
        return ("whole number" if is_whole else "number") + number_range(schema)
    if of == "array":
        items = schema.get("items", {})
        count = schema.get("minItems"), schema.get("maxItems")
        size = f"{count[0]} " if count[0] is not None and count[0] == count[1] else ""
        each = " / ".join(kind(s, definitions, depth + 1) for s in items) if isinstance(items, list) else kind(
            items, definitions, depth + 1)
        plural = re.sub(r"\bnumber\b", "numbers", each) if each.startswith(("number", "whole number")) else each
        return f"array of {size}{plural}"
    if of == "object":
        return "object"
    if isinstance(of, list):
        return " or ".join(of)
    return {"string": "text", "boolean": "`true` or `false`", None: "anything"}.get(of, str(of))


def objects(schema):
    """The objects that a value may be, with their keys."""
    if schema.get("type") == "object" and schema.get("properties"):
        yield schema
    for choice in ("oneOf", "anyOf", "allOf"):
        for part in schema.get(choice, []):
            yield from objects(part)
    if isinstance(schema.get("items"), dict):
        yield from objects(schema["items"])


def rows(schema, definitions, prefix=""):
    required = schema.get("required", [])
    for key, value in schema.get("properties", {}).items():
        mark = " (required)" if key in required else ""
        text = value.get("description", "").replace("|", "\\|").replace("\n", " ")
        yield f"| `{prefix}{key}`{mark} | {kind(value, definitions)} | {text} |"
        tail = "[]" if value.get("type") == "array" else ""
        for below in objects(value):
            if prefix.count(".") < 2:
                yield from rows(below, definitions, f"{prefix}{key}{tail}.")


def page(file):
    schema = json.loads(file.read_text())
    definitions = schema.get("definitions", {})
    lines = [f"# Format: {schema.get('title', file.stem).replace('lamina ', '')}", "", schema.get("description", ""),
             "", f"Written from [`{file.name}`](../files/schema/{file.name}), which editors use to complete and check files.", ""]
    head = ["| key | value | meaning |", "|---|---|---|"]

    def tables(part):
        found = list(objects(part))
        for number, one in enumerate(found):
            if len(found) > 1:
                lines.extend([f"One of {len(found)}, number {number + 1}:", ""])
            lines.extend(head + list(dict.fromkeys(rows(one, definitions))) + [""])

    tables(schema)
    for name, definition in definitions.items():
        if list(objects(definition)):
            lines.extend([f"## {name}", "", definition.get("description", ""), ""])
            tables(definition)
    return "\n".join(lines)
