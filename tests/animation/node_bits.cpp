#include "animation/node_bits.h"

#include <cstddef>
#include <cstring>

#include "animation/motion_nodes.h"

namespace sinew {

template <class T>
std::vector<unsigned char> node_bits(int node) {
  fixtures::NodeCase<T> c = std::move(fixtures::motion_nodes<T>()[node]);
  std::vector<JointJet<T>> out(c.node->joints);
  std::vector<unsigned char> bytes;
  for (int n = 0; n < 100; ++n) {
    fixtures::run_node<T>(c, {}, 0.039 * n, out);
    for (const JointJet<T>& jet : out) {
      const T* numbers = jet.rotation.coeffs().data();
      constexpr std::size_t kBytes = 19 * sizeof(T);  // without what pads a jet
      static_assert(offsetof(JointJet<T>, acceleration) + 3 * sizeof(T) == kBytes);
      const std::size_t end = bytes.size();
      bytes.resize(end + kBytes);
      std::memcpy(bytes.data() + end, numbers, kBytes);
    }
  }
  return bytes;
}
template std::vector<unsigned char> node_bits<float>(int);
template std::vector<unsigned char> node_bits<double>(int);

}  // namespace sinew
