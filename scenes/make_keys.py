#!/usr/bin/env python3
"""Writes scenes/KEYS.md, the tables of all keys of a scene, from scenes/pliant-scene.schema.json.

usage: scenes/make_keys.py            writes scenes/KEYS.md
       scenes/make_keys.py --check    writes nothing; prints the differences and ends with status 1 if there are any

The schema file is the output of `pliant schema`; a test compares the two.
"""
import difflib
import json
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
PAGE = FOLDER / "KEYS.md"
INTRODUCTION = """# Keys of a scene

`make_keys.py` wrote this page from `pliant-scene.schema.json`. [README.md](README.md) explains how the keys work together.

A column "default" that is empty means that the key has no value unless it is given. `pliant list shapes` and
`pliant list deformations` print the parameters of shapes and deformations with their ranges.

"""
SCHEMA = json.loads((FOLDER / "pliant-scene.schema.json").read_text())
DEFINITIONS = SCHEMA["definitions"]


def cell(text):
    """Text for a cell of a table."""
    return text.replace("|", "\\|").replace("\n", " ").strip()


def code(value):
    return "`" + (value if isinstance(value, str) and value else json.dumps(value)) + "`"


def number(x):
    return f"{x:g}"


def interval(schema):
    """The admissible numbers of a schema: "> 0", "in [0, 1]"; empty if all numbers are admissible."""
    low, high = schema.get("minimum"), schema.get("maximum")
    above, below = schema.get("exclusiveMinimum"), schema.get("exclusiveMaximum")
    if low is None and above is None:
        if high is not None:
            return f"<= {number(high)}"
        return f"< {number(below)}" if below is not None else ""
    if high is None and below is None:
        return f">= {number(low)}" if low is not None else f"> {number(above)}"
    left = f"[{number(low)}" if low is not None else f"({number(above)}"
    right = f"{number(high)}]" if high is not None else f"{number(below)})"
    return f"in {left}, {right}"


def value(schema):
    """The admissible values of a schema as text, for the column "value"."""
    if "allOf" in schema:
        return value(schema["allOf"][0])
    if "$ref" in schema:
        name = schema["$ref"].split("/")[-1]
        return f"[{name}](#{name})"
    if "anyOf" in schema:
        return " or ".join(value(one) for one in schema["anyOf"])
    kind = schema["type"]
    if kind in ("number", "integer"):
        return f"{kind} {interval(schema)}".strip()
    if kind == "boolean":
        return "`true` or `false`"
    if kind == "array":
        if "maxItems" in schema and schema.get("minItems") == schema["maxItems"]:
            inner = schema["items"]
            if inner.get("type") in ("number", "integer"):
                return f"{schema['minItems']} {inner['type']}s {interval(inner)}".strip()
            return f"{schema['minItems']} of: {value(inner)}"
        items = schema["items"]
        if "oneOf" in items and "const" not in items["oneOf"][0]:
            name = "joint" if "from" in items["oneOf"][0]["properties"] else "law"
            return f"list of: [{name}](#{name})"
        return f"list of: {value(items)}"
    if kind == "string":
        if "oneOf" in schema:
            return "one of the words listed"
        if schema.get("pattern", "").startswith("^#"):
            return '`"#rrggbb"`'
        return "name" if "maxLength" in schema else "text"
    if "oneOf" in schema:
        return "object with `type`"
    return f"object: name → {value(schema['additionalProperties'])}"


def words(schema):
    """The choices of a word with their meanings, for the column "meaning"."""
    if schema.get("type") == "array":
        return words(schema["items"])
    if "oneOf" not in schema or "const" not in schema["oneOf"][0]:
        return ""
    lines = [f"`{one['const']}`: {cell(one['description'])}" for one in schema["oneOf"]]
    return "<br>" + "<br>".join(lines)


def description(schema):
    """The meaning and the unit of a key."""
    text = schema.get("description", "")
    for mark in (" Dimensionless.", " Unit: "):
        if mark in text:
            text, unit = text.rsplit(mark, 1)
            return cell(text), unit.strip().rstrip(".")
    return cell(text), ""


def row(key, schema, required):
    meaning, unit = description(schema)
    default = "required" if required else code(schema["default"]) if "default" in schema else ""
    return f"| `{key}` | {cell(value(schema))} | {cell(unit)} | {cell(default)} | {meaning}{words(schema)} |"


def table(properties, required):
    lines = ["| key | value | unit | default | meaning |", "| --- | --- | --- | --- | --- |"]
    lines += [row(key, schema, key in required) for key, schema in properties.items() if key != "$schema"]
    return lines


def exclusive(record):
    """Sentences on keys of which only one may be given."""
    lines = []
    for group in record.get("allOf", []):
        keys = [one["required"][0] for one in group["oneOf"] if "required" in one]
        needed = len(keys) == len(group["oneOf"])
        lines += ["", f"{'Exactly' if needed else 'At most'} one of {', '.join(code(key) for key in keys)}."]
    return lines


def tagged(title, schema):
    """The records of an object whose key "type" names the record: the common keys, then each type."""
    records = schema["oneOf"]
    common = [key for key in records[0]["properties"]
              if key != "type" and all(key in one["properties"] for one in records)
              and len({json.dumps(one["properties"].get(key)) for one in records}) == 1]
    lines = []
    if common:
        lines += table({key: records[0]["properties"][key] for key in common}, records[0]["required"]) + [""]
    lines += [f"| `type` {title} | meaning | {'other keys' if common else 'keys'} |", "| --- | --- | --- |"]
    for one in records:
        keys = []
        for key, inner in one["properties"].items():
            if key == "type" or key in common:
                continue
            meaning, unit = description(inner)
            default = "required" if key in one["required"] else ""
            if "default" in inner:
                default = "default " + code(inner["default"])
            facts = ", ".join(fact for fact in (value(inner), unit, default) if fact)
            keys.append(f"`{key}` ({cell(facts)}): {meaning}")
        meaning = one["description"].removeprefix("A joint: ").removesuffix("." if title == "of a joint" else "")
        lines.append(f"| `{one['properties']['type']['const']}` | {cell(meaning)} | {'<br>'.join(keys)} |")
    return lines


def references(node):
    """Names of the definitions that a schema refers to, in the order in which they appear."""
    if isinstance(node, dict):
        if "$ref" in node:
            yield node["$ref"].split("/")[-1]
        for child in node.values():
            yield from references(child)
    elif isinstance(node, list):
        for child in node:
            yield from references(child)


def section(name, schema):
    lines = [f"## {name}", ""]
    if "anyOf" in schema:
        text = cell(value(schema))
        if name == "time_function":
            text = text.replace("text", "formula of the time t in quotes (`pliant list functions`)")
        return lines + [text + ".", ""]
    if "oneOf" in schema:
        return lines + tagged("of an " + name, schema) + [""]
    lines += [cell(schema["description"]), ""] + table(schema["properties"], schema.get("required", []))
    lines += exclusive(schema) + [""]
    for key, inner in schema["properties"].items():
        items = inner.get("items", {})
        if "oneOf" in items and "const" not in items["oneOf"][0]:
            singular = {"joints": "joint", "laws": "law"}.get(key, key)
            lines += [f"## {singular}", "", f"An entry of `{key}`.", ""] + tagged("of a " + singular, items) + [""]
    return lines


def keys():
    lines = section("scene", SCHEMA)
    done, queue = set(), list(references(SCHEMA["properties"]))
    while queue:
        name = queue.pop(0)
        if name not in done:
            done.add(name)
            lines += section(name, DEFINITIONS[name])
            queue = list(references(DEFINITIONS[name])) + queue
    return "\n".join(lines).rstrip() + "\n"


def main():
    new = INTRODUCTION + keys()
    if sys.argv[1:] != ["--check"]:
        PAGE.write_text(new)
        return
    old = PAGE.read_text()
    sys.stdout.writelines(difflib.unified_diff(old.splitlines(True), new.splitlines(True), "scenes/KEYS.md",
                                               "as the schema says"))
    sys.exit("scenes/KEYS.md is out of date: run scenes/make_keys.py" if new != old else 0)


if __name__ == "__main__":
    main()
