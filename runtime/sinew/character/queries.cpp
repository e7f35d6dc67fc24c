#include "sinew/character/queries.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sinew/character/world_impl.h"

namespace sinew {
namespace {

constexpr double kExact = 1e-8;  ///< m: nearer than that it touches
constexpr int kSteps = 64;  ///< towards a convex shape; where it only just grazes each halves what is left
constexpr int kSectionsOfAxis = 44;  ///< golden, of a capsule's: to 1e-9 of it
/// m, along the way near a shape of the host's, and away from it; of its distance, which may be too long.
constexpr double kLeastStep = 0.02, kMostStep = 0.5, kShareOfDistance = 0.7;
constexpr int kBisections = 30;
constexpr int kMostInner = 6;       ///< points of an axis between its ends, as contacts have
constexpr double kRounded = 1.001;  ///< of its radius: float's digits
constexpr double kChunk = 3;        ///< m of the way that are looked up in the grid at a time
constexpr int kCellsOfChunk = 25;   ///< that this looks at, about
constexpr double kFarthest = 1e7;   ///< m

/// A cast as the shapes meet it.
struct Probe {
  Vec3<double> from, direction, half_axis;  ///< m, unit, m
  double length = 0, radius = 0;            ///< m

  double reach() const { return radius + half_axis.norm(); }
  Vec3<double> at(double t) const { return from + t * direction; }
};

/// Nearest points of an axis and a shape.
struct Near {
  double distance = 0;                          ///< m, less the probe's radius
  Vec3<double> normal = Vec3<double>::UnitZ();  ///< outwards of the shape
  Vec3<double> surface = Vec3<double>::Zero();  ///< where that is
};

Near near_to(const Probe& probe, double t, const Transform<double>& pose, const Collider& shape) {
  double along = 0;
  const Vec3<double> middle = probe.at(t);
  const SignedDistance<double> d =
      distance_of_axis<double>(middle, probe.half_axis, pose, shape, kSectionsOfAxis, along);
  const Vec3<double> normal = pose.rotation * d.normal;
  return {d.distance - probe.radius, normal, middle + along * probe.half_axis - d.distance * normal};
}

Near near_to_ground(const Probe& probe, double t, double height) {
  const Vec3<double> lower = probe.half_axis.z() > 0 ? Vec3<double>(-probe.half_axis) : probe.half_axis;
  const Vec3<double> at = probe.at(t) + lower;
  return {at.z() - height - probe.radius, Vec3<double>::UnitZ(), {at.x(), at.y(), height}};
}

Near near_to_host(const Probe& probe, double t, const StaticShape& shape) {
  Near nearest;
  nearest.distance = std::numeric_limits<double>::infinity();
  const double half = probe.half_axis.norm();
  const int inner =
      half > 0 ? static_cast<int>(std::min(half / std::max(probe.radius, 1e-3), double(kMostInner))) : 0;
  const int points = half > 0 ? inner + 2 : 1;
  for (int n = 0; n < points; ++n) {
    const double along = points > 1 ? 2.0 * n / (points - 1) - 1 : 0;
    const Vec3<double> at = probe.at(t) + along * probe.half_axis;
    const SignedDistance<double> d = shape.distance(at);
    if (d.distance - probe.radius < nearest.distance)
      nearest = {d.distance - probe.radius, d.normal, at - d.distance * d.normal};
  }
  return nearest;
}

/// How far the probe goes until it touches something convex, at most `limit`; negative: it does not. `near`:
/// see above, by where it is on its way. By the tangents of the distance, which is convex along the way.
template <class Distance>
double go_to_convex(const Probe& probe, double limit, const Distance& near, Near& out) {
  double t = 0;
  for (int n = 0; n < kSteps; ++n) {
    out = near(t);
    const double closing = -out.normal.dot(probe.direction);
    if (out.distance <= (closing > 0 ? kExact : -kExact)) return t;
    if (!(closing > 0)) return -1;
    t += out.distance / closing;
    if (!(t <= limit)) return -1;
  }
  return -1;
}

/// The same for what may have any shape.
double go_to_host(const Probe& probe, double limit, const StaticShape& shape, Near& out) {
  const double least = std::clamp(shape.half_thickness(), 1e-3, kLeastStep);
  double outside = 0, t = 0;
  out = near_to_host(probe, 0, shape);
  const bool leaves = out.normal.dot(probe.direction) >= 0;
  if (out.distance <= (leaves ? -kExact : kExact)) return 0;
  while (out.distance > kExact || t == 0) {
    if (t >= limit) return -1;
    outside = t;
    t = std::min(t + std::clamp(kShareOfDistance * out.distance, least, kMostStep), limit);
    out = near_to_host(probe, t, shape);
  }
  double inside = t;
  for (int n = 0; n < kBisections && inside - outside > kExact; ++n) {
    t = (outside + inside) / 2;
    (near_to_host(probe, t, shape).distance > 0 ? outside : inside) = t;
  }
  out = near_to_host(probe, inside, shape);
  return inside;
}

/// The nearest (or deepest) hits so far.
class Hits {
 public:
  Hits(const QueryFilter& filter, std::span<QueryHit> room, double limit)
      : filter_(filter), buffer_(room), limit_(limit) {}

  /// m, beyond which nothing is of use.
  double limit() const { return full() ? std::min(limit_, buffer_.back().distance) : limit_; }
  int count() const { return static_cast<int>(count_); }
  bool accepts(const BodyRef& body) const { return !filter_.accept || filter_.accept(filter_.context, body); }
  void add(const BodyRef& body, int collider, double distance, const Near& near) {
    const QueryHit hit{body,         collider,    distance,
                       near.surface, near.normal, distance > 0 ? 0 : std::max(-near.distance, 0.0)};
    const auto before = [](const QueryHit& a, const QueryHit& b) {
      return a.distance != b.distance ? a.distance < b.distance : a.depth > b.depth;
    };
    const auto end = buffer_.begin() + static_cast<std::ptrdiff_t>(count_);
    const auto at = std::upper_bound(buffer_.begin(), end, hit, before);
    if (at == buffer_.end()) return;
    if (full())
      std::move_backward(at, end - 1, end);
    else {
      std::move_backward(at, end, end + 1);
      ++count_;
    }
    *at = hit;
  }

 private:
  bool full() const { return count_ == buffer_.size() && !buffer_.empty(); }

  const QueryFilter& filter_;
  std::span<QueryHit> buffer_;
  double limit_;
  std::size_t count_ = 0;
};

/// Where along the way a point is nearest to it.
double along_way(const Probe& probe, const Vec3<double>& point) {
  return std::clamp(probe.direction.dot(point - probe.from), 0.0, probe.length);
}

/// Whether the way may lead within a ball.
bool comes_near(const Probe& probe, const Vec3<double>& center, double radius) {
  const double reach = radius + probe.reach() + kExact;
  return (probe.at(along_way(probe, center)) - center).squaredNorm() <= reach * reach;
}

template <class T>
class Search {
 public:
  Search(const typename WorldInternals<T>::Impl& world, const Cast& query, const Probe& probe,
         std::span<QueryHit> hits)
      : world_(world), filter_(query.filter), probe_(probe), hits_(query.filter, hits, probe.length) {}

  int run() {
    if (filter_.ground && world_.settings.ground && (filter_.layers & 1u)) meet_ground();
    if (filter_.obstacles) meet_obstacles();
    for (std::size_t n = 0; filter_.obstacles && n < world_.hosts.size(); ++n)
      if (world_.host_layers[n] & filter_.layers) meet_host(static_cast<int>(n));
    for (std::size_t n = 0; filter_.characters && n < world_.characters.size(); ++n)
      if (static_cast<int>(n) != filter_.without_character) meet_state(world_.characters[n]);
    for (std::size_t n = 0; filter_.props && n < world_.props.size(); ++n)
      if (static_cast<int>(n) != filter_.without_prop) meet_state(world_.props[n]);
    for (std::size_t n = 0; filter_.particles && n < world_.particles.size(); ++n)
      meet_state(world_.particles[n].state);
    return hits_.count();
  }

 private:
  void take(const BodyRef& body, int collider, double distance, const Near& near) {
    if (distance >= 0 && hits_.accepts(body)) hits_.add(body, collider, distance, near);
  }
  void meet_ground() {
    Near near;
    const double height = world_.settings.ground_height;
    const auto distance = [&](double t) { return near_to_ground(probe_, t, height); };
    const double t = go_to_convex(probe_, hits_.limit(), distance, near);
    take({}, -1, t, near);
  }
  void meet_host(int n) {
    Near near;
    const double t =
        go_to_host(probe_, hits_.limit(), *world_.hosts[static_cast<std::size_t>(n)].shape, near);
    take({BodyKind::kShape, n, 0}, -1, t, near);
  }
  double go_to(const Transform<double>& pose, const Collider& shape, Near& near) const {
    return go_to_convex(
        probe_, hits_.limit(), [&](double t) { return near_to(probe_, t, pose, shape); }, near);
  }
  void meet_obstacle(int n) {
    const Collider& obstacle = world_.obstacles[static_cast<std::size_t>(n)];
    if (!(world_.obstacle_layers[static_cast<std::size_t>(n)] & filter_.layers)) return;
    if (!comes_near(probe_, obstacle.local.translation, bounding_radius(obstacle))) return;
    Near near;
    const double t = go_to(obstacle.local, obstacle, near);
    take({BodyKind::kObstacle, n, 0}, -1, t, near);
  }
  /// Piece by piece of the way, as long as one has no hit nearer; each obstacle in the piece that is nearest
  /// to its middle.
  void meet_obstacles() {
    const int count = static_cast<int>(world_.obstacles.size()),
              chunks = 1 + static_cast<int>(probe_.length / kChunk);
    if (chunks * kCellsOfChunk > count) {
      for (int n = 0; n < count; ++n) meet_obstacle(n);
      return;
    }
    const double piece = probe_.length / chunks;
    for (int k = 0; k < chunks && k * piece <= hits_.limit(); ++k)
      world_.obstacle_grid.overlapping(
          probe_.at((k + 0.5) * piece), piece / 2 + probe_.reach() + kExact, [&](int n) {
            const double along =
                along_way(probe_, world_.obstacles[static_cast<std::size_t>(n)].local.translation);
            if (std::min(static_cast<int>(along / piece), chunks - 1) == k) meet_obstacle(n);
          });
  }
  void meet_state(int n) {
    CharacterState<T>& s = *world_.states[static_cast<std::size_t>(n)];
    if (s.parked || !(s.settings.layers & filter_.layers)) return;
    const double whole = kRounded * double(s.radius);
    if (world_.plan.contacts && !comes_near(probe_, s.middle(), whole)) return;
    for (std::size_t c = 0; c < s.colliders.size(); ++c) {
      const Collider& collider = s.colliders[c];
      const Transform<double> pose =
          s.model()[static_cast<std::size_t>(collider.joint)].template cast<double>() * collider.local;
      if (!comes_near(probe_, pose.translation, double(s.bound_radius[c]))) continue;
      Near near;
      const double t = go_to(pose, collider, near);
      if (t < 0) continue;
      const BodyRef body = world_.name_of({n, collider.joint});
      take(body, body.kind == BodyKind::kCharacter ? static_cast<int>(c) : 0, t, near);
    }
  }

  const typename WorldInternals<T>::Impl& world_;
  const QueryFilter& filter_;
  const Probe probe_;
  Hits hits_;
};

Status check(const Cast& query) {
  if (!query.from.allFinite() || !query.motion.allFinite() || !query.half_axis.allFinite() ||
      !std::isfinite(query.radius))
    return Status::error(Code::kNotFinite, "query is not finite");
  if (query.radius < 0) return Status::error(Code::kInvalidArgument, "a query's radius must be ≥ 0");
  const double size = query.radius + query.half_axis.norm();
  if (query.from.norm() + query.motion.norm() + size > kFarthest)
    return Status::error(Code::kOutOfRange, "query reaches beyond 1e7 m");
  return {};
}

}  // namespace

template <class T>
Status cast(const World<T>& world, const Cast& query, std::span<QueryHit> hits, int& count) {
  count = 0;
  if (Status status = check(query); !status) return status;
  const double length = query.motion.norm();
  if (!(length > 0)) return Status::error(Code::kInvalidArgument, "a cast must go somewhere");
  if (hits.empty()) return {};
  const Probe probe{query.from, query.motion / length, query.half_axis, length, query.radius};
  count = Search<T>(WorldInternals<T>::of(world), query, probe, hits).run();
  return {};
}

template <class T>
Status overlap(const World<T>& world, const Cast& query, std::span<QueryHit> hits, int& count) {
  count = 0;
  if (Status status = check(query); !status) return status;
  if (hits.empty()) return {};
  const Probe probe{query.from, Vec3<double>::Zero(), query.half_axis, 0, query.radius};
  count = Search<T>(WorldInternals<T>::of(world), query, probe, hits).run();
  return {};
}

SINEW_QUERY_INSTANCES(template, float)
SINEW_QUERY_INSTANCES(template, double)

}  // namespace sinew
