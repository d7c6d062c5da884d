#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Compares the JSON Schema of decks with the program, both ways: of random
documents, those that the schema accepts are accepted by the program, and those
that it does not accept are refused.

deck_schema.py PROGRAM N SEED FILE...: N documents; the text decks FILE... become
documents too, which must be valid. The folder must be writable. Exit status 77:
jsonschema is not installed.
"""
import copy
import json
import random
import subprocess
import sys

try:
    import jsonschema
except ImportError:
    print("skipped: python3-jsonschema is not installed")
    sys.exit(77)


def run(program, *words):
    return subprocess.run([program, *words], capture_output=True, text=True)


# --- conditions that JSON Schema cannot express ------------------------------

PATCH_LISTS = ("walls", "slip", "baffles", "sheets", "zone_interfaces")


def settings(deck):
    return deck.get("settings", {})


def positive(values, name):
    v = values.get(name)
    return v if isinstance(v, (int, float)) and v > 0 else 0


def ranges(deck):
    for name in PATCH_LISTS:
        text = settings(deck).get(name, "")
        for item in text.replace(",", " ").split():
            low, dash, high = item[1:].partition("-")
            try:
                if dash and int(item[0] + low) > int(high):
                    return False
            except ValueError:
                pass   # a name
    return True


def sizes(deck):
    low, high = (positive(settings(deck), k) for k in ("hmin", "hmax"))
    return not (low and high) or low <= high


def first_height(deck):
    s = settings(deck)
    first, total = positive(s, "first"), positive(s, "layer_total")
    y, re, length = (positive(s, k)
                     for k in ("y_plus", "reynolds", "reference_length"))
    if y and re and length:
        # The formula of the condition needs cf: near the limit it is left open.
        first = None if total else 0
    if not total or first is None:
        return None if first is None else True
    return first <= total


def corners(deck):
    f = deck.get("farfield", {})
    return all(f[k + "lo"] < f[k + "hi"] for k in "xyz"
               if f.get(k + "lo") is not None and f.get(k + "hi") is not None)


def wakes(deck):
    return all((r.get("kind") == "sheet" or
                r.get("size", 0.02) <= min(r.get("length", 2),
                                           2 * r.get("height", 0.05)))
               and r.get("up", "auto") != r.get("stream", "x").lstrip("-")
               for r in deck.get("wakes", ()))


def periodic(deck):
    def given(row, names):
        return [row[k] for k in names.split() if row.get(k) is not None]

    for r in deck.get("periodic", ()):
        shift, axis = given(r, "tx ty tz"), given(r, "ux uy uz")
        if any(isinstance(v, str) for v in shift + given(r, "x y z")):
            return None   # with units, the program may check later
        angle, kind = given(r, "angle"), r.get("kind", "auto")
        if len(shift) % 3 or len(axis) % 3 or bool(angle) != bool(axis):
            return False
        if any(v and not any(v) for v in (shift, axis, angle)):
            return False
        if given(r, "x y z") and not angle or shift and angle:
            return False
        if shift and kind == "rotation" or angle and kind == "translation":
            return False
    return True


def patches(deck):
    for table in ("patches", "layers"):
        ids = [r["id"] for r in deck.get(table, ())
               if not isinstance(r["id"], str)]
        if len(set(ids)) < len(ids):
            return False
    return True


def bytes_of(value, schema):
    """Texts within x-maxBytes, found by walking the schema with the document."""
    if isinstance(value, str):
        limits = [schema] + schema.get("anyOf", [])
        return all(len(value.encode()) <= s["x-maxBytes"] for s in limits
                   if "x-maxBytes" in s)
    if isinstance(value, dict):
        members = schema.get("properties", {})
        return all(bytes_of(v, members.get(k, {})) for k, v in value.items())
    if isinstance(value, list):
        return all(bytes_of(v, schema.get("items", {})) for v in value)
    return True


CONDITIONS = {"ranges": ranges, "sizes": sizes, "first-height": first_height,
              "corners": corners, "wakes": wakes,
              "periodic": periodic, "patches": patches,
              "bytes": None}


def list_names(deck):
    """The names in lists of patches have at most 79 bytes."""
    texts = [settings(deck).get(k, "") for k in PATCH_LISTS]
    return all(len(item.encode()) <= 79 for text in texts if text != ""
               for item in text.replace(",", " ").split())


def meets(deck, schema):
    """True, False, or None where this test cannot decide."""
    found = [c(deck) for c in CONDITIONS.values() if c]
    found += [bytes_of(deck, schema), list_names(deck)]
    return False if False in found else None if None in found else True


# --- random documents --------------------------------------------------------

WORDS = ["", "auto", "a", "-", "12", "+3", "-7", "wing*", "3-12,15", "12-3",
         "b8.ugrid,vtu", "foam", "foam,foam-ascii", "foam, openfoam", "vtu,,su2",
         "B8.UGRID", "auto,vtu", "nonsense", "'a b',c", '"x', "1-", "--5", "tab\t",
         "end\n", "\u00e9" * 60, "x" * 79, "x" * 80, "x" * 239, "x" * 240,
         "x" * 480, "./m.so", "tetgen", "builtin", "hxt ", "9" * 18, "9" * 19,
         "\x7f", "\u2028", "1,2,4", "\u00df/\u03b1"]


class Maker:
    def __init__(self, schema, seed):
        self.schema, self.r = schema, random.Random(seed)

    def number(self, s, whole):
        r = self.r
        low = s.get("minimum", s.get("exclusiveMinimum", -1e60))
        high = s.get("maximum", 1e60)
        pick = r.choice(("low", "high", "in", "in", "in", "near", "out"))
        v = {"low": low, "high": high, "near": low + r.choice((1, 0.5, 2)),
             "out": r.choice((low - 1, high * 1.5, 0, -1)),
             "in": r.uniform(max(low, -5), min(high, 50))}[pick]
        if whole and r.random() < 0.95:
            v = int(v)
        elif v == int(v) and abs(v) < 1e15 and r.random() < 0.5:
            v = int(v)
        return v

    def wrong(self):
        return self.r.choice((None, True, False, 0, 1, 1.5, "yes", "no", "0.5",
                              [], {}, [1], 1e300, -1e300, 10**30))

    def value(self, s):
        r = self.r
        if r.random() < 0.04:
            return self.wrong()
        if "enum" in s:
            return r.choice(s["enum"]) if r.random() < 0.97 else "Auto"
        kinds = s.get("type")
        if kinds is None:   # a number or name of a patch
            return self.value(r.choice(s["anyOf"]))
        kind = r.choice(kinds) if isinstance(kinds, list) else kinds
        if kind == "null":
            return None
        if kind == "boolean":
            return r.random() < 0.5
        if kind in ("number", "integer"):
            return self.number(s, kind == "integer")
        if kind == "string":
            return r.choice(WORDS)
        if kind == "array":
            return [self.value(s["items"]) for i in range(r.randint(0, 3))]
        return self.object(s)

    def object(self, s, share=None):
        r = self.r
        share = r.choice((0.02, 0.1, 0.3)) if share is None else share
        o = {}
        for name, member in s["properties"].items():
            needed = name in s.get("required", ()) and r.random() < 0.98
            if needed or r.random() < share:
                o[name] = self.value(member)
        if r.random() < 0.02:
            o[r.choice(("growht", "Growth", "x", ""))] = 1
        return o

    def deck(self):
        deck = self.object(self.schema, 0.4)
        deck.pop("$schema", None)
        return deck


def tamed(deck, validator, rounds=8):
    """Remove members that are not valid, so that a good part of the documents is
    valid and conditions between members come into play."""
    deck = copy.deepcopy(deck)
    for k in range(rounds):
        errors = list(validator.iter_errors(deck))
        if not errors:
            return deck
        for e in errors:
            path = list(e.absolute_path)
            if not path:
                bad = [k for k in deck if k not in validator.schema["properties"]]
                for k in bad or list(deck)[:1]:
                    deck.pop(k, None)
                continue
            at = deck
            try:
                for step in path[:-1]:
                    at = at[step]
                del at[path[-1]]
            except (KeyError, IndexError, TypeError):
                pass
    return deck


# --- the comparison ----------------------------------------------------------

class Comparison:
    def __init__(self, program):
        made = run(program, "deck", "--schema")
        assert made.returncode == 0, made.stderr
        self.program, self.schema = program, json.loads(made.stdout)
        kind = jsonschema.validators.validator_for(self.schema)
        assert kind is jsonschema.Draft202012Validator
        kind.check_schema(self.schema)
        self.validator = kind(self.schema)
        assert set(self.schema["x-conditions"]) == set(CONDITIONS)
        self.n = {True: 0, False: 0, None: 0}
        self.faults = 0

    def takes(self, deck):
        with open("random.deck", "w") as f:
            json.dump(deck, f)
        ran = run(self.program, "deck", "--deck", "random.deck", "--json")
        assert ran.returncode in (0, 1), (ran.returncode, deck)
        if ran.returncode:
            assert ran.stderr.startswith("vanguard: random.deck:"), ran.stderr
        return ran

    def compare(self, deck):
        errors = list(self.validator.iter_errors(deck))
        expected = False if errors else meets(deck, self.schema)
        ran = self.takes(deck)
        self.n[expected] += 1
        if expected is not None and expected != (ran.returncode == 0):
            self.faults += 1
            print("schema:", "valid" if expected else
                  [(list(e.absolute_path), e.message[:200]) for e in errors],
                  "\nprogram:", ran.stderr.strip() or "accepted", "\ndocument:",
                  json.dumps(deck))
        if ran.returncode == 0:
            self.again(json.loads(ran.stdout))

    def again(self, written):
        """What the program writes is valid, and is read as the same deck."""
        for e in self.validator.iter_errors(written):
            self.faults += 1
            print("written:", list(e.absolute_path), e.message[:200])
        assert json.loads(self.takes(written).stdout) == written

    def text_deck(self, path):
        made = run(self.program, "deck", "--deck", path, "--json")
        assert made.returncode == 0, made.stderr
        self.again(json.loads(made.stdout))


def main(program, n, seed, *files):
    c = Comparison(program)
    for path in files:
        c.text_deck(path)
    maker = Maker(c.schema, int(seed))
    for k in range(int(n)):
        deck = maker.deck()
        c.compare(tamed(deck, c.validator) if k % 2 else deck)
    print(f"{len(files)} text decks; documents: {c.n[True]} valid, "
          f"{c.n[False]} not valid, {c.n[None]} undecided; {c.faults} faults")
    assert min(c.n[True], c.n[False]) > int(n) / 5, "one-sided documents"
    return c.faults != 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
