// What IslandStepper tells a listener of its contacts.
#include <algorithm>

#include "sinew/character/island.h"

namespace sinew {
namespace {

constexpr int kEdgeSide = 0x8000;  ///< of contact identities, beside the number of what is static

/// Of the static side of a contact: see TouchingBody.
template <class T>
int static_number(const Contact<T>& c) {
  return c.plane ? -1 : static_cast<int>(c.id & (kEdgeSide - 1)) - 1;
}

/// Whether the two sides touch at the end of a part.
template <class T>
bool touches(const Contact<T>& c) {
  return normal_force(c) > T(0) || (c.offset > T(0) && c.gap < c.offset);
}

/// Where the surface of the first side is nearest to the second, or deepest in it.
template <class T>
Vec3<T> surface_of(const Contact<T>& c) {
  return c.meeting == Meeting::kPoint ? Vec3<T>(c.point - c.radius * c.normal) : c.point;
}

/// The same contact seen from the other side, where that comes first.
template <class T>
LoggedContact<T> in_order(LoggedContact<T> c) {
  if (c.pair.b.tree < 0 || c.pair.a < c.pair.b) return c;
  std::swap(c.pair.a, c.pair.b);
  c.normal = -c.normal;
  c.friction = -c.friction;
  return c;
}

template <class T>
LoggedContact<T> logged(const Contact<T>& c, std::span<const int> indices, const Vec3<double>& origin) {
  LoggedContact<T> out;
  out.pair.a = {indices[c.tree_a], c.body_a};
  out.pair.b = c.tree_b < 0 ? TouchingBody{-1, static_number(c)} : TouchingBody{indices[c.tree_b], c.body_b};
  out.id = c.id;
  out.point = origin + surface_of(c).template cast<double>();
  out.normal = c.normal;
  return out;
}

}  // namespace

/// N·s of a contact in a part of h seconds, by the scheme's own weights (bossak.h): what is smooth acts from
/// the beginning of the part to its end, what has just come at its end.
template <class T>
T IslandStepper<T>::impulse_of(const Contact<T>& c, T h) const {
  const Prediction<T>& prediction = problems_[c.tree_a]->prediction;
  const T force = normal_force(c);
  if (settings_.plan->scheme || !(prediction.rho > T(0))) return h * force;
  const T gamma = BossakWeights<T>(prediction.rho).gamma, acted = 1 / (h * prediction.weight);
  return h * ((1 - gamma) * c.smooth_before + gamma * c.smooth_force) + acted * (force - c.smooth_force);
}

template <class T>
Contact<T>* IslandStepper<T>::find_contact(std::uint64_t id) {
  const auto c =
      std::find_if(contacts_.begin(), contacts_.end(), [&](const Contact<T>& of) { return of.id == id; });
  return c == contacts_.end() ? nullptr : &*c;
}

/// What has struck before the solve of the present part.
template <class T>
void IslandStepper<T>::log_strikes() {
  ends_.for_each_pushed([&](std::uint64_t id, T impulse) {
    const Contact<T>* const c = find_contact(id);
    if (!c) return;
    LoggedContact<T> struck = logged<T>(*c, indices_, settings_.common_origin);
    struck.impulse = impulse;
    log_->strike(struck);
  });
}

/// A contact as it is at the end of a part.
template <class T>
LoggedContact<T> IslandStepper<T>::logged_at_end(const Contact<T>& c) const {
  LoggedContact<T> found = logged<T>(c, indices_, settings_.common_origin);
  found.force = normal_force(c);
  found.friction = -friction_gradient(c, settings_.stick);
  found.depth = std::max(-c.distance(), T(0));
  return found;
}

/// The contacts of a part that stands: those that bear at its end or are inside something still, and those
/// that have struck in it.
template <class T>
void IslandStepper<T>::log_contacts(T h) {
  for (const Contact<T>& c : contacts_) {
    if (!touches(c)) continue;
    LoggedContact<T> found = logged_at_end(c);
    found.impulse = log_->struck(c.id) + (found.force > T(0) ? impulse_of(c, h) : T(0));
    log_->add(in_order(found));
  }
  for (const LoggedContact<T>& struck : log_->strikes()) {
    const auto same = [&](const Contact<T>& c) { return c.id == struck.id && touches(c); };
    if (std::none_of(contacts_.begin(), contacts_.end(), same)) log_->add(in_order(struck));
  }
  log_->end_part();
}

/// What an effect has given contacts after the solve.
template <class T>
void IslandStepper<T>::log_bounces(const IslandEffect<T>& effect) {
  for (const Contact<T>& c : contacts_) {
    const T pushed = effect.pushed(c);
    if (!(pushed > T(0))) continue;
    LoggedContact<T> found = logged_at_end(c);
    found.impulse = pushed;
    log_->add(in_order(found));
  }
  log_->end_part();
}

#define SINEW_CONTACTS_INSTANCES(T)                                                   \
  template T IslandStepper<T>::impulse_of(const Contact<T>&, T) const;                \
  template void IslandStepper<T>::log_strikes();                                      \
  template Contact<T>* IslandStepper<T>::find_contact(std::uint64_t);                 \
  template LoggedContact<T> IslandStepper<T>::logged_at_end(const Contact<T>&) const; \
  template void IslandStepper<T>::log_bounces(const IslandEffect<T>&);                \
  template void IslandStepper<T>::log_contacts(T);
SINEW_CONTACTS_INSTANCES(float)
SINEW_CONTACTS_INSTANCES(double)

}  // namespace sinew
