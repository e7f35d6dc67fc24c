// How contacts begin a step: with what they bore in the last one, inside of something, or about to strike.
#include <algorithm>
#include <cmath>
#include <utility>

#include "sinew/character/contact_finder.h"
#include "sinew/character/contacts.h"

namespace sinew {
namespace {

constexpr double kDepenetrationSpeed = 0.45;  ///< m/s, of what begins inside something or was pressed into it
constexpr double kMostStored =
    2;  ///< times what takes a tree along: a step uses but a part of what surfaces store
/// m, that a contact is deeper in than its force says: it leaves by another face than before, or is what was
/// crushed and goes back. No spring has stored that, it comes out as what began inside does.
constexpr double kLeaps = 0.02;
constexpr double kSoftens = 0.03;  ///< m, of what began inside: impacts press in less
constexpr double kMayReach = 2;    ///< times the way that it goes in the step: what it may come to

/// Makes a contact stiffer, not softer. Its offset takes up the difference in depth, so that under load it
/// keeps its force: this gives no energy.
template <class T>
void stiffen(Contact<T>& c, T stiffness) {
  if (!(stiffness > c.stiffness)) return;
  if (c.gap < T(0)) {
    const T force = ContactLaw<T>::force(c.stiffness, c.gap, c.width());
    const T gap = -ContactLaw<T>::depth(stiffness, force, c.width());
    c.offset += gap - c.gap;
    c.gap = gap;
  }
  c.stiffness = stiffness;
}

/// What begins inside something (spawned there, or played there by an animation) is not shot out of it: the
/// surface is where the feature is, and comes back at a walking pace.
template <class T>
void begin_inside(Contact<T>& c) {
  if (c.gap >= T(-kLeftInside) * c.length_scale) return;
  c.offset -= c.gap;
  c.gap = T(0);
}

}  // namespace

/// What contacts that were not there before begin with, and how all are damped.
template <class T>
void ContactFinder<T>::begin_all() {
  std::erase_if(contacts_, [&](const Contact<T>& c) {
    return c.fresh && c.meeting == Meeting::kEdges && is_internal(c);
  });
  for (Contact<T>& c : contacts_) {
    if (c.face >= 0 && c.distance() < T(0) && is_internal(c)) {  // no way out of what they make up together
      c.face = -1;
      begin_step<T>(states_[c.tree_a]->problem.kinematics,
                    c.tree_b < 0 ? nullptr : &states_[c.tree_b]->problem.kinematics, c);
    }
    if (c.fresh) {
      begin_inside(c);
      stiffen_for_impact(c);
    }
    c.start_gap = c.gap;
    // Far inside it is damped the more, so that what was crushed comes out of it at a walking pace too.
    if (c.offset <= T(kLeftInside) * c.length_scale || c.came_back > T(0))
      c.damp(std::max(damping_time_ * c.speed_scale, -c.gap / (T(kDepenetrationSpeed) * c.speed_scale)), h_);
  }
}

/// Whether both sides of a contact are of one piece: no muscles press limbs against each other meanwhile.
template <class T>
bool ContactFinder<T>::may_soften(const Contact<T>& c) const {
  return states_[c.tree_a]->tree.bodies == 1 && (c.tree_b < 0 || states_[c.tree_b]->tree.bodies == 1) &&
         c.offset > T(kSoftens) * c.length_scale;
}

/// Brings the surface back to where it belongs at a walking pace, as softly as that takes; all that do so to
/// a tree store no more together than takes it along, the lighter of two. In what is wedged they would store
/// ever more.
template <class T>
void ContactFinder<T>::depenetrate(Contact<T>& c) const {
  const double speed = kDepenetrationSpeed * double(c.speed_scale);
  T back = std::min(T(speed) * h_, c.offset - T(kLeftInside) * c.length_scale);
  if (!(back > T(0))) return;  // as a rule: nothing is inside
  const auto share = [&](int n) { return T(states_[n]->total_mass) / T(std::max(depenetrating_[n], 1)); };
  const T mass = c.tree_b < 0 ? share(c.tree_a) : std::min(share(c.tree_a), share(c.tree_b));
  const double work = speed / 2 + world_->gravity.norm() * double(h_);  // by mass and speed
  const T enough = mass * T(kMostStored * speed * work), stored = stored_energy(c);
  if (may_soften(c)) {
    back = soften(c, back, enough);
    c.came_back = back;
  } else {
    back =
        std::max(std::min(back, ContactLaw<T>::depth_storing(c.stiffness, enough, c.width()) + c.gap), T(0));
  }
  c.offset -= back;
  c.gap -= back;
  c.depenetration_work = stored_energy(c) - stored;
}

/// Makes a contact as soft as it has to be, under the same force, for its surface to come back so far (m)
/// while what it touches goes on as it does, and store no more than `most` (J). How far it may.
template <class T>
T ContactFinder<T>::soften(Contact<T>& c, T back, T most) const {
  const T force = ContactLaw<T>::force(c.stiffness, c.gap, c.width());
  T ahead = std::max(back - h_ * parting_speed(c), T(0));  // of what it touches, at the end
  if (2 * force * ahead > most) {
    back -= ahead - most / (2 * force);
    ahead = most / (2 * force);
  }
  if (!(back > T(0)) || !(ahead > T(0))) return std::max(back, T(0));
  // (force + k ahead)² = 2 k most
  const T left = most - force * ahead,
          soft = (left + std::sqrt(std::max(left * left - force * force * ahead * ahead, T(0)))) /
                 (ahead * ahead);
  if (!(soft < c.stiffness)) return back;
  const T gap = -ContactLaw<T>::depth(soft, force, c.width());
  c.offset += gap - c.gap;
  c.gap = gap;
  c.stiffness = soft;
  return std::min(back, std::max(c.offset - T(kLeftInside) * c.length_scale, T(0)));
}

/// m/s, at which the two sides of a contact part where the step begins.
template <class T>
T ContactFinder<T>::parting_speed(const Contact<T>& c) const {
  Vec3<T> parting = states_[c.tree_a]->point_velocity(c.body_a, c.point);
  if (c.tree_b >= 0) parting -= states_[c.tree_b]->point_velocity(c.body_b, c.point);
  return parting.dot(c.normal);
}

/// How many contacts bring each tree out of something.
template <class T>
void ContactFinder<T>::count_depenetrating() {
  depenetrating_.assign(states_.size(), 0);
  for (const LaggedForce<T>& f : lagged_) {
    if (!(f.offset > T(0))) continue;
    for (std::size_t n = 0; n < states_.size(); ++n)
      depenetrating_[n] +=
          is_of_tree(f.id, indices_[n]) && f.offset > T(kLeftInside) * states_[n]->tree.scale.length;
  }
}

/// Normal force and stiffness of the step before. A contact under load never softens.
template <class T>
void ContactFinder<T>::remember(Contact<T>& c) const {
  const auto found = std::lower_bound(lagged_.begin(), lagged_.end(), c.id,
                                      [](const LaggedForce<T>& f, std::uint64_t id) { return f.id < id; });
  if (found == lagged_.end() || found->id != c.id) return;
  c.fresh = false;
  c.lagged_normal_force = found->force;
  c.lasting_last = found->lasting;
  c.lasting_before = found->before;
  c.smooth_before = found->smooth;
  for (int k = 0; k < 2; ++k)
    c.elastic_slip[k] = found->elastic[k] * T(world_->accuracy.stick_speed) * h_ * c.speed_scale;
  c.offset = found->offset;
  c.gap += c.offset;
  const T before = -ContactLaw<T>::depth(found->stiffness, found->force, c.width());
  if (c.gap < before - T(kLeaps) * c.length_scale) {
    c.offset += before - c.gap;
    c.gap = before;
  }
  const T own = std::exchange(c.stiffness, found->stiffness);
  const bool softens = may_soften(c);
  if (softens) stiffen(c, own);
  if (!give_way(c)) depenetrate(c);
  if (!softens) stiffen(c, own);
  // Friction of impulses is theirs (end_velocities.h).
  c.grip = c.friction * std::min(c.smooth_before, most_sunk_ * c.length_scale * c.stiffness);
}

/// See is_internal_edge(); by the poses that the step begins with.
template <class T>
bool ContactFinder<T>::is_internal(const Contact<T>& c) const {
  return is_internal_edge<T>(c, contacts_, T(kSameLevel) * c.length_scale, states_);
}

/// A fast body must be stopped well within the thickness of what it meets: F·h = m·v at that depth.
template <class T>
void ContactFinder<T>::stiffen_for_impact(Contact<T>& c) const {
  T mass = T(states_[c.tree_a]->total_mass), thickness = 2 * impact_depth_ * c.length_scale;
  if (c.tree_b >= 0) mass = std::min(mass, T(states_[c.tree_b]->total_mass));
  const T approach = -parting_speed(c);
  if (approach > T(0) && c.gap < T(kMayReach) * h_ * approach && is_internal(c)) {  // slides on to it
    c.face = -1;
    return;
  }
  if (c.meeting != Meeting::kSolids) c.approach = approach;  // what strikes is a point or an edge
  thickness = std::min(thickness, half_thickness(c));
  const T span = h_ / 4;  // a step moves a body by at least h²/4 per unit of what stops it
  if (approach > T(0)) stiffen(c, 2 * mass * approach / (span * thickness));
}

#define SINEW_BEGIN_INSTANCES(T)                                        \
  template void ContactFinder<T>::begin_all();                          \
  template bool ContactFinder<T>::may_soften(const Contact<T>&) const;  \
  template void ContactFinder<T>::depenetrate(Contact<T>&) const;       \
  template T ContactFinder<T>::soften(Contact<T>&, T, T) const;         \
  template T ContactFinder<T>::parting_speed(const Contact<T>&) const;  \
  template void ContactFinder<T>::count_depenetrating();                \
  template void ContactFinder<T>::remember(Contact<T>&) const;          \
  template bool ContactFinder<T>::is_internal(const Contact<T>&) const; \
  template void ContactFinder<T>::stiffen_for_impact(Contact<T>&) const;
SINEW_BEGIN_INSTANCES(float)
SINEW_BEGIN_INSTANCES(double)

}  // namespace sinew
