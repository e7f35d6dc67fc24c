// Runs a piece of work that may crash, loop or misbehave in a child process with next to no rights.
#pragma once

#include <functional>
#include <string>

#include "import/source_scene.h"

namespace sinew::import {

/// Descriptor of a further file that the work asks for by name (the caller closes it), or -1: refused.
using OpenFile = std::function<int(const std::string& name)>;

/// What runs in the child: gets a way to ask for further files, returns its answer, throws on bad input.
using Work = std::function<std::string(const OpenFile& open_file)>;

/// Forks; in the child closes every inherited descriptor, sets rlimits (address space, processor time, stack,
/// no core, no file growth), no_new_privs and a seccomp allow-list (memory, reading what is open, writing the
/// answer); runs `work` and sends its string back. Files that the work asks for are opened by `broker`, here
/// in the parent, which alone decides what may be read. Returns false with one clause in `error` when the
/// work threw (its message), was killed, ran out of memory, stack or time, or touched anything outside. Under
/// AddressSanitizer, which needs both, the memory limit and the allow-list are off.
bool run_sandboxed(const ReadLimits& limits, const OpenFile& broker, const Work& work, std::string& answer,
                   std::string& error);

}  // namespace sinew::import
