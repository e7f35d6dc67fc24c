#include "sinew/effects/effect.h"

namespace sinew {

Status bodies_named(const Skeleton& skeleton, std::span<const std::string> names, std::vector<int>& out) {
  out.clear();
  for (std::size_t n = 0; n < names.size(); ++n) {
    const int body = skeleton.find(names[n].c_str());
    if (body < 0 || body >= skeleton.body_count)
      return Status::error(Code::kInvalidArgument, "effect on a joint that is not simulated",
                           static_cast<int>(n));
    out.push_back(body);
  }
  for (int body = 0; body < skeleton.body_count && names.empty(); ++body) out.push_back(body);
  return {};
}

}  // namespace sinew
