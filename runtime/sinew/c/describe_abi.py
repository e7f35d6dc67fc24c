#!/usr/bin/env python3
"""Describes the binary interface of sinew.h as JSON: enumerations, handles, callbacks, structs with their offsets, functions.

    describe_abi.py sinew.h > sinew_abi.json          # after a change of the header
    describe_abi.py sinew.h --check sinew_abi.json    # fails, and says how, where they differ
    describe_abi.py sinew_abi.json --asserts layout.c # a C file that compiles where the compiler says the same

The header keeps to the form that is read here, so that no parser of all of C is needed; what does not fit is an error. Layouts
are those of a 64-bit machine."""
import argparse
import difflib
import json
import os
import re
import sys

SCALARS = {"int32_t": 4, "uint32_t": 4, "uint64_t": 8, "size_t": 8, "float": 4, "double": 8, "uint8_t": 1}
POINTER = 8


def fail(words):
    sys.exit(f"describe_abi: {words}")


def with_parts(path):
    """Text of the header, with that of its parts in place of their includes. Directives in parts are their guards alone."""
    with open(path, encoding="utf-8") as file:
        text = file.read()

    def part(match):
        with open(os.path.join(os.path.dirname(path), match[1]), encoding="utf-8") as file:
            return re.sub(r"(?m)^#.*$", "", file.read())

    return re.sub(r'#include "sinew/c/(sinew_\w+\.h)"', part, text)


class Header:
    """What the header declares, in its order."""

    def __init__(self, text):
        self.aliases, self.enums, self.handles, self.callbacks, self.structs, self.functions = {}, {}, [], {}, {}, {}
        text = text[text.index("// ---- Errors"):text.rindex("#ifdef __cplusplus")]
        doc = []
        statement = ""
        for line in text.splitlines():
            stripped = line.strip()
            if stripped.startswith("///<") and statement:
                continue
            if stripped.startswith("///") and not statement:
                doc.append(stripped[3:].strip())
                continue
            code = re.sub(r"//.*", "", stripped).strip()
            if not code:
                if not stripped and not statement:
                    doc = []
                continue
            statement += (" " if statement else "") + code
            if statement.endswith(";") and statement.count("{") == statement.count("}"):
                self.read(re.sub(r"\s+", " ", statement[:-1]), " ".join(doc))
                statement = ""
                doc = []
        if statement:
            fail(f"unfinished: {statement[:80]}")

    def read(self, statement, doc):
        for pattern, take in ((r"typedef (int32_t|uint64_t) (sinew_\w+)", self.alias),
                              (r"enum (sinew_\w+)_values \{(.*)\}", self.enum),
                              (r"typedef (\w+\*?) \(\*(sinew_\w+)\)\((.*)\)", self.callback),
                              (r"typedef struct (sinew_\w+) \{(.*)\} \1", self.struct),
                              (r"SINEW_API (.*?)(sinew_\w+)\((.*)\)", self.function)):
            match = re.fullmatch(pattern, statement)
            if match:
                take(*match.groups(), doc)
                return
        fail(f"not in the header's form: {statement[:100]}")

    def alias(self, scalar, name, _doc):
        self.aliases[name] = scalar
        if scalar == "uint64_t":
            self.handles.append(name)

    def enum(self, name, body, _doc):
        values = re.findall(r"(SINEW_\w+) = (-?\d+)", body)
        if name not in self.aliases or len(values) != body.count("="):
            fail(f"enumeration {name}")
        self.enums[name] = {value: int(number) for value, number in values}

    def type_of(self, words):
        """A type as the description names it; refuses what it does not know."""
        words = words.strip()
        base = words.removeprefix("const ").rstrip("*").strip()
        if base not in SCALARS and base not in self.aliases and base not in self.structs and base not in self.callbacks \
                and base not in ("void", "char"):
            fail(f"unknown type {words}")
        return words.replace(" *", "*")

    def parameters(self, text):
        if text.strip() == "void":
            return []
        out = []
        for words in text.split(","):
            match = re.fullmatch(r"(.*?[ *])(\w+)(?:\[(\d+)\])?", words.strip())
            if not match:
                fail(f"parameter {words}")
            if match[3]:  # so many numbers; to C it is a pointer
                out.append({"name": match[2], "type": self.type_of(match[1]) + "*", "count": int(match[3])})
            else:
                out.append({"name": match[2], "type": self.type_of(match[1])})
        return out

    def callback(self, result, name, parameters, doc):
        self.callbacks[name] = {"result": self.type_of(result), "parameters": self.parameters(parameters), "doc": doc}

    def function(self, result, name, parameters, doc):
        self.functions[name] = {"result": self.type_of(result), "parameters": self.parameters(parameters), "doc": doc}

    def layout(self, kind):
        """Size and alignment."""
        if kind.endswith("*") or kind in self.callbacks:
            return POINTER, POINTER
        if kind in self.structs:
            return self.structs[kind]["size"], self.structs[kind]["alignment"]
        size = SCALARS[self.aliases.get(kind, kind)]
        return size, size

    def struct(self, name, body, doc):
        fields, at, most = [], 0, 1
        for words in filter(None, (w.strip() for w in body.split(";"))):
            match = re.fullmatch(r"(?:SINEW_ALIGNED\((\d+)\) )?(.*?[ *])(\w+)(?:\[(\d+)\])?", words)
            if not match:
                fail(f"{name}: field {words}")
            kind = self.type_of(match[2])
            size, alignment = self.layout(kind)
            alignment = max(alignment, int(match[1] or 1))
            at = -(-at // alignment) * alignment
            field = {"name": match[3], "type": kind, "offset": at}
            if match[4]:
                field["count"] = int(match[4])
            fields.append(field)
            at += size * int(match[4] or 1)
            most = max(most, alignment)
        self.structs[name] = {"size": -(-at // most) * most, "alignment": most, "fields": fields, "doc": doc}

    def describe(self):
        return {"handles": self.handles, "enums": self.enums, "callbacks": self.callbacks, "structs": self.structs,
                "functions": self.functions}


def as_json(abi):
    """One line for each thing described, so that a change of one is a change of a line."""
    sections = []
    for section, things in abi.items():
        if isinstance(things, list):
            sections.append(f' {json.dumps(section)}: {json.dumps(things)}')
        else:
            lines = ",\n".join(f"  {json.dumps(name)}: {json.dumps(thing)}" for name, thing in things.items())
            sections.append(f" {json.dumps(section)}: {{\n{lines}\n }}")
    return "{\n" + ",\n".join(sections) + "\n}\n"


def asserts(abi):
    lines = ["/* Written by describe_abi.py. */", '#include "sinew/c/sinew.h"']
    for name, struct in abi["structs"].items():
        lines.append(f'_Static_assert(sizeof({name}) == {struct["size"]}, "size of {name}");')
        lines.append(f'_Static_assert(_Alignof({name}) == {struct["alignment"]}, "alignment of {name}");')
        for field in struct["fields"]:
            lines.append(f'_Static_assert(offsetof({name}, {field["name"]}) == {field["offset"]}, '
                         f'"{name}.{field["name"]}");')
            size = f'sizeof((({name}*)0)->{field["name"]})'
            lines.append(f'_Static_assert({size} == {field.get("count", 1)} * sizeof({field["type"]}), '
                         f'"{name}.{field["name"]}");')
    for values in abi["enums"].values():
        lines += [f'_Static_assert({name} == {number}, "{name}");' for name, number in values.items()]
    for name, function in abi["functions"].items():  # a pointer of another type does not compile
        types = ", ".join(p["type"] for p in function["parameters"]) or "void"
        lines.append(f'{function["result"]} (*const check_{name})({types}) = {name};')
    return "\n".join(lines) + "\n"


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("source", help="sinew.h, or the description itself")
    arguments.add_argument("--check", metavar="JSON")
    arguments.add_argument("--asserts", metavar="C")
    given = arguments.parse_args()
    if given.source.endswith(".json"):
        with open(given.source, encoding="utf-8") as file:
            abi = json.load(file)
    else:
        abi = Header(with_parts(given.source)).describe()
    if given.asserts:
        with open(given.asserts, "w", encoding="utf-8") as file:
            file.write(asserts(abi))
        return
    text = as_json(abi)
    if not given.check:
        sys.stdout.write(text)
        return
    with open(given.check, encoding="utf-8") as file:
        committed = file.read()
    if committed != text:
        sys.stdout.writelines(difflib.unified_diff(committed.splitlines(True), text.splitlines(True), "committed", "header"))
        fail(f"{given.check} is not what the header says: describe_abi.py {given.source} > {given.check}")


main()
