#include "sinew/animation/socket.h"

namespace sinew {
namespace {

template <class T>
MovingTransform<T> at_rest(const Transform<T>& t) {
  return {{t.rotation}, still<T>(t.translation)};
}

/// How many hold each other below a thing; as many as there are: a circle.
std::size_t depth(std::span<const int> holders, int thing) {
  std::size_t steps = 0;
  for (int i = holders[std::size_t(thing)]; i >= 0 && steps < holders.size(); i = holders[std::size_t(i)])
    ++steps;
  return steps;
}

}  // namespace

template <class T>
MovingTransform<T> socket_motion(const Socket<T>& socket, std::span<const MovingTransform<T>> model) {
  return model[std::size_t(socket.joint)] * at_rest(socket.offset);
}
template <class T>
MovingTransform<T> socket_motion(const Socket<T>& socket, std::span<const JointJet<T>> jets,
                                 std::span<const int> parents, const MovingTransform<T>& root) {
  return root * (model_motion<T>(jets, parents, socket.joint) * at_rest(socket.offset));
}

template <class T>
MovingTransform<T> attached(const MovingTransform<T>& socket, const Transform<T>& handle) {
  return socket * at_rest(handle.inverse());
}

template <class T>
Release<T> release(const MovingTransform<T>& motion, const Vec3<T>& centre_of_mass) {
  const JointJet<T> jet = joint_jet(motion);
  const MovingVector<T> centre = motion * centre_of_mass;
  return {{jet.rotation, value_of<T>(centre)}, rate_of<T>(centre), jet.rotation * jet.omega};
}

Status attachment_order(std::span<const int> holders, std::span<int> order) {
  if (order.size() != holders.size())
    return Status::error(Code::kInvalidArgument, "order is not as long as the things");
  const int count = static_cast<int>(holders.size());
  for (int i = 0; i < count; ++i)
    if (holders[std::size_t(i)] < -1 || holders[std::size_t(i)] >= count)
      return Status::error(Code::kOutOfRange, "no such holder", i);
  for (int i = 0; i < count; ++i)
    if (depth(holders, i) == holders.size())
      return Status::error(Code::kInvalidArgument, "things hold each other in a circle", i);
  std::size_t placed = 0;
  for (std::size_t level = 0; placed < order.size(); ++level)
    for (int i = 0; i < count; ++i)
      if (depth(holders, i) == level) order[placed++] = i;
  return {};
}

SINEW_SOCKET_INSTANCES(template, float)
SINEW_SOCKET_INSTANCES(template, double)

}  // namespace sinew
