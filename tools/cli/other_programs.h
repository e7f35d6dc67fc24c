// What `sinew` leaves to programs beside it: `sinew-render` draws, `sinew-study` holds the evidence and the
// mechanisms of the reference family. Who converts loads neither, nor what they link.
#pragma once

#include <nlohmann/json.hpp>

namespace sinew::cli {

/// The program that a command line is for: `sinew render …`; `sinew study …` and `sinew simulate` of a
/// mechanism. Null where it is this one.
const char* program_for(int argc, char** argv);

/// Becomes that program, with the same arguments. Returns, with an exit code, only where it does not stand
/// beside this one.
int become(const char* program, char** argv);

/// What the command lines of all of them are (see describe()), of those that stand beside this one.
std::vector<nlohmann::json> describe_other_programs();

}  // namespace sinew::cli
