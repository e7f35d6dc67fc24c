#!/usr/bin/env python3
"""Writes what is regular in the Rust crate from the description of the C interface.

    make_binding.py sys sinew_abi.json > src/sys.rs   # declarations, and a test of every layout
    make_binding.py api sinew_abi.json > src/api.rs   # safe methods"""
import os
import sys

sys.dont_write_bytecode = True  # this folder is not written to
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import abi as described
from abi import camel

RUST = {"int32_t": "i32", "uint32_t": "u32", "uint64_t": "u64", "uint8_t": "u8", "size_t": "usize", "float": "f32", "double": "f64",
        "void": "c_void", "char": "c_char"}
ALIGNED = 8  # beyond, repr says so


def name_of(field):
    return {"type": "kind", "loop": "joined"}.get(field["name"], field["name"])  # keywords


def documented(doc, indent=""):
    if doc:
        yield f"{indent}/// {doc}"


class Binding:
    def __init__(self, abi):
        self.abi = abi

    def rust(self, kind):
        base = kind.removeprefix("const ").rstrip("*")
        if kind.endswith("*"):
            return ("*const " if kind.startswith("const ") else "*mut ") + self.rust(base)
        return f"Option<{camel(kind)}>" if kind in self.abi.callbacks else RUST.get(kind) or camel(kind)

    # sys.rs

    def enum(self, name):
        yield "#[repr(transparent)]"
        yield "#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]"
        yield f"pub struct {camel(name)}(pub i32);"
        yield f"impl {camel(name)} {{"
        for value, number in self.abi.enum_values(name).items():
            yield f"    pub const {value}: Self = Self({number});"
        yield "}"

    def callback(self, name):
        callback = self.abi.callbacks[name]
        parameters = ", ".join(f'{name_of(p)}: {self.rust(p["type"])}' for p in callback["parameters"])
        result = "" if callback["result"] == "void" else " -> " + self.rust(callback["result"])
        yield from documented(callback["doc"])
        yield f'pub type {camel(name)} = unsafe extern "C" fn({parameters}){result};'

    def hidden(self, field):
        """What safe code must not set: the library follows it."""
        return field["type"].endswith("*") or field["type"] in self.abi.callbacks or field["name"] == "size"

    def struct(self, name):
        struct = self.abi.structs[name]
        hidden = [field for field in struct["fields"] if self.hidden(field)]
        yield from documented(struct["doc"])
        yield f'#[repr(C, align({struct["alignment"]}))]' if struct["alignment"] > ALIGNED else "#[repr(C)]"
        yield f'#[derive(Clone, Copy, Debug{"" if hidden else ", Default"})]'
        yield f"pub struct {camel(name)} {{"
        for field in struct["fields"]:
            kind = self.rust(field["type"])
            kind = f'[{kind}; {field["count"]}]' if "count" in field else kind
            yield f'    {"" if self.hidden(field) else "pub "}{name_of(field)}: {kind},'
        yield "}"
        if hidden:
            yield f"impl {camel(name)} {{"
            yield from self.beginning(name)
            for field in hidden:
                yield from self.access(field)
            yield "}"
        if self.abi.initialiser(name):
            yield from self.default(name)
        elif hidden and not self.abi.sized(name):
            yield f"impl Default for {camel(name)} {{"
            yield "    /// Zeros, null pointers and no functions."
            yield "    fn default() -> Self {"
            yield "        Self::zeroed()"
            yield "    }"
            yield "}"

    def beginning(self, name):
        yield "    /// Zeros."
        yield "    pub(crate) fn zeroed() -> Self {"
        yield "        // SAFETY: numbers, null pointers and no functions."
        yield f'        let {"mut " if self.abi.sized(name) else ""}zeros: Self = unsafe {{ core::mem::zeroed() }};'
        if self.abi.sized(name):
            yield "        zeros.size = core::mem::size_of::<Self>() as u32;"
        yield "        zeros"
        yield "    }"

    def access(self, field):
        name, kind = name_of(field), self.rust(field["type"])
        if field["name"] == "size":
            return
        yield f"    pub fn {name}(&self) -> {kind} {{"
        yield f"        self.{name}"
        yield "    }"
        yield "    /// # Safety"
        yield "    /// It is good for what sinew.h says, for as long as that says, whatever the other fields are by then."
        yield f"    pub unsafe fn set_{name}(&mut self, value: {kind}) {{"
        yield f"        self.{name} = value;"
        yield "    }"

    def default(self, name):
        yield f"impl Default for {camel(name)} {{"
        yield "    /// The library's defaults."
        yield "    fn default() -> Self {"
        yield "        let mut settings = Self::zeroed();"
        yield "        // SAFETY: its size is what it says."
        yield f"        let status = unsafe {{ {self.abi.initialiser(name)}(&mut settings) }};"
        yield '        assert!(status == Status::OK, "a libsinew that is older than this crate");'
        yield "        settings"
        yield "    }"
        yield "}"

    def function(self, name):
        function = self.abi.functions[name]
        parameters = ", ".join(f'{name_of(p)}: {self.rust(p["type"])}' for p in function["parameters"])
        yield from documented(function["doc"], "    ")
        yield f'    pub fn {name}({parameters}) -> {self.rust(function["result"])};'

    def layout(self, name):
        struct = self.abi.structs[name]
        kind = camel(name)
        yield f'        assert_eq!((size_of::<{kind}>(), align_of::<{kind}>()), ({struct["size"]}, {struct["alignment"]}), "{name}");'
        yield f"        let one = MaybeUninit::<{kind}>::uninit();"
        for field in struct["fields"]:
            yield "        // SAFETY: an address within `one`; nothing is read."
            yield f"        let at = unsafe {{ addr_of!((*one.as_ptr()).{name_of(field)}) as usize }};"
            yield f'        assert_eq!(at - one.as_ptr() as usize, {field["offset"]}, "{name}.{field["name"]}");'
        if self.abi.initialiser(name):
            yield f"        assert_eq!(known::<{kind}>({self.abi.initialiser(name)}), (Status::OK, Status::BAD_VERSION), \"{name}\");"

    def sys(self):
        yield "//! Written by make_binding.py from sinew_abi.json: what sinew.h declares. Nothing here is checked by the compiler"
        yield "//! but the types."
        yield "use std::os::raw::{c_char, c_void};"
        yield ""
        for handle in self.abi.handles:
            yield f"pub type {camel(handle)} = u64;"
        for things, write in ((self.abi.enums, self.enum), (self.abi.callbacks, self.callback), (self.abi.structs, self.struct)):
            for name in things:
                yield ""
                yield from write(name)
        yield ""
        yield '#[link(name = "sinew")]'
        yield 'extern "C" {'
        for name in self.abi.functions:
            yield from self.function(name)
        yield "}"
        yield ""
        yield "#[cfg(test)]"
        yield "mod tests {"
        yield "    use super::*;"
        yield "    use core::mem::{align_of, size_of, MaybeUninit};"
        yield "    use core::ptr::addr_of;"
        yield ""
        yield "    /// What the library says to a struct of this size, and to one that is larger."
        yield '    fn known<T>(init: unsafe extern "C" fn(*mut T) -> Status) -> (Status, Status) {'
        yield "        let mut memory = [MaybeUninit::<T>::zeroed(), MaybeUninit::<T>::zeroed()];"
        yield "        let mut with = |size: usize| {"
        yield "            // SAFETY: there is room for two; each begins with its size."
        yield "            unsafe {"
        yield "                memory.as_mut_ptr().cast::<u32>().write(size as u32);"
        yield "                init(memory.as_mut_ptr().cast::<T>())"
        yield "            }"
        yield "        };"
        yield "        (with(size_of::<T>()), with(size_of::<T>() + 1))"
        yield "    }"
        for name in self.abi.structs:
            yield ""
            yield "    #[test]"
            yield f"    fn layout_of_{name}() {{"
            yield from self.layout(name)
            yield "    }"
        yield "}"

    # api.rs

    def handle(self, name):
        kind, owned = camel(name), self.abi.owned(name)
        yield f'/// {"Destroyed when it is dropped." if owned else "Goes with its world: calls are refused then."}'
        yield f'#[derive({"Debug" if owned else "Clone, Copy, Debug, PartialEq, Eq"})]'
        yield f"pub struct {kind} {{"
        yield f"    handle: sys::{kind},"
        yield "    here: OneThread,"
        yield "}"
        yield f"impl {kind} {{"
        yield f"    fn new(handle: sys::{kind}) -> Self {{"
        yield "        Self { handle, here: OneThread::default() }"
        yield "    }"
        yield "    /// The number that structs hold."
        yield f"    pub fn handle(&self) -> sys::{kind} {{"
        yield "        self.handle"
        yield "    }"
        yield "}"
        if owned:
            yield f"impl Drop for {kind} {{"
            yield "    fn drop(&mut self) {"
            yield "        // SAFETY: numbers are checked. What is refused has been broken before."
            yield f"        unsafe {{ sys::{name}_destroy(self.handle) }};"
            yield "    }"
            yield "}"

    def parameter(self, one):
        """How an argument is declared, what is done before the call, and what is passed."""
        name, kind = one.name, self.rust(one.type)
        out = f"[{kind}; {one.count}]" if one.count else kind
        element = "u8" if one.type == "void" else kind
        length = f"{name}.len()" if one.length == "size_t" else f"length({name}.len())?"
        mutable = "as_mut_ptr" if one.role in ("write", "fill") else "as_ptr"
        memory = f"{name}.{mutable}(){'.cast()' if one.type == 'void' else ''}, {length}"
        if one.role == "self":
            return ("&self", "", "self.handle") if one.type in self.abi.handles else ("&mut self", "", "self")
        if one.role == "handle":
            return f"{name}: &{kind}", "", f"{name}.handle"
        if one.role == "text":
            return f"{name}: &str", f"let {name} = text({name})?;", f"{name}.as_ptr()"
        if one.role == "array":
            return f"{name}: {out}", "", f"{name}.as_ptr()"
        if one.role == "struct":
            return f"{name}: Option<&{kind}>", "", f"{name}.map_or(core::ptr::null(), |s| s as *const _)"
        if one.role == "edit":
            return f"{name}: &mut {kind}", "", name
        if one.role in ("read", "write"):
            return f"{name}: &{'mut ' if one.role == 'write' else ''}[{element}]", "", memory
        if one.role == "fill":
            return f"{name}: &mut [{element}]", f"let mut filled: {RUST[one.filled]} = 0;", f"{memory}, &mut filled"
        if one.role == "out":
            value = f"sys::{kind}::zeroed()" if self.has_zeroed(one.type) else "Default::default()"
            kind = "u64" if one.type in self.abi.handles else out
            return None, f"let mut {name}: {kind} = {value};", f"{name}.as_mut_ptr()" if one.count else f"&mut {name}"
        return f"{name}: {kind}", "", name  # value, callback, pointer

    def has_zeroed(self, kind):
        return kind in self.abi.structs and any(self.hidden(field) for field in self.abi.structs[kind]["fields"])

    def results(self, arguments):
        for one in arguments:
            if one.role == "fill":
                yield "usize", "filled as usize"
            elif one.role == "out" and one.type in self.abi.handles:
                yield camel(one.type), f"{camel(one.type)}::new({one.name})"
            elif one.role == "out":
                yield (f"[{self.rust(one.type)}; {one.count}]" if one.count else self.rust(one.type)), one.name

    def method(self, name, short, indent):
        arguments = self.abi.arguments(name)
        parts = [self.parameter(one) for one in arguments]
        results = list(self.results(arguments))
        kinds = ", ".join(kind for kind, _ in results)
        values = ", ".join(value for _, value in results)
        if len(results) != 1:
            kinds, values = f"({kinds})", f"({values})"
        unsafe = any(one.role in ("callback", "pointer") for one in arguments)
        declared = ", ".join(part[0] for part in parts if part[0])
        yield from documented(self.abi.functions[name]["doc"], indent)
        if unsafe:
            yield f"{indent}///"
            yield f"{indent}/// # Safety"
            yield f"{indent}/// Functions and what they are given are good for as long as the library may call them."
        yield f'{indent}pub {"unsafe " if unsafe else ""}fn {short.removeprefix("get_")}({declared}) -> Result<{kinds}> {{'
        for _, before, _ in parts:
            if before:
                yield f"{indent}    {before}"
        call = f"sys::{name}({', '.join(part[2] for part in parts)})"
        yield f"{indent}    // SAFETY: memory is as long as it is said to be; handles and numbers are checked."
        yield f"{indent}    let status = unsafe {{ {call} }};"
        needed = ", filled as usize" if any(one.role == "fill" for one in arguments) else ", 0"
        yield f"{indent}    check(status{needed})?;"
        yield f"{indent}    Ok({values})"
        yield f"{indent}}}"

    def api(self):
        yield "// Written by make_binding.py from sinew_abi.json."
        yield "use std::os::raw::c_void;"
        yield ""
        yield "use crate::{check, length, sys, text, OneThread, Result};"
        names = [*self.abi.enums, *self.abi.callbacks, *self.abi.structs]
        yield f"pub use crate::sys::{{{', '.join(map(camel, names))}}};"
        by_owner = {}
        for name, function in self.abi.functions.items():
            if function["result"] == "sinew_status" and not self.abi.initialises(name) and not name.endswith("_destroy"):
                owner, short = self.abi.owner(name)
                by_owner.setdefault(owner, []).append((name, short))
        for handle in self.abi.handles:
            yield ""
            yield from self.handle(handle)
        for owner, functions in by_owner.items():
            yield ""
            if owner:
                yield f"impl {camel(owner)} {{"
            for name, short in functions:
                yield from self.method(name, short, "    " if owner else "")
            if owner:
                yield "}"


described.main({"sys": lambda abi: Binding(abi).sys(), "api": lambda abi: Binding(abi).api()}, __doc__)
