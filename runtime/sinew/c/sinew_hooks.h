/// @file
/// What a host gives the whole library, and hears of it. Part of sinew.h.
///
/// Set hooks before anything else, or while no other call runs: they are read without a lock. What they call
/// must not call Sinew.
#ifndef SINEW_C_SINEW_HOOKS_H
#define SINEW_C_SINEW_HOOKS_H

#ifndef SINEW_C_SINEW_H
#error "include sinew/c/sinew.h"
#endif

/// Memory of so many bytes (at least 1) at a multiple of `alignment`, a power of two; null where there is
/// none. Called by set-up, recordings and loading, on any thread; never by a step.
typedef void* (*sinew_allocate)(void* context, size_t bytes, size_t alignment);
/// Takes back what sinew_allocate gave.
typedef void (*sinew_release)(void* context, void* memory);
/// Every byte that the library takes from the heap comes from `allocate` from now on; both null: from malloc.
/// Files that are loaded are mapped meanwhile, by the system. SINEW_INVALID_ARGUMENT while the library has
/// memory, as a living asset or world; SINEW_UNSUPPORTED where the C++ library is not within it
/// (BUILD_SHARED_LIBS, sanitizers, WebAssembly): operator new of the program serves then.
SINEW_API sinew_status sinew_set_memory(sinew_allocate allocate, sinew_release release, void* context);
/// Blocks that the library has now; 0 where sinew_set_memory is not supported.
SINEW_API size_t sinew_memory_blocks(void);

/// How bad it is.
typedef int32_t sinew_log_level;
/// Values of sinew_log_level.
enum sinew_log_level_values {
  SINEW_LOG_INFO = 0,     ///< a result is less exact than it should be
  SINEW_LOG_WARNING = 1,  ///< something was given up: a contact left out, a body stopped
  SINEW_LOG_ERROR = 2     ///< a call was refused; sinew_last_reason() says the same
};
/// `words` live for ever; `index` of the character, prop or element that they are about, -1 if none.
typedef void (*sinew_log)(void* context, sinew_log_level level, const char* words, int32_t index);
/// Who hears of every call that is refused, on its thread, and of what steps could not do, at their end;
/// null: nobody.
SINEW_API sinew_status sinew_set_log(sinew_log log, void* context);

/// An assumption of the library's own that does not hold: its text and place. Where it returns, the call goes
/// on.
typedef void (*sinew_assertion)(void* context, const char* condition, const char* file, int32_t line);
/// Null: written to stderr, and the program aborts. SINEW_UNSUPPORTED where the library does not check them
/// (it does when built with SINEW_ASSERTS).
SINEW_API sinew_status sinew_set_assertion(sinew_assertion failed, void* context);

/// A part of a step begins, or ends: nested, each on one thread. `zone`: its name, which lives for ever.
typedef void (*sinew_zone)(void* context, const char* zone);
/// Both or none. SINEW_UNSUPPORTED where the library was built without SINEW_PROFILER.
SINEW_API sinew_status sinew_set_profiler(sinew_zone begin, sinew_zone end, void* context);

#endif
