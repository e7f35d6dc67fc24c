#include "sinew/character/touch_digest.h"

#include "sinew/residual/tree_pass.h"

namespace sinew {
namespace {

constexpr double kTouch =
    5e-5;  ///< m of a human, or rad; shallower contacts bear half a percent of the weight: no impact

std::uint64_t mixed(std::uint64_t id) {
  id ^= id >> 31;
  id *= 0x9e3779b97f4a7c15ull;
  return id ^ (id >> 29);
}

}  // namespace

template <class T>
std::uint64_t touching(std::span<const Contact<T>> contacts, int tree) {
  std::uint64_t digest = 0;
  for (const Contact<T>& c : contacts)
    if ((c.tree_a == tree || c.tree_b == tree) && c.gap < T(-kTouch) * c.length_scale) digest ^= mixed(c.id);
  return digest;
}

template <class T>
std::uint64_t touching_soon(std::span<const Contact<T>> contacts, int tree,
                            std::span<CharacterState<T>* const> states, const Vec3<double>& gravity, T h) {
  std::uint64_t digest = 0;
  const auto speed = [&](int t, int body, const Vec3<T>& x) {
    return Vec3<T>(states[t]->point_velocity(body, x) + h * gravity.template cast<T>());
  };
  for (const Contact<T>& c : contacts) {
    if (c.tree_a != tree && c.tree_b != tree) continue;
    T gap = c.gap + h * c.normal.dot(speed(c.tree_a, c.body_a, c.point));
    if (c.tree_b >= 0) gap -= h * c.normal.dot(speed(c.tree_b, c.body_b, c.point));
    if (gap < T(-kTouch) * c.length_scale) digest ^= mixed(c.id);
  }
  return digest;
}

template <class T>
std::uint64_t bearing(const TreeProblem<T>& problem) {
  std::uint64_t digest = 0;
  for (const JointRow<T>& row : problem.rows)
    if (row.kind == RowKind::kOneSided &&
        row.value > T(kTouch) * (slides(*problem.tree, row.dof) ? problem.tree->scale.length : T(1)))
      digest ^= mixed(64 * std::uint64_t(row.dof) + 8 * std::uint64_t(row.scalar) +
                      2 * std::uint64_t(row.component) + (row.sign < T(0)));
  return digest;
}

SINEW_TOUCH_DIGEST_INSTANCES(template, float)
SINEW_TOUCH_DIGEST_INSTANCES(template, double)

}  // namespace sinew
