// What follows a clip in ContactFinder: as deep as its clip presses it, and where its root is driven anyway.
#include <limits>

#include "sinew/character/contact_finder.h"

namespace sinew {
namespace {

constexpr double kDrivenInto = 5e-3;  ///< m of a human: so much deeper what muscles lead back may go
constexpr double kGivesWay = 0.02;    ///< m of a human, see give_way()
constexpr double kGivingSpeed = 0.1;  ///< m/s, see give_way()

template <class T>
bool lie_deeper(const PlacedCollider<T>& a, const PlacedCollider<T>& b, T depth) {
  const T far = a.radius + b.radius;
  return (a.pose.translation - b.pose.translation).squaredNorm() < far * far &&
         distance_between(a, b).distance < -depth;
}

}  // namespace

/// Which bodies of a tree follow a clip: all that moves them is driven. Where these shall be at the end of
/// the part is in `guessed` then.
template <class T>
void ContactFinder<T>::find_followers(CharacterState<T>& s) {
  first_body_.push_back(static_cast<int>(follows_.size()));
  const bool any = !s.is_prop && !s.passive() && s.settings.root != RootDrive::kFree;
  for (int i = 0; i < s.tree.bodies; ++i) {
    const int parent = s.tree.parent[i];
    const bool root = parent < 0 && s.tree.type[i] == JointType::kFree;
    const bool unknown = s.tree.dof_count(i) > 0 && s.problem.free[s.tree.first_dof[i]];
    Follows follows = parent < 0 ? Follows::kExactly : follows_[first_body_.back() + parent];
    if (!any || !(root || s.joint_is_driven(i))) follows = Follows::kNot;
    follows_.push_back(std::min(follows, unknown ? Follows::kRoughly : Follows::kExactly));
  }
  if (any) forward_kinematics<T>(s.tree, s.wanted, s.problem.common_origin, s.guessed);
}

/// A collider of tree n where its body is.
template <class T>
PlacedCollider<T> ContactFinder<T>::collider_at(int n, std::size_t c, const Kinematics<T>& k) const {
  const CharacterState<T>& s = *states_[n];
  const Collider& collider = s.colliders[c];
  const Transform<T> body{Quat<T>(k.rotation[collider.joint]), k.origin[collider.joint]};
  return {&collider, body * collider.local.template cast<T>(), s.bound_radius[c]};
}

/// Whether a driven root takes its own body further into an obstacle than clips press, at the end of the
/// part. Nothing keeps it out, and limbs that were would be torn off: all pass, until none is in it any more.
template <class T>
bool ContactFinder<T>::driven_through(int n, const Collider& obstacle) const {
  const CharacterState<T>& s = *states_[n];
  if (!s.drives_limbs()) return false;
  const PlacedCollider<T> other{&obstacle, pose_of(obstacle), T(bounding_radius(obstacle))};
  const T pressed = T(kPressedByClips) * s.tree.scale.length;
  for (std::size_t c = 0; c < s.colliders.size(); ++c) {
    const Bound& bound = bounds_[first_bound_[n] + static_cast<int>(c)];
    const T far = bound.radius + bound.reach + other.radius;
    if ((bound.center - other.pose.translation).squaredNorm() > far * far) continue;
    if ((s.colliders[c].joint == 0 && lie_deeper(collider_at(n, c, s.guessed), other, pressed)) ||
        lie_deeper(collider_at(n, c, s.problem.kinematics), other, 2 * pressed))
      return true;
  }
  return false;
}

/// The same of two trees whose roots are driven, the one into the other: figures, or one and a platform.
template <class T>
bool ContactFinder<T>::driven_through(int n, int m) const {
  const CharacterState<T>&s = *states_[n], &t = *states_[m];
  if (!s.root_is_kinematic() || !t.root_is_kinematic()) return false;
  if (!s.drives_limbs() && !t.drives_limbs()) return false;
  const T pressed = T(kPressedByClips) * std::min(s.tree.scale.length, t.tree.scale.length);
  for (std::size_t c = 0; c < s.colliders.size(); ++c)
    for (std::size_t o = 0; o < t.colliders.size(); ++o) {
      const Bound &a = bounds_[first_bound_[n] + static_cast<int>(c)],
                  &b = bounds_[first_bound_[m] + static_cast<int>(o)];
      const T far = a.radius + a.reach + b.radius + b.reach;
      if ((a.center - b.center).squaredNorm() > far * far) continue;
      const bool roots = s.colliders[c].joint == 0 && t.colliders[o].joint == 0;
      if ((roots && lie_deeper(collider_at(n, c, s.guessed), collider_at(m, o, t.guessed), pressed)) ||
          lie_deeper(collider_at(n, c, s.problem.kinematics), collider_at(m, o, t.problem.kinematics),
                     2 * pressed))
        return true;
    }
  return false;
}

/// m, that clips may press the two sides of a contact into each other.
template <class T>
T ContactFinder<T>::pressed_at_most(const Contact<T>& c) const {
  const CharacterState<T>&a = *states_[c.tree_a], *b = c.tree_b < 0 ? nullptr : states_[c.tree_b];
  const double planned = b ? std::min(a.grounding.presses, b->grounding.presses) : a.grounding.presses;
  if (c.plane && a.root_is_kinematic()) return T(std::min(planned, double(std::numeric_limits<T>::max())));
  const bool stands = !b || a.is_carrier() || b->is_carrier();
  const T most = T(stands ? kPressedByClips : kPressedIntoOthers) * c.length_scale;
  return T(std::min({planned, double(most), double(half_thickness(c) / 2)}));
}

/// What clips press a little may lie in each other; what they press deeper is kept out the more. And what no
/// unknown moves may go a little further: muscles lead that, with all their strength against a millimetre.
template <class T>
void ContactFinder<T>::allow_pressed(Contact<T>& c) const {
  Follows follows = follows_[first_body_[c.tree_a] + c.body_a];
  if (c.tree_b >= 0) follows = std::min(follows, follows_[first_body_[c.tree_b] + c.body_b]);
  if (follows == Follows::kNot) return;
  Contact<T> wanted = c;
  measure<T>(states_[c.tree_a]->guessed, c.tree_b < 0 ? nullptr : &states_[c.tree_b]->guessed, wanted);
  const T most = pressed_at_most(c);
  const T clip = std::max(-wanted.gap, T(0)), driven = follows == Follows::kExactly ? T(kDrivenInto) : T(0);
  const T allowed = clip > most ? std::max(2 * most - clip, T(0)) : clip;
  const T pressed = std::min(allowed + driven * c.length_scale, most);
  c.slack += pressed;
  c.gap += pressed;
  c.start_gap = c.gap;
}

/// What bears more than half the weight of a figure whose root is driven gives way slowly: the root has no
/// need of it, and muscles may press a limb against it that can't get back but through it. True while it
/// does.
template <class T>
bool ContactFinder<T>::give_way(Contact<T>& c) const {
  const CharacterState<T>& s = *states_[c.tree_a];
  if (c.tree_b >= 0 || !s.root_is_kinematic() || follows_[first_body_[c.tree_a] + c.body_a] == Follows::kNot)
    return false;
  const T weight = T(s.total_mass * world_->gravity.norm()), most = T(kGivesWay) * c.length_scale;
  if (!(2 * c.lagged_normal_force > weight) || c.offset >= most) return false;
  const T step = std::min(T(kGivingSpeed) * c.speed_scale * h_, most - c.offset);
  c.offset += step;
  c.gap += step;
  return true;
}

#define SINEW_CLIP_INSTANCES(T)                                                                           \
  template void ContactFinder<T>::find_followers(CharacterState<T>&);                                     \
  template PlacedCollider<T> ContactFinder<T>::collider_at(int, std::size_t, const Kinematics<T>&) const; \
  template bool ContactFinder<T>::driven_through(int, const Collider&) const;                             \
  template bool ContactFinder<T>::driven_through(int, int) const;                                         \
  template T ContactFinder<T>::pressed_at_most(const Contact<T>&) const;                                  \
  template void ContactFinder<T>::allow_pressed(Contact<T>&) const;                                       \
  template bool ContactFinder<T>::give_way(Contact<T>&) const;
SINEW_CLIP_INSTANCES(float)
SINEW_CLIP_INSTANCES(double)

}  // namespace sinew
