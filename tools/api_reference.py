#!/usr/bin/env python3
"""Writes the API reference, doc/api.md, from the public headers, engine/include/girih/*.h.

A header's first comment block says what it is for and how stable it is. After that, a comment
belongs to the declarations right below it, up to the next blank line; `// --- Title ---` begins a
section. With --check nothing is written: the exit status is 1 where the reference is out of date.
"""
import argparse
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEADERS = ROOT / "engine" / "include" / "girih"
REFERENCE = ROOT / "doc" / "api.md"
# As a host meets them.
ORDER = ["girih", "version", "result", "catalogue", "mesh", "context", "surface", "plan", "cpu"]


def markdown(lines):
    """Comment lines as text: only what Markdown would take for marks is escaped."""
    text = "\n".join(lines)
    return re.sub(r"([*<])", r"\\\1", text)


def names(declarations):
    """What a group of declarations declares, in order."""
    pattern = (r"^#define (\w+)"
               r"|\b(girih_\w+)\((?!\*)"
               r"|^typedef .*\(\*(girih_\w+)\)"
               r"|^\} (girih_\w+);"
               r"|^typedef (?:struct|enum) \w+ (girih_\w+);")
    code = re.sub(r"//.*", "", declarations)
    found = [next(filter(None, match.groups())) for match in re.finditer(pattern, code, re.M)]
    return list(dict.fromkeys(name for name in found if name))


class Header:
    """One header: its introduction, and its items as (title, text, declarations)."""

    def __init__(self, path):
        lines = path.read_text(encoding="utf-8").splitlines()
        guard = next(n for n, line in enumerate(lines) if line.startswith("#ifndef"))
        head = [line[3:] for line in lines[:guard] if line.startswith("//")]
        self.name = f"girih/{path.name}"
        self.stability = next(line for line in head if line.startswith("Stability: "))[11:]
        self.introduction = [line for line in head if not line.startswith("Stability: ")]
        self.includes = [line for line in lines if line.startswith('#include "girih/')]
        self.items = []
        self.read(lines[guard + 2:-1])
        if not self.items and not self.includes:
            raise SystemExit(f"{path}: nothing is declared")

    def read(self, lines):
        comment, code, depth = [], [], 0

        def finish():
            nonlocal comment, code
            if comment or code:
                self.items.append((None, comment, "\n".join(code)))
            comment, code = [], []

        skipping = 0
        for line in lines:
            # What serves C++ and the linker is no concern of the reader's.
            if line.startswith(("#ifdef", "#if ")):
                skipping += 1
            if skipping or line.startswith("#include"):
                skipping -= line.startswith("#endif")
                continue
            section = re.match(r"// --- (.*?) -+$", line)
            if section:
                finish()
                self.items.append((section.group(1), [], ""))
            elif depth == 0 and line.startswith("//"):
                if code:
                    finish()
                comment.append(line[3:])
            elif depth == 0 and not line.strip() and not (code and code[-1].endswith("\\")):
                finish()
            else:
                code.append(line)
                bare = re.sub(r"//.*", "", line)
                depth += bare.count("{") - bare.count("}")
        finish()

    def text(self):
        parts = [f"## {self.name}", f"Stability: {self.stability}.", markdown(self.introduction)]
        if not self.items:
            parts.append("Includes " + ", ".join(f"`{line[10:-1]}`" for line in self.includes) + ".")
        for section, comment, code in self.items:
            if section:
                parts.append(f"### {section}")
                continue
            declared = names(code)
            if code and not declared:
                raise SystemExit(f"{self.name}: cannot tell what is declared here:\n{code}")
            if declared:
                parts.append("#### " + ", ".join(declared))
                parts.append(f"```c\n{code}\n```")
            if comment:
                parts.append(markdown(comment))
        return "\n\n".join(part for part in parts if part)


def reference():
    found = {path.stem: path for path in HEADERS.glob("*.h")}
    unknown = sorted(set(found) ^ set(ORDER))
    if unknown:
        raise SystemExit(f"{', '.join(unknown)}: in {HEADERS} or in ORDER of {__file__}, not in both")
    headers = [Header(found[stem]) for stem in ORDER]
    table = ["| header | stability |", "|---|---|"]
    for header in headers:
        anchor = re.sub(r"[^a-z0-9_ -]", "", header.name.lower())
        table.append(f"| [{header.name}](#{anchor}) | {header.stability} |")
    head = ("# API reference\n\n"
            "Generated from the public headers by `tools/api_reference.py`; change those, then run "
            "it again.\n[embedding.md](embedding.md) tells the same as a story.")
    return "\n\n".join([head, "\n".join(table)] + [header.text() for header in headers]) + "\n"


def main():
    arguments = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    arguments.add_argument("--check", action="store_true", help="write nothing, say if out of date")
    check = arguments.parse_args().check
    text = reference()
    if not check:
        REFERENCE.write_text(text, encoding="utf-8")
    elif not REFERENCE.exists() or REFERENCE.read_text(encoding="utf-8") != text:
        print("doc/api.md is out of date: run tools/api_reference.py", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
