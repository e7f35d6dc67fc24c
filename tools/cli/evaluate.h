// `sinew evaluate`: kinematics and dynamics of a model at a state.
#pragma once

#include "convert/convert.h"

namespace sinew::cli {

/// `state` as documented in tools/README.md; all members optional. `fixed_base` drops the root's freedom.
convert::Error evaluate(const Skeleton& skeleton, const nlohmann::json& state, bool fixed_base,
                        nlohmann::json& out);

}  // namespace sinew::cli
