"""What all of the package is made of: the library, its errors, handles and structs. Internal to the package."""
import ctypes
import os
from ctypes import byref

from . import _abi
from ._abi import Status

try:
    import numpy
except ImportError:
    numpy = None

lib = _abi.load(os.environ.get("SINEW_LIBRARY") or os.path.join(os.path.dirname(os.path.abspath(__file__)), "libsinew.so"))


class Error(Exception):
    """What the library refused: `status`, `reason`, `index` of the joint or element that the reason is about (-1: none)."""

    def __init__(self, status):
        self.status = Status(status)
        self.reason = lib.sinew_last_reason().decode()
        self.index = lib.sinew_last_index()
        about = f" ({self.index})" if self.index >= 0 else ""
        super().__init__(f"{self.status.name}: {self.reason}{about}")


def check(status):
    """Raises what is not OK."""
    if status:
        raise Error(status)


def set_fields(struct, values):
    """Sets fields by name; arrays from sequences, nested structs from dictionaries."""
    fields = dict(struct._fields_)
    for name, value in values.items():
        if name not in fields or name == "size":
            raise TypeError(f"{type(struct).__name__} has no field {name}")
        field = getattr(struct, name)
        if isinstance(field, ctypes.Structure):
            set_fields(field, value)
        elif isinstance(field, ctypes.Array):
            if len(value) != len(field):
                raise TypeError(f"{type(struct).__name__}.{name} has {len(field)} numbers")
            field[:] = [float(x) for x in value]
        elif isinstance(value, Handle):
            setattr(struct, name, value.handle)
        else:
            setattr(struct, name, value)
    return struct


def settings_of(kind, init, values):
    struct = kind(size=ctypes.sizeof(kind))
    check(init(byref(struct)))
    return set_fields(struct, values)


def report_of(kind, get, handle):
    struct = kind(size=ctypes.sizeof(kind))
    check(get(handle, byref(struct)))
    return struct


def saved(save, *arguments):
    """Bytes of a save that tells how many they are."""
    size = ctypes.c_size_t()
    status = save(*arguments, None, 0, byref(size))
    if status != Status.TOO_SMALL:
        raise Error(status)
    out = ctypes.create_string_buffer(size.value)
    check(save(*arguments, out, len(out), byref(size)))
    return out.raw[:size.value]


def three(values):
    return (ctypes.c_double * 3)(*values)


def pointer(array):
    """Address of a numpy array's or a ctypes array's memory."""
    return array.ctypes.data if numpy is not None and isinstance(array, numpy.ndarray) else ctypes.addressof(array)


def jets_for(joints):
    """Room for one jet (local motion) of each joint, as Asset.sample and Character.set_target take it: numpy records, or a
    ctypes array."""
    if numpy is None:
        return (_abi.Jet * joints)()
    kind = numpy.dtype({"names": [f[0] for f in _abi.Jet._fields_ if f[0] != "padding_"],
                        "formats": [(numpy.float32, f[1]._length_) for f in _abi.Jet._fields_ if f[0] != "padding_"],
                        "offsets": [getattr(_abi.Jet, f[0]).offset for f in _abi.Jet._fields_ if f[0] != "padding_"],
                        "itemsize": ctypes.sizeof(_abi.Jet)})
    memory = numpy.zeros(joints * kind.itemsize + 16, numpy.uint8)
    first = -memory.ctypes.data % 16  # jets lie at a multiple of 16
    return memory[first:first + joints * kind.itemsize].view(kind)


class Native:
    """Owns a handle; views of its memory hold on to it, so that it outlives them."""

    def __init__(self, handle, destroy):
        self.handle, self.destroy = handle, destroy
        self.kept = []  # callbacks that the library may still call

    def __del__(self):
        self.destroy(self.handle)


class Handle:
    handle = 0


class Owned(Handle):
    """Something that is destroyed by close(), at the end of a with, or when nobody refers to it any more."""

    def __init__(self, handle, destroy):
        self._native = Native(handle, destroy)

    @property
    def handle(self):
        return self._native.handle if self._native else 0

    def close(self):
        self._native = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def floats(memory, rows, stride, columns):
    """Memory of floats as [rows, columns], without a copy."""
    if numpy is None:
        flat = memoryview(memory).cast("B").cast("f")
        return [flat[row * stride:row * stride + columns] for row in range(rows)] if columns > 1 else flat
    array = numpy.frombuffer(memory, numpy.float32).reshape(rows, stride)[:, :columns]
    return array if columns > 1 else array[:, 0]


class Described(Owned):
    """What has parts that are asked for by number or name."""

    def _element(self, kind, get, *index):
        struct = kind(size=ctypes.sizeof(kind))
        check(get(self.handle, *index, byref(struct)))
        return struct

    def _find(self, find, *what):
        out = ctypes.c_int32()
        check(find(self.handle, *what, byref(out)))
        return out.value


class InWorld(Handle):
    def __init__(self, world, handle):
        self.world, self.handle = world, handle

    def _call(self, function, *arguments):
        check(function(self.handle, *arguments))
