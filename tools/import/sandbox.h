// Runs a piece of work that may crash, loop or misbehave in a child process with next to no rights.
#pragma once

#include <functional>
#include <string>

#include "import/source_scene.h"

namespace sinew::import {

/// Forks; in the child sets rlimits (address space, processor time, stack, no core, no file growth),
/// no_new_privs and a seccomp allow-list (memory, reading descriptors that are already open, writing the
/// answer); runs `work` and sends its string back. Returns false with one clause in `error` when the work
/// threw (its message), was killed, ran out of memory, stack or time, or touched anything outside. Under
/// AddressSanitizer the memory limit and the allow-list are off.
bool run_sandboxed(const ReadLimits& limits, const std::function<std::string()>& work, std::string& answer,
                   std::string& error);

}  // namespace sinew::import
