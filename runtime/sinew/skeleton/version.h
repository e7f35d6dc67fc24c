// Which Sinew this is. Semantic versioning: CHANGES.md beside the runtime's README says what each version
// changed.
#pragma once

// CMakeLists.txt reads these: the one place where they stand.
#define SINEW_VERSION_MAJOR 0
#define SINEW_VERSION_MINOR 2
#define SINEW_VERSION_PATCH 0

namespace sinew {

/// "0.2.0", of the library that is linked; the macros are those of the headers that were compiled with.
const char* version();

}  // namespace sinew
