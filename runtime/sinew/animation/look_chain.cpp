#include "sinew/animation/look_chain.h"

namespace sinew {
namespace {

bool is_above(const Skeleton& skeleton, int upper, int joint) {
  while (joint > upper) joint = skeleton.joints[std::size_t(joint)].parent;
  return joint == upper;
}

}  // namespace

template <class T>
Status make_look_chain(const Skeleton& skeleton, std::span<const int> joints, std::span<const double> shares,
                       LookChain<T>& out) {
  if (joints.empty() || joints.size() > std::size_t(LookChain<T>::kMost) || shares.size() != joints.size())
    return Status::error(Code::kInvalidArgument, "no joints, more than eight, or not as many shares");
  LookChain<T> chain;
  double sum = 0;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    if (joints[k] < 0 || std::size_t(joints[k]) >= skeleton.joints.size())
      return Status::error(Code::kInvalidArgument, "no such joint", joints[k]);
    if (k > 0 && (joints[k] == joints[k - 1] || !is_above(skeleton, joints[k - 1], joints[k])))
      return Status::error(Code::kInvalidArgument, "joints are not one below the other", joints[k]);
    if (!(shares[k] > 0)) return Status::error(Code::kOutOfRange, "share is not above 0", joints[k]);
    sum += shares[k];
  }
  for (std::size_t k = 0; k < joints.size(); ++k) {
    chain.joints[chain.count] = joints[k];
    chain.shares[chain.count++] = T(shares[k] / sum);
  }
  const auto rest_of = [&](int joint) {
    Quat<double> rest = Quat<double>::Identity();
    for (int i = joint; i >= 0; i = skeleton.joints[std::size_t(i)].parent)
      rest = skeleton.joints[std::size_t(i)].rest.rotation * rest;
    return rest;
  };
  chain.base = skeleton.joints[std::size_t(chain.joints[0])].parent;
  const Quat<double> to_base = rest_of(chain.base).conjugate(),
                     to_head = rest_of(chain.joints[chain.count - 1]).conjugate();
  chain.forward = (to_base * Vec3<double>::UnitX()).template cast<T>();
  chain.up = (to_base * Vec3<double>::UnitZ()).template cast<T>();
  chain.axis = (to_head * Vec3<double>::UnitX()).template cast<T>();
  out = chain;
  return {};
}

template <class T>
Status find_look_chain(const Skeleton& skeleton, LookChain<T>& out) {
  constexpr Role kRoles[] = {Role::kSpine, Role::kChest, Role::kNeck, Role::kHead};
  constexpr double kShares[] = {0.1, 0.2, 0.3, 0.4};
  const int head = skeleton.find(Role::kHead);
  if (head < 0) return Status::error(Code::kInvalidArgument, "no joint has the role of a head");
  int joints[4];
  double shares[4];
  std::size_t count = 0;
  for (int k = 0; k < 4; ++k) {
    const int joint = skeleton.find(kRoles[k]);
    if (joint < 0 || !is_above(skeleton, joint, head)) continue;
    joints[count] = joint;
    shares[count++] = kShares[k];
  }
  return make_look_chain<T>(skeleton, {joints, count}, {shares, count}, out);
}

template Status make_look_chain<float>(const Skeleton&, std::span<const int>, std::span<const double>,
                                       LookChain<float>&);
template Status make_look_chain<double>(const Skeleton&, std::span<const int>, std::span<const double>,
                                        LookChain<double>&);
template Status find_look_chain<float>(const Skeleton&, LookChain<float>&);
template Status find_look_chain<double>(const Skeleton&, LookChain<double>&);

}  // namespace sinew
