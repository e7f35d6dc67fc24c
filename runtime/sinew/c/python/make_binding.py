#!/usr/bin/env python3
"""Writes the ctypes half of the Python package from the description of the C interface, or packs the package as a wheel.

    make_binding.py ctypes sinew_abi.json > sinew/_abi.py
    make_binding.py --wheel DIRECTORY VERSION > sinew.whl   # of DIRECTORY/sinew, with the shared library in it"""
import base64
import hashlib
import io
import os
import sys
import sysconfig
import zipfile

sys.dont_write_bytecode = True  # this folder is not written to
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import abi as described
from abi import SIZES, camel

CTYPES = {"int32_t": "c_int32", "uint32_t": "c_uint32", "uint64_t": "c_uint64", "uint8_t": "c_uint8", "size_t": "c_size_t",
          "float": "c_float", "double": "c_double"}


class Binding:
    def __init__(self, abi):
        self.abi = abi

    def ctype(self, kind):
        if kind == "void":
            return "None"
        if kind == "const char*":
            return "ctypes.c_char_p"
        if kind.endswith("*"):
            return "ctypes.c_void_p"  # takes arrays, addresses and byref() alike
        if kind in self.abi.handles:
            return "ctypes.c_uint64"
        if kind in self.abi.enums:
            return "ctypes.c_int32"
        if kind in self.abi.callbacks or kind in self.abi.structs:
            return camel(kind)
        return "ctypes." + CTYPES[kind]

    def enum(self, name, _values):
        yield f"class {camel(name)}(enum.IntEnum):"
        for value, number in self.abi.enum_values(name).items():
            yield f"    {value} = {number}"

    def callback(self, name, callback):
        types = [self.ctype(callback["result"])] + [self.ctype(p["type"]) for p in callback["parameters"]]
        yield f'{camel(name)} = ctypes.CFUNCTYPE({", ".join(types)})'

    def struct(self, name, struct):
        yield f"class {camel(name)}(ctypes.Structure):"
        yield f'    """{struct["doc"] or name}"""'
        yield "    _fields_ = ["
        for field in struct["fields"]:
            count = f' * {field["count"]}' if "count" in field else ""
            yield f'        ("{field["name"]}", {self.ctype(field["type"])}{count}),'
        last = struct["fields"][-1]
        if last["type"] in SIZES and struct["alignment"] > SIZES[last["type"]]:  # ctypes knows no alignment of its own
            end = last["offset"] + SIZES[last["type"]] * last.get("count", 1)
            if struct["size"] > end:
                yield f'        ("padding_", ctypes.c_char * {struct["size"] - end}),'
        yield "    ]"
        yield ""
        yield f'assert ctypes.sizeof({camel(name)}) == {struct["size"]}'
        for field in struct["fields"]:
            yield f'assert {camel(name)}.{field["name"]}.offset == {field["offset"]}'

    def function(self, name, function):
        types = ", ".join(self.ctype(p["type"]) for p in function["parameters"])
        yield f"    lib.{name}.argtypes = [{types}]"
        yield f'    lib.{name}.restype = {self.ctype(function["result"])}'

    def lines(self):
        yield '"""Written by make_binding.py from sinew_abi.json: what sinew.h declares, for ctypes."""'
        yield "import ctypes"
        yield "import enum"
        for things, write in ((self.abi.enums, self.enum), (self.abi.callbacks, self.callback), (self.abi.structs, self.struct)):
            for name, thing in things.items():
                yield ""
                yield ""
                yield from write(name, thing)
        yield ""
        yield ""
        yield "def load(path):"
        yield '    """The shared library, with the types of its functions."""'
        yield "    lib = ctypes.CDLL(path)"
        for name, function in self.abi.functions.items():
            yield from self.function(name, function)
        yield "    return lib"


def wheel(directory, version):
    """Bytes of a wheel; the same files give the same bytes."""
    out = io.BytesIO()
    info = f"sinew-{version}.dist-info"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    files = {}
    for name in sorted(os.listdir(os.path.join(directory, "sinew"))):
        if name.endswith(".py") or ".so" in name:
            with open(os.path.join(directory, "sinew", name), "rb") as file:
                files[f"sinew/{name}"] = file.read()
    files[f"{info}/METADATA"] = (f"Metadata-Version: 2.1\nName: sinew\nVersion: {version}\nSummary: Game characters that follow "
                                 "their clips and are simulated where their muscles do not suffice\n").encode()
    files[f"{info}/WHEEL"] = (f"Wheel-Version: 1.0\nGenerator: make_binding.py\nRoot-Is-Purelib: false\n"
                              f"Tag: py3-none-{platform}\n").encode()
    record = ""
    for name, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(data)}\n"
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(zipfile.ZipInfo(name, (2020, 1, 1, 0, 0, 0)), data, zipfile.ZIP_DEFLATED)
    return out.getvalue()


def main():
    if len(sys.argv) == 4 and sys.argv[1] == "--wheel":
        sys.stdout.buffer.write(wheel(sys.argv[2], sys.argv[3]))
        return
    described.main({"ctypes": lambda abi: Binding(abi).lines()}, __doc__)


main()
