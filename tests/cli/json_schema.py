#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Checks JSON reports by their schema: json_schema.py SCHEMA FILE...

Also reports a member that the schema does not describe, so that the schema
remains complete. Exit status 77: jsonschema is not installed."""
import json
import sys

try:
    import jsonschema
except ImportError:
    print("skipped: python3-jsonschema is not installed")
    sys.exit(77)


def undescribed(value, schema, root, at=""):
    """Members of objects that the schema lacks. A schema without a type, which
    describes nothing further, permits everything."""
    if "$ref" in schema:
        schema = root["$defs"][schema["$ref"].rpartition("/")[2]]
    for choice in schema.get("anyOf", ()):
        if "$ref" in choice and isinstance(value, dict):
            yield from undescribed(value, choice, root, at)
    if isinstance(value, dict) and "properties" in schema:
        for name, member in value.items():
            known = schema["properties"].get(name)
            if known is None:
                yield f"{at}.{name}"
            else:
                yield from undescribed(member, known, root, f"{at}.{name}")
    elif isinstance(value, list) and "items" in schema:
        for item in value:
            yield from undescribed(item, schema["items"], root, at + "[]")


def main(path, *reports):
    with open(path) as f:
        schema = json.load(f)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    bad = 0
    for name in reports:
        with open(name) as f:
            report = json.load(f)
        for e in validator.iter_errors(report):
            bad += 1
            print(f"{name}: {list(e.absolute_path)}: {e.message[:200]}")
        for member in sorted(set(undescribed(report, schema, schema))):
            bad += 1
            print(f"{name}: {member} is not in {path}")
    print(len(reports), "reports")
    return bad != 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
