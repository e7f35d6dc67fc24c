#include "sinew/animation/look_chain.h"

#include <algorithm>

namespace sinew {

template <class T>
Status find_look_chain(const Skeleton& skeleton, LookChain<T>& out) {
  constexpr Role kRoles[] = {Role::kSpine, Role::kChest, Role::kNeck, Role::kHead};
  constexpr double kShares[] = {0.1, 0.2, 0.3, 0.4};
  const int head = skeleton.find(Role::kHead);
  if (head < 0) return Status::error(Code::kInvalidArgument, "no joint has the role of a head");
  LookChain<T> chain;
  double sum = 0;
  for (int k = 0; k < 4; ++k) {
    const int joint = skeleton.find(kRoles[k]);
    int above = head;
    while (above > joint) above = skeleton.joints[std::size_t(above)].parent;
    if (joint < 0 || above != joint) continue;
    chain.joints[chain.count] = joint;
    chain.shares[chain.count++] = T(kShares[k]);
    sum += kShares[k];
  }
  std::for_each(chain.shares, chain.shares + chain.count, [&](T& share) { share = T(share / sum); });
  const auto rest_of = [&](int joint) {
    Quat<double> rest = Quat<double>::Identity();
    for (int i = joint; i >= 0; i = skeleton.joints[std::size_t(i)].parent)
      rest = skeleton.joints[std::size_t(i)].rest.rotation * rest;
    return rest;
  };
  chain.base = skeleton.joints[std::size_t(chain.joints[0])].parent;
  const Quat<double> to_base = rest_of(chain.base).conjugate(), to_head = rest_of(head).conjugate();
  chain.forward = (to_base * Vec3<double>::UnitX()).template cast<T>();
  chain.up = (to_base * Vec3<double>::UnitZ()).template cast<T>();
  chain.axis = (to_head * Vec3<double>::UnitX()).template cast<T>();
  out = chain;
  return {};
}

template Status find_look_chain<float>(const Skeleton&, LookChain<float>&);
template Status find_look_chain<double>(const Skeleton&, LookChain<double>&);

}  // namespace sinew
