"""What the makers of bindings share: sinew_abi.json, and how its functions and names read in a language with objects."""
import json
import os
import sys
from dataclasses import dataclass

SIZES = {"int32_t": 4, "uint32_t": 4, "uint64_t": 8, "uint8_t": 1, "size_t": 8, "float": 4, "double": 8}


def camel(name):
    """sinew_world_settings → WorldSettings"""
    return "".join(part.capitalize() for part in name.removeprefix("sinew_").split("_"))


@dataclass
class Argument:
    """An argument as a caller means it, which may be two or three of the C function's.

    role: self, handle, value, callback, pointer; text; array (`count` numbers that are read); struct (that is read, may be left
    out); edit (a struct that is read and changed); read, write (memory that the caller has, with its length); fill (the same,
    and how much of it was written is a result); out (a result: a number, a struct, a handle, or `count` numbers)."""
    role: str
    name: str
    type: str
    count: int = 0
    length: str = ""  # type of the argument that follows and tells the length
    filled: str = ""  # type of the argument that tells how much was written


class Abi:
    def __init__(self, description):
        self.handles, self.enums = description["handles"], description["enums"]
        self.callbacks, self.structs = description["callbacks"], description["structs"]
        self.functions = description["functions"]

    def enum_values(self, name):
        """Short names of an enumeration's values: SINEW_ROLE_HEAD → HEAD."""
        prefix = os.path.commonprefix(list(self.enums[name]))
        prefix = prefix[:prefix.rindex("_") + 1]
        return {value.removeprefix(prefix): number for value, number in self.enums[name].items()}

    def sized(self, kind):
        """Whether a struct begins with its own size."""
        return kind in self.structs and self.structs[kind]["fields"][0]["name"] == "size"

    def initialiser(self, kind):
        """The function that fills a struct with defaults, or None."""
        return f"{kind}_init" if f"{kind}_init" in self.functions else None

    def initialises(self, name):
        """The struct that a function fills with defaults, or None."""
        kind = name.removesuffix("_init")
        return kind if name != kind and kind in self.structs else None

    def owner(self, name):
        """What a function is a method of (a handle, a struct of settings, None), and the method's name: without the owner's."""
        function = self.functions[name]
        first = function["parameters"][0]["type"] if function["parameters"] else ""
        for owner in list(self.handles) + list(self.structs):
            creates = first not in self.handles and any(p["type"] == owner + "*" for p in function["parameters"])
            if first == owner or creates and name.startswith(owner + "_"):
                return owner, name.removeprefix("sinew_").removeprefix(owner.removeprefix("sinew_") + "_")
        return None, name.removeprefix("sinew_")

    def owned(self, handle):
        """Whether it is destroyed by who has it; the others go with their world."""
        return handle + "_destroy" in self.functions

    def arguments(self, name):
        """The arguments of a function that returns a status."""
        parameters, out, n = self.functions[name]["parameters"], [], 0
        owner, _ = self.owner(name)
        while n < len(parameters):
            one = parameters[n]
            after = parameters[n + 1] if n + 1 < len(parameters) else {"name": "", "type": ""}
            argument = self.argument(one, after, parameters[n + 2] if n + 2 < len(parameters) else None)
            if n == 0 and owner and one["type"] in (owner, owner + "*") and argument.role != "out":
                argument.role = "self"
            out.append(argument)
            n += 1 + bool(argument.length) + bool(argument.filled)
        return out

    def argument(self, one, after, last):
        name, kind = one["name"], one["type"]
        base = kind.removeprefix("const ").rstrip("*")
        if kind == "const char*":
            return Argument("text", name, base)
        if kind.endswith("*"):
            if (after["name"] in ("count", "size", "capacity") or after["name"].endswith("_count")) and not after["type"].endswith("*"):
                if after["name"] == "capacity":
                    return Argument("fill", name, base, length=after["type"], filled=last["type"].rstrip("*"))
                return Argument("read" if kind.startswith("const") else "write", name, base, length=after["type"])
            if kind.startswith("const"):
                return Argument("array" if "count" in one else "struct", name, base, one.get("count", 0))
            if base == "void":
                return Argument("pointer", name, kind)
            if name in ("settings", "query", "state"):
                return Argument("edit", name, base)
            return Argument("out", name, base, one.get("count", 0))
        if kind in self.callbacks:
            return Argument("callback", name, kind)
        return Argument("handle" if kind in self.handles else "value", name, kind)


def main(parts, usage):
    """The command line of a maker of bindings: WHAT sinew_abi.json. `parts`: lines of an Abi, by WHAT."""
    if len(sys.argv) != 3 or sys.argv[1] not in parts:
        sys.exit(usage)
    with open(sys.argv[2], encoding="utf-8") as file:
        print("\n".join(parts[sys.argv[1]](Abi(json.load(file)))))
