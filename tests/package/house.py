#!/usr/bin/env python3
"""Measures the structure of the sources: python3 tests/package/house.py [--check] [FOLDER OF THE PROJECT].

Prints the numbers of lines and concepts of each folder of include/pliant and src. Also prints the functions with more
than 60 lines, and the functions with more than 6 parameters. A concept is a file name without its suffix: dynamics.h,
dynamics-inl.h and dynamics.cpp are one concept. The option --check makes the script fail if a folder has more than 20
concepts.
"""
import re
import sys
from pathlib import Path

FOLDERS = "math shape deform local part solve body collision project method contact simulate scene io render view".split()
ENGINE = FOLDERS[:12]
MAX_CONCEPTS, MAX_LINES, MAX_PARAMETERS = 20, 60, 6
NO_FUNCTION = re.compile(r"^\s*(if|for|while|switch|else|do|try|catch|namespace|class|struct|enum|union|extern|return)\b")


def without_comments(text):
    """Returns the text with comments and literals replaced by spaces, so that every brace belongs to the code."""
    pattern = re.compile(r'//[^\n]*|/\*.*?\*/|R"\(.*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'', re.S)
    return pattern.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)


def parameters(head):
    """Returns the number of parameters of a function. head: its declaration, as text."""
    inside = re.sub(r"<[^<>()]*>", "", head)
    while re.search(r"<[^<>()]*>", inside):
        inside = re.sub(r"<[^<>()]*>", "", inside)
    start = inside.find("(")
    depth, count, some = 0, 1, False
    for c in inside[start:]:
        depth += {"(": 1, ")": -1}.get(c, 0)
        if depth == 0:
            break
        count += c == "," and depth == 1
        some = some or not c.isspace() and c not in "()"
    return count if some else 0


def functions(path):
    """Returns (name, line, lines, parameters) of each function defined in a file. A lambda belongs to the function around it."""
    text = without_comments(path.read_text(encoding="utf8"))
    found, open_at, head_start, inner = [], [], 0, 0
    for i, c in enumerate(text):
        if c in ";}" and inner == 0:
            head_start = i + 1
        if c == "{":
            head = re.sub(r"^\s*(public|private|protected):", "", text[head_start:i].strip()).strip()
            head = "\n".join(line for line in head.split("\n") if not line.startswith("#")).strip()
            is_function = (inner == 0 and "(" in head and not NO_FUNCTION.match(re.sub(r"^template\s*<[^{]*?>\s*", "", head))
                           and not re.search(r"=\s*$", head))
            open_at.append((is_function, text.count("\n", 0, i) + 1, head))
            inner += is_function
            if not is_function and inner == 0:
                head_start = i + 1
        elif c == "}" and open_at:
            is_function, line, head = open_at.pop()
            inner -= is_function
            if is_function:
                name = re.search(r"([\w:~]+)\s*\(", head)
                found.append((name[1] if name else "?", line, text.count("\n", 0, i) + 2 - line, parameters(head)))
            if inner == 0:
                head_start = i + 1
    return found


def sources(folder):
    return sorted(p for p in folder.glob("*") if p.suffix in (".h", ".cpp"))


def main():
    check = "--check" in sys.argv
    folders = [a for a in sys.argv[1:] if a != "--check"]
    project = Path(folders[0]) if folders else Path(__file__).resolve().parents[2]
    crowded, totals, long, wide = [], {}, [], []
    print("folder, concepts, lines in headers, lines in src")
    for top in FOLDERS:
        for folder in sorted({p.parent.relative_to(project / base) for base in ("include/pliant", "src")
                              for p in (project / base / top).rglob("*") if p.suffix in (".h", ".cpp")}):
            files = {base: sources(project / base / folder) for base in ("include/pliant", "src")}
            lines = {base: sum(len(p.read_text(encoding="utf8").split("\n")) - 1 for p in paths) for base, paths in files.items()}
            concepts = {re.sub(r"(-inl)?$", "", p.stem) for paths in files.values() for p in paths}
            print(f"{folder}, {len(concepts)}, {lines['include/pliant']}, {lines['src']}")
            if len(concepts) > MAX_CONCEPTS:
                crowded.append(f"{folder} has {len(concepts)} concepts; expected at most {MAX_CONCEPTS}")
            for base, count in lines.items():
                key = ("engine" if top in ENGINE else "scene, io, render and view", base)
                totals[key] = totals.get(key, 0) + count
            for path in files["include/pliant"] + files["src"]:
                for name, line, length, count in functions(path):
                    where = f"{path.relative_to(project)}:{line}: {name}"
                    if length > MAX_LINES:
                        long.append(f"{where}, {length} lines")
                    if count > MAX_PARAMETERS:
                        wide.append(f"{where}, {count} parameters")
    for (part, base), count in sorted(totals.items()):
        print(f"{part}: {count} lines in {base}")
    print(f"{len(long)} functions with more than {MAX_LINES} lines:", *long, sep="\n  ")
    print(f"{len(wide)} functions with more than {MAX_PARAMETERS} parameters:", *wide, sep="\n  ")
    if check and crowded:
        sys.exit("\n".join(crowded))


main()
