#include "sinew/character/internal_edge.h"

#include <algorithm>

#include "sinew/effects/static_shape.h"

namespace sinew {
namespace {

constexpr double kProbe = 20;  ///< tolerances beyond the surface, where normals are told apart

/// Of a point about the common origin from what a contact's feature meets; `body` has the shape.
template <class T>
SignedDistance<T> distance_to(const Contact<T>& c, const Transform<T>& body, const Vec3<T>& point) {
  if (c.plane) return {point.z() - c.plane_height};
  if (c.host) {
    const SignedDistance<double> d =
        c.host->distance(*c.host_origin + (point - c.shape_pose.translation).template cast<double>());
    return {T(d.distance), d.normal.template cast<T>()};
  }
  const Transform<T> shape = body * c.shape_pose;
  SignedDistance<T> d = signed_distance<T>(c.shape, c.size, shape.inverse() * point, c.hull);
  d.normal = shape.rotation * d.normal;
  return d;
}

/// Whether the surface that `edge` meets goes on as that of `beside`.
template <class T>
bool goes_on_as(const Contact<T>& edge, const Transform<T>& edge_body, const Contact<T>& beside,
                const Transform<T>& beside_body, T tolerance) {
  const Vec3<T> nearest = edge.point - (edge.radius + edge.distance()) * edge.normal;
  if (!(distance_to(beside, beside_body, nearest).distance < tolerance)) return false;
  const T probe = T(kProbe) * tolerance;
  if (distance_to<T>(beside, beside_body, nearest + probe * edge.normal).distance < -tolerance) return true;
  const T out = edge.radius + std::max(edge.distance(), tolerance);
  const Vec3<T> normal = distance_to<T>(beside, beside_body, nearest + out * edge.normal).normal;
  if (!(normal.dot(edge.normal) < T(kSameNormal))) return false;
  const SignedDistance<T> above = distance_to<T>(edge, edge_body, nearest + probe * normal);
  return above.distance > T(kSamePlane) * probe - tolerance &&
         above.normal.dot(normal) > above.normal.dot(edge.normal);
}

}  // namespace

template <class T>
bool is_internal_edge(const Contact<T>& edge, std::span<const Contact<T>> contacts, T tolerance,
                      std::span<CharacterState<T>* const> states) {
  if (edge.meeting == Meeting::kCorner || edge.plane) return false;
  const auto same = [&](const Contact<T>& beside) {
    return edge.meeting == Meeting::kPoint ? beside.id >> 32 == edge.id >> 32
                                           : beside.tree_a == edge.tree_a && beside.body_a == edge.body_a;
  };
  const auto shape_of = [&](const Contact<T>& c) {
    if (c.tree_b < 0) return Transform<T>();
    const Kinematics<T>& k = states[c.tree_b]->problem.kinematics;
    return Transform<T>{Quat<T>(k.rotation[c.body_b]), k.origin[c.body_b]};
  };
  const auto is_before = [](const Contact<T>& c, int tree) { return c.tree_a < tree; };
  const auto first = std::lower_bound(contacts.begin(), contacts.end(), edge.tree_a, is_before),
             last = std::lower_bound(first, contacts.end(), edge.tree_a + 1, is_before);
  return std::any_of(first, last, [&](const Contact<T>& beside) {
    const bool same_shape = ((beside.id ^ edge.id) & 0xffffffff) == 0;
    return same(beside) && !same_shape && beside.meeting == Meeting::kPoint &&
           beside.normal.dot(edge.normal) < T(kSameNormal) &&
           goes_on_as(edge, shape_of(edge), beside, shape_of(beside), tolerance);
  });
}

#define SINEW_INTERNAL_EDGE_INSTANCES(T)                                            \
  template bool is_internal_edge(const Contact<T>&, std::span<const Contact<T>>, T, \
                                 std::span<CharacterState<T>* const>);
SINEW_INTERNAL_EDGE_INSTANCES(float)
SINEW_INTERNAL_EDGE_INSTANCES(double)

}  // namespace sinew
