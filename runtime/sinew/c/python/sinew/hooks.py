"""What a program hears of the whole library."""
from . import _abi
from ._core import check, lib

_kept = None  # the library may still call it


def set_log(heard):
    """heard(level, words, index) of every call that is refused, and of what steps could not do; None: nobody."""
    global _kept
    said = _abi.Log((lambda _, level, words, index: heard(_abi.LogLevel(level), words.decode(), index)) if heard else 0)
    check(lib.sinew_set_log(said, None))
    _kept = said
