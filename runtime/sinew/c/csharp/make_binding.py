#!/usr/bin/env python3
"""Writes what is regular in the C# binding from the description of the C interface.

    make_binding.py abi sinew_abi.json > Abi.cs         # declarations, and methods that throw
    make_binding.py layout sinew_abi.json > Layout.cs   # a program that compares layouts with the runtime's and the library's"""
import os
import sys

sys.dont_write_bytecode = True  # this folder is not written to
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import abi as described
from abi import camel

CSHARP = {"int32_t": "int", "uint32_t": "uint", "uint64_t": "ulong", "uint8_t": "byte", "size_t": "UIntPtr", "float": "float",
          "double": "double", "void": "void", "char": "byte"}
NUMBERS = ("int32_t", "uint32_t", "uint64_t", "uint8_t", "float", "double")
KEYWORDS = ("byte", "event", "fixed", "object", "out", "params", "ref")


def name_of(thing):
    return "@" + thing["name"] if thing["name"] in KEYWORDS else thing["name"]


def documented(doc, indent):
    if doc:
        doc = doc.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
        yield f"{indent}/// <summary>{doc}</summary>"


def block(head, lines, indent="    "):
    yield f"{indent}{head} {{"
    for line in lines:
        yield f"{indent}    {line}" if line else ""
    yield f"{indent}}}"


class Binding:
    def __init__(self, abi):
        self.abi = abi

    def native(self, kind):
        """As P/Invoke passes it."""
        if kind == "void*":
            return "IntPtr"
        base = kind.removeprefix("const ").rstrip("*")
        if kind.endswith("*"):
            return self.native(base) + "*"
        return "ulong" if kind in self.abi.handles else CSHARP.get(kind) or camel(kind)

    def enum(self, name):
        values = [f"{camel(value.lower())} = {number}," for value, number in self.abi.enum_values(name).items()]
        yield from block(f"public enum {camel(name)} : int", values)

    def parameters(self, function):
        return ", ".join(f'{self.native(p["type"])} {name_of(p)}' for p in function["parameters"])

    def callback(self, name):
        callback = self.abi.callbacks[name]
        yield from documented(callback["doc"], "    ")
        yield "    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]"
        yield f'    public unsafe delegate {self.native(callback["result"])} {camel(name)}({self.parameters(callback)});'

    def fields(self, struct):
        for field in struct["fields"]:
            kind, name = field["type"], name_of(field)
            if kind in self.abi.callbacks:
                yield f"/// <summary>Marshal.GetFunctionPointerForDelegate of a {camel(kind)} that the caller keeps.</summary>"
                yield f"public IntPtr {name};"
            elif "count" not in field:
                yield f"public {'byte*' if kind == 'const char*' else self.native(kind)} {name};"
            elif kind in NUMBERS:
                yield f'public fixed {self.native(kind)} {name}[{field["count"]}];'
            else:  # no fixed array of structs
                yield from (f"public {self.native(kind)} {name}{n};" for n in range(field["count"]))

    def struct(self, name):
        struct, kind = self.abi.structs[name], camel(name)
        lines = list(self.fields(struct))
        if self.abi.initialiser(name):
            lines += ["", "/// <summary>The library's defaults.</summary>",
                      f"public static {kind} Default() {{",
                      f"    var settings = new {kind} {{ size = (uint)sizeof({kind}) }};",
                      f"    Error.Check(Native.{self.abi.initialiser(name)}(&settings));",
                      "    return settings;", "}"]
        for function, short in self.methods(name):
            lines += ["", *self.method(function, short)]
        yield from documented(struct["doc"], "    ")
        yield f'    [StructLayout(LayoutKind.Sequential, Size = {struct["size"]})]'
        yield from block(f"public unsafe struct {kind}", lines)

    def function(self, name):
        function = self.abi.functions[name]
        yield '[DllImport("sinew", CallingConvention = CallingConvention.Cdecl)]'
        yield f'public static extern {self.native(function["result"])} {name}({self.parameters(function)});'

    def methods(self, owner):
        for name, function in self.abi.functions.items():
            given, short = self.abi.owner(name)
            if given == owner and function["result"] == "sinew_status" and not self.abi.initialises(name):
                yield name, short

    def handle(self, name):
        kind, owned = camel(name), self.abi.owned(name)
        if owned:
            lines = ["public ulong Handle { get; private set; }",
                     f"internal {kind}(ulong handle) {{ Handle = handle; }}",
                     f"~{kind}() {{ Native.{name}_destroy(Handle); }}",
                     "/// <summary>Destroys it; every call is refused then.</summary>",
                     "public void Dispose() {",
                     f"    Error.Check(Native.{name}_destroy(Handle));",
                     "    Handle = 0;",
                     "    GC.SuppressFinalize(this);", "}"]
        else:
            lines = ["public readonly ulong Handle;", "public readonly World World;",
                     f"internal {kind}(World world, ulong handle) {{ World = world; Handle = handle; }}"]
        for function, short in self.methods(name):
            if not function.endswith("_destroy"):
                lines += ["", *self.method(function, short)]
        yield from block(f"public sealed unsafe partial class {kind}{' : IDisposable' if owned else ''}", lines)

    def parameter(self, one):
        """How an argument is declared, statements before the call, what is held in place during it, and what is passed."""
        name, kind = name_of({"name": one.name}), self.native(one.type)
        plain, length = one.name, f"{name}.Length" if one.length != "size_t" else f"(UIntPtr){name}.Length"
        element = "byte" if one.type == "void" else kind
        if one.role == "self":
            return (None, [], "", "Handle") if one.type in self.abi.handles else (None, [], f"{camel(one.type)}* self = &this", "self")
        if one.role == "handle":
            return f"{camel(one.type)} {name}", [], "", f"{name}.Handle"
        if one.role == "text":
            return f"string {name}", [], f"byte* {plain}_ = Error.Utf8({name})", f"{plain}_"
        if one.role == "array":
            return (f"{kind}[] {name}", [f'Error.Has({name}, {one.count}, "{plain}");'], f"{kind}* {plain}_ = {name}", f"{plain}_")
        if one.role == "struct":
            return (f"{kind}? {name}", [f"var {plain}_ = {name}.GetValueOrDefault();"], "",
                    f"{name}.HasValue ? &{plain}_ : null")
        if one.role == "edit":
            return f"ref {kind} {name}", [], f"{kind}* {plain}_ = &{name}", f"{plain}_"
        if one.role in ("read", "write", "fill"):
            before = [f"{self.native(one.filled)} filled;"] if one.role == "fill" else []
            after = ", &filled" if one.role == "fill" else ""
            if self.abi.structs.get(one.type, {}).get("alignment", 0) > 8 and one.role != "fill":
                none = one.role == "read"  # null: none, where the C function takes that
                pointer, count = (f"{name} == null ? {zero} : {name}.{part}" if none else f"{name}.{part}"
                                  for zero, part in (("null", "Pointer"), ("0", "Count")))
                return f"{kind}s {name}", before, "", f"{pointer}, {count}"
            passed = f"(IntPtr){plain}_" if one.type == "void" and one.role == "fill" else f"{plain}_"
            return f"{element}[] {name}", before, f"{element}* {plain}_ = {name}", f"{passed}, {length}{after}"
        if one.role == "out" and one.count:
            return None, [f"var {plain}_ = new {kind}[{one.count}];"], f"{kind}* {plain}_at = {plain}_", f"{plain}_at"
        if one.role == "out":
            value = f"new {kind} {{ size = (uint)sizeof({kind}) }}" if self.abi.sized(one.type) else f"default({kind})"
            return None, [f"var {plain}_ = {value};"], "", f"&{plain}_"
        if one.role == "callback":
            return f"{kind} {name}", [f"kept.Add({name});"], "", name
        return f"{kind} {name}", [], "", name  # value, pointer

    def results(self, arguments):
        for one in arguments:
            if one.role == "fill":
                yield "int", "(int)filled", "filled"
            elif one.role == "out" and one.type in self.abi.handles:
                world = "this, " if arguments[0].type == "sinew_world" else "World, "
                yield camel(one.type), f"new {camel(one.type)}({'' if self.abi.owned(one.type) else world}{one.name}_)", one.name
            elif one.role == "out":
                yield self.native(one.type) + ("[]" if one.count else ""), f"{one.name}_", one.name

    def method(self, name, short):
        arguments = self.abi.arguments(name)
        parts = [self.parameter(one) for one in arguments]
        results = list(self.results(arguments))
        returned = results.pop(0) if len(results) == 1 or any(one.role == "fill" for one in arguments) else ("void", "", "")
        declared = [part[0] for part in parts if part[0]] + [f"out {kind} {at}" for kind, _, at in results]
        static = "" if arguments[0].role == "self" else "static "
        yield from documented(self.abi.functions[name]["doc"], "")
        yield f'public {static}{returned[0]} {camel(short)}({", ".join(declared)}) {{'
        for part in parts:
            yield from (f"    {line}" for line in part[1])
        for part in parts:
            if part[2]:
                yield f"    fixed ({part[2]})"
        filled = ", (long)filled" if any(one.role == "fill" for one in arguments) else ""
        yield f'    Error.Check(Native.{name}({", ".join(part[3] for part in parts)}){filled});'
        if not static and arguments[0].type in self.abi.handles:
            yield "    GC.KeepAlive(this);"
        for one in arguments:
            if one.role == "handle":
                yield f"    GC.KeepAlive({one.name});"
        yield from (f"    {at} = {value};" for _, value, at in results)
        if returned[1]:
            yield f"    return {returned[1]};"
        yield "}"

    def lines(self):
        yield "// Written by make_binding.py from sinew_abi.json."
        yield "using System;"
        yield "using System.Runtime.InteropServices;"
        yield ""
        yield "namespace Sinew {"
        for things, write in ((self.abi.enums, self.enum), (self.abi.callbacks, self.callback), (self.abi.structs, self.struct),
                              (self.abi.handles, self.handle)):
            for name in things:
                yield from write(name)
                yield ""
        functions = [line for name, short in self.methods(None) for line in (*self.method(name, short), "")]
        yield from block("public static unsafe partial class Library", functions[:-1])
        yield ""
        natives = [line for name in self.abi.functions for line in self.function(name)]
        yield from block("static unsafe class Native", natives)
        yield "}"

    def layout(self):
        yield "// Written by make_binding.py from sinew_abi.json: offsets as the runtime has them, sizes that the library knows."
        yield "namespace Sinew {"
        yield from block("static unsafe class Layout", self.checks())
        yield "}"

    def checks(self):
        yield "static int wrong;"
        yield "static void Same(long is_, long described, string what) {"
        yield "    if (is_ == described) return;"
        yield "    ++wrong;"
        yield '    System.Console.Error.WriteLine("layout: " + what + " is " + is_ + ", described as " + described);'
        yield "}"
        for name, struct in self.abi.structs.items():
            kind = camel(name)
            yield f"static void Check{kind}() {{"
            yield f"    {kind}* two = stackalloc {kind}[2];"
            yield f'    Same(sizeof({kind}), {struct["size"]}, "size of {name}");'
            for field in struct["fields"]:
                array = "count" in field and field["type"] in NUMBERS
                at = f"two->{name_of(field)}" + ("0" if "count" in field and not array else "")
                yield f'    Same((byte*){at if array else "&" + at} - (byte*)two, {field["offset"]}, "{name}.{field["name"]}");'
            if self.abi.initialiser(name):
                for size, status in ((f"(uint)sizeof({kind})", "OK"), (f"(uint)sizeof({kind}) + 1", "BAD_VERSION")):
                    yield f"    two->size = {size};"
                    yield f'    Same((int)Native.{self.abi.initialiser(name)}(two), {self.abi.enums["sinew_status"]["SINEW_" + status]}, "{name}: status");'
            yield "}"
        yield "static int Main() {"
        for name in self.abi.structs:
            yield f"    Check{camel(name)}();"
        yield f'    System.Console.WriteLine("{len(self.abi.structs)} structs, " + wrong + " differences");'
        yield "    return wrong == 0 ? 0 : 1;"
        yield "}"


described.main({"abi": lambda abi: Binding(abi).lines(), "layout": lambda abi: Binding(abi).layout()}, __doc__)
