#include "sinew/graph/graph_finish.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "sinew/animation/crossfade.h"
#include "sinew/animation/foot_placement_job.h"
#include "sinew/graph/graph_contacts.h"
#include "sinew/graph/graph_walk.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {
namespace {

constexpr double kLongestWait = 0.25;  ///< s without legs, after which a foot's place means nothing
constexpr double kAbove = 0.7;         ///< m over the ground, from where rays are cast
constexpr double kSpread = 0.1;        ///< m, between the five rays that tell where the ground rises
constexpr double kLag =
    3 / 2.6740603;                  ///< of a half-life, by which SmoothInput lags behind what rises evenly
constexpr double kSoon = 0.2;       ///< s, in which a foot's way is looked along
constexpr double kFarthest = 0.35;  ///< m of it
constexpr int kAhead = 3;           ///< rays along it

template <class T>
bool whole(const TimeJet<T>& weight) {
  return weight.value == T(1) && weight.rate == T(0) && weight.acceleration == T(0);
}

/// Mean height of the ground where the character will be when its own height has followed.
template <class T>
bool ground_ahead(const GraphHeader<T>& header, const GraphFeet& feet, const GraphGround<T>& ground, T height,
                  T& mean) {
  const double c = portable::cos(header.heading), s = portable::sin(header.heading);
  const double forward = double(header.travel.velocity[0]), left = double(header.travel.velocity[1]);
  const Vec3<double> velocity(c * forward - s * left, s * forward + c * left, 0);
  const Vec3<double> centre = Vec3<double>(header.place[0], header.place[1], double(height) + kAbove) +
                              kLag * double(feet.lift) * velocity;
  int count = 0;
  T sum = 0;
  for (int k = -2; k <= 2; ++k) {
    GroundHit<T> hit;
    const Vec3<double> from = centre + k * kSpread * Vec3<double>(c, s, 0);
    if (!ground.below(ground.host, from.cast<T>(), hit)) continue;
    sum += hit.point.z();
    ++count;
  }
  if (count > 0) mean = sum / T(count);
  return count > 0;
}

/// Rays of one foot and what they met.
template <class T>
struct Rays {
  GroundHit<T> under[2], ahead[kAhead];
  std::size_t under_count = 0, ahead_count = 0;

  void cast(const GraphGround<T>& ground, const Vec3<T>& point, T floor, GroundHit<T>* hits,
            std::size_t& count) {
    const Vec3<T> from(point.x(), point.y(), std::max(point.z(), floor) + T(kAbove));
    GroundHit<T>& hit = hits[count];
    hit = {};
    if (ground.below) {
      count += ground.below(ground.host, from, hit);
    } else {
      hit.point = {point.x(), point.y(), floor};
      ++count;
    }
  }
};

template <class T>
void cast_rays(const GraphGround<T>& ground, const MovingTransform<T>& foot, const FootLeg<T>& leg, T floor,
               Rays<T>& rays) {
  const MovingVector<T> toe = foot * leg.toe;
  const Vec3<T> at = value_of<T>(toe), heel = value_of<T>(foot * leg.heel);
  rays.cast(ground, at, floor, rays.under, rays.under_count);
  rays.cast(ground, heel, floor, rays.under, rays.under_count);
  if (!ground.below) return;
  Vec3<T> way = T(kSoon) * rate_of<T>(toe);
  way.z() = T(0);
  const T length = way.norm();
  if (length > T(kFarthest)) way *= T(kFarthest) / length;
  for (int k = 1; k <= kAhead; ++k)
    rays.cast(ground, at + (T(k) / T(kAhead)) * way, floor, rays.ahead, rays.ahead_count);
}

/// All but how high the character stands.
template <class T>
void forget_feet(GraphFeetState<T>& state) {
  const SmoothInput<T> level = state.level;
  const std::uint32_t begun = state.begun;
  begin_feet(state);
  state.level = level;
  state.begun = begun;
}

}  // namespace

template <class T>
void begin_feet(GraphFeetState<T>& feet) {
  std::memset(static_cast<void*>(&feet), 0, sizeof feet);  // no bytes of chance between the numbers
  for (FootState<T>& leg : feet.legs) leg.ground = -1;
}

template <class T>
void begin_look(GraphLookState<T>& look) {
  std::memset(static_cast<void*>(&look), 0, sizeof look);
  look.look.side = 1;
}

template <class T>
void follow_ground(const Graph& graph, GraphBlock<T>& block, const GraphGround<T>& ground, T h) {
  if (graph.feet().node < 0) return;
  const GraphFeet& feet = graph.node(graph.feet().node).feet;
  GraphFeetState<T>& state = block.feet();
  if (feet.level >= 0) {
    state.level.x = block.parameter(feet.level).x;
    return;
  }
  if (!ground.below) return;
  T goal = state.level.x.value;
  const bool known = ground_ahead<T>(block.header(), feet, ground, goal, goal);
  if (state.begun == 0 && known) {
    state.level.x = TimeJet<T>(goal);
    state.begun = 1;
    return;
  }
  state.level.step(goal, SmoothInput<T>::pole_of(T(feet.lift)), h);
}

template <class T>
Status GraphFinish<T>::place_feet(const TimeJet<T>& weight) {
  const Graph::BoundFeet& bound = graph.feet();
  GraphFeetState<T>& state = block.feet();
  state.waited += scratch.h;
  if (jets.size() < std::size_t(bound.joints)) return {};
  if (nothing(weight) || state.waited > T(kLongestWait) + scratch.h) forget_feet(state);
  if (nothing(weight)) return {};
  const std::span<const FootLeg<T>> legs = bound.template legs<T>();
  const int changed[] = {bound.pelvis,  legs[0].upper,  legs[0].middle, legs[0].foot,
                         legs[1].upper, legs[1].middle, legs[1].foot};
  JointJet<T> before[std::size(changed)];
  for (std::size_t k = 0; k < std::size(changed); ++k) before[k] = jets[std::size_t(changed[k])];
  const Status status = run_feet();
  if (whole(weight) && status) return status;
  EaseWeight<T> ease;
  static_cast<TimeJet<T>&>(ease) = weight;
  for (std::size_t k = 0; k < std::size(changed); ++k) {
    const std::size_t joint = std::size_t(changed[k]);
    if (status)
      crossfade<T>({&before[k], 1}, {&jets[joint], 1}, ease, {&jets[joint], 1}, {&scratch.rest[joint], 1});
    else
      jets[joint] = before[k];
  }
  return status ? status : Status::error(status.code, status.reason, bound.node);
}

template <class T>
Status GraphFinish<T>::run_feet() {
  const Graph::BoundFeet& bound = graph.feet();
  const GraphFeet& feet = graph.node(bound.node).feet;
  GraphFeetState<T>& state = block.feet();
  const std::span<const FootLeg<T>> legs = bound.template legs<T>();
  const std::span<const int> parents(graph.parents().data(), jets.size());
  Rays<T> rays[2];
  FootInput<T> inputs[2];
  LimbMotion<T> limbs[2];
  for (std::size_t k = 0; k < 2; ++k) {
    limbs[k] = LimbMotion<T>(jets, parents, legs[k].upper, legs[k].middle, legs[k].foot);
    cast_rays<T>(ground, limbs[k].end, legs[k], state.level.x.value, rays[k]);
    inputs[k] = {feet.locks ? std::min(T(1), graph_contact(graph, scratch, legs[k].foot)) : T(0),
                 {rays[k].under, rays[k].under_count},
                 {rays[k].ahead, rays[k].ahead_count}};
  }
  FootPlacementJob<T> job{parents, jets, bound.pelvis, legs, inputs, state.legs, &state.drop, ground.bodies};
  job.level = state.level.x;
  job.step = state.waited;
  job.limbs = limbs;
  const FootSettings<float>& s = feet.settings;
  job.settings = {T(s.lock_at),   T(s.release_at), T(s.lock_time), T(s.release_time),
                  T(s.half_life), T(s.farthest),   T(s.steepest)};
  job.reach = T(feet.reach);
  job.follow = T(feet.follow);
  job.rise = T(feet.rise);
  job.deepest = T(feet.deepest);
  state.waited = T(0);
  return job.Run();
}

template <class T>
Status GraphFinish<T>::look(int node, const TimeJet<T>& weight) {
  const GraphLook& in = graph.node(node).look;
  const LookChain<T>& chain = graph.looks()[std::size_t(graph.slot(node))].template chain<T>();
  GraphLookState<T>& state = block.look(graph.slot(node));
  state.waited += scratch.h;
  if (jets.size() <= std::size_t(chain.joints[chain.count - 1])) return {};
  if (nothing(weight) || state.waited > T(kLongestWait) + scratch.h) begin_look(state);
  if (nothing(weight)) return {};
  MovingVector<T> target;
  for (int k = 0; k < 3; ++k) target[k] = block.parameter(in.target[k]).x;
  if (!in.in_world) target = travel * target;
  const LookSettings<float>& s = in.settings;
  LookAtJob<T> job{{graph.parents().data(), jets.size()}, jets, &chain, &state.look, target};
  job.weight = weight;
  job.weight.value = std::clamp(weight.value, T(0), T(1));  // a soft step may round beyond
  job.step = state.waited;
  job.settings = {T(s.yaw),    T(s.pitch_down), T(s.pitch_up),   T(s.softness),
                  T(s.behind), T(s.fastest),    T(s.least_time), T(s.half_life)};
  state.waited = T(0);
  JointJet<T> before[LookChain<T>::kMost];
  for (int k = 0; k < chain.count; ++k) before[k] = jets[std::size_t(chain.joints[k])];
  const Status status = job.Run();
  if (status) return {};
  for (int k = 0; k < chain.count; ++k) jets[std::size_t(chain.joints[k])] = before[k];
  return Status::error(status.code, status.reason, node);
}

SINEW_GRAPH_FINISH_INSTANCES(, float)
SINEW_GRAPH_FINISH_INSTANCES(, double)

}  // namespace sinew
