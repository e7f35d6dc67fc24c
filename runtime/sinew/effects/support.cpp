#include "sinew/effects/support.h"

#include <algorithm>

#include "sinew/effects/check_pass.h"

namespace sinew {

template <class T>
SupportPoints<T>::SupportPoints(const Tree<T>& tree, std::span<const ContactPoint<T>> contacts)
    : first(tree.bodies + 1, 0), unit(tree.scale.length), bound(tree.bodies, T(0)) {
  const auto stands = [&](const ContactPoint<T>& c) { return c.body < tree.bodies && c.meets_plane(); };
  for (const ContactPoint<T>& contact : contacts)
    if (stands(contact)) ++first[contact.body + 1];
  for (int i = 0; i < tree.bodies; ++i) {
    first[i + 1] += first[i];
    int from = i;
    while (from > 0 && tree.parent[from] > 0) from = tree.parent[from];
    limb.push_back(from);
  }
  points.resize(first.back());
  std::vector<int> next = first;
  for (const ContactPoint<T>& contact : contacts) {
    if (!stands(contact)) continue;
    points[next[contact.body]++] = {contact.local, contact.radius};
    bound[contact.body] = std::max(bound[contact.body], contact.local.norm() + contact.radius);
  }
}

template struct SupportPoints<float>;
template struct SupportPoints<double>;

namespace {

template <class T>
SupportPoints<T> points_of(const Tree<T>& tree, std::span<const ContactPoint<T>> contacts) {
  return {tree, contacts};
}

template <class T>
constexpr SupportTerm<T> kSupport{points_of<T>, stand<T>};

}  // namespace

template <class T>
void Support<T>::declare(StepPlan<T>& plan) {
  plan.support = &kSupport<T>;
}

template struct Support<float>;
template struct Support<double>;

}  // namespace sinew
