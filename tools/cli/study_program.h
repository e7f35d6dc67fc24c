// What `sinew` leaves to the program beside it, `sinew-study`: the evidence, and mechanisms of the reference
// family. Who converts and renders builds and links neither.
#pragma once

#include <nlohmann/json.hpp>

namespace sinew::cli {

/// `sinew study …`, and `sinew simulate` of a mechanism.
bool is_for_study_program(int argc, char** argv);

/// Becomes sinew-study, with the same arguments. Returns, with an exit code, only where that does not stand
/// beside this program.
int run_study_program(char** argv);

/// What that program's command line is (see describe()); null where it does not stand beside this one.
nlohmann::json describe_study_program();

}  // namespace sinew::cli
