#include "sinew/effects/support.h"

#include <algorithm>

namespace sinew {

template <class T>
SupportPoints<T>::SupportPoints(const Tree<T>& tree, std::span<const ContactPoint<T>> contacts)
    : first(tree.bodies + 1, 0), bound(tree.bodies, T(0)) {
  std::vector<ContactPoint<T>> standing;
  for (const ContactPoint<T>& contact : contacts)
    if (contact.body < tree.bodies && contact.meets_plane()) standing.push_back(contact);
  std::stable_sort(standing.begin(), standing.end(),
                   [](const auto& a, const auto& b) { return a.body < b.body; });
  for (const ContactPoint<T>& contact : standing) {
    points.push_back({contact.local, contact.radius});
    bound[contact.body] = std::max(bound[contact.body], contact.local.norm() + contact.radius);
    ++first[contact.body + 1];
  }
  for (int i = 0; i < tree.bodies; ++i) {
    first[i + 1] += first[i];
    int from = i;
    while (from > 0 && tree.parent[from] > 0) from = tree.parent[from];
    limb.push_back(from);
  }
}

template struct SupportPoints<float>;
template struct SupportPoints<double>;

}  // namespace sinew
