#!/usr/bin/env python3
"""Writes GLSL files into a C file as the array girih_shader_library: embed_glsl.py OUT FILE...

Bytes instead of strings: C compilers need not take strings longer than 4,095 characters.
"""
import os
import sys


def main():
    output, *paths = sys.argv[1:]
    arrays = []
    entries = []
    for number, path in enumerate(sorted(paths, key=os.path.basename)):
        with open(path, "rb") as file:
            text = file.read() + b"\0"
        lines = [",".join(str(byte) for byte in text[at:at + 24]) for at in range(0, len(text), 24)]
        arrays.append(f"static const unsigned char text_{number}[] = {{\n" + ",\n".join(lines) + "};\n")
        entries.append(f'    {{"{os.path.basename(path)}", (const char *)text_{number}}},\n')
    with open(output, "w", encoding="utf-8") as file:
        file.write('#include "shader_compiler.h"\n\n' + "".join(arrays)
                   + "const girih_shader_include girih_shader_library[] = {\n" + "".join(entries)
                   + f"}};\nconst uint32_t girih_shader_library_count = {len(entries)};\n")


main()
