#include "sinew/graph/graph_pose.h"

#include <algorithm>
#include <cmath>

#include "sinew/animation/blending_job.h"
#include "sinew/animation/crossfade.h"
#include "sinew/animation/curve_job.h"
#include "sinew/animation/dying_rate.h"
#include "sinew/animation/kernels/layout.h"
#include "sinew/animation/mesh_additive_job.h"
#include "sinew/animation/quintic_offset.h"
#include "sinew/animation/root_motion.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/graph/graph_finish.h"
#include "sinew/skeleton/portable_math.h"

namespace sinew {
namespace {

constexpr double kSlowing = 7, kLoss = 120;  ///< 1/s, of what a left pose does (ExtrapolateJob)

/// A root's motion over the ground, in heading axes, and the rest of it.
template <class T>
TravelVelocity<T> take_travel(JointJet<T>& root, Vec3<T>& place, T& heading) {
  const RootMotion<T> motion = split_root(root);
  const JointJet<T>& travel = motion.travel;
  const Quat<T> back = travel.rotation.conjugate();
  const Vec3<T> v = back * travel.velocity, a = back * travel.acceleration;
  const T turn = travel.omega.z();
  place = travel.translation;
  heading = 2 * portable::atan2(travel.rotation.z(), travel.rotation.w());
  root = motion.body;
  return {{v.x(), v.y(), turn}, {a.x() + turn * v.y(), a.y() - turn * v.x(), travel.alpha.z()}};
}

/// Of a loop: what it does on the whole, at a uniform speed. The sway of its cycle is the body's, or it would
/// turn the character each time that a cycle is cut short.
template <class T>
TravelVelocity<T> take_uniform(const Clip& clip, const ClipTime& time, JointJet<T>& root) {
  const Vec3<double> v(double(clip.root_step.x()) / double(clip.duration),
                       double(clip.root_step.y()) / double(clip.duration), 0);
  root.translation = (root.translation.template cast<double>() - time.value * v).template cast<T>();
  root.velocity -= (time.rate * v).template cast<T>();
  root.acceleration -= (time.acceleration * v).template cast<T>();
  return {{T(time.rate * v.x()), T(time.rate * v.y()), T(0)},
          {T(time.acceleration * v.x()), T(time.acceleration * v.y()), T(0)}};
}

/// Eigen's vectors are no plain bytes to the compiler: it would copy number by number.
template <class T>
void copy_jets(std::span<const JointJet<T>> from, std::span<JointJet<T>> to) {
  std::copy_n(kernels::layout(from.data()), to.size(), kernels::layout(to.data()));
}

/// Is the heading of this root defined, that is: is it not upside down?
template <class T>
bool has_heading(const JointJet<T>& root) {
  const Quat<T>& q = root.rotation;
  return q.z() * q.z() + q.w() * q.w() > T(1e-4);
}

template <class T>
class Pose {
 public:
  using Register = typename GraphScratch<T>::Register;

  explicit Pose(const GraphPoseJob<T>& job)
      : job_(job), graph_(*job.graph), block_(graph_, job.state), s_(*job.scratch) {}

  Status run() {
    follow_ground<T>(graph_, block_, job_.ground, s_.h);
    int k = 0;
    for (; k < s_.task_count && !finishes(s_.tasks[std::size_t(k)]); ++k) {
      const GraphTask& task = s_.tasks[std::size_t(k)];
      const std::size_t joints = task.whole ? std::size_t(graph_.joint_count()) : job_.jets.size();
      if (Status status = carry_out(task, joints); !status) return status;
      if (job_.watch.task_done) job_.watch.task_done(job_.watch.tool, task, jets(task.out, joints));
    }
    travel();
    Status first;  // the pose is whole whatever fails from here on
    for (; k < s_.task_count; ++k)
      if (Status status = finish(s_.tasks[std::size_t(k)]); first.ok()) first = status;
    return first;
  }

 private:
  static bool finishes(const GraphTask& task) {
    return task.kind == GraphTask::Kind::kFeet || task.kind == GraphTask::Kind::kLook;
  }
  Status finish(const GraphTask& task) {
    GraphFinish<T> pose{graph_, block_, s_, job_.jets, job_.ground, place_};
    const Status status = task.kind == GraphTask::Kind::kFeet ? pose.place_feet(weight(task.weights))
                                                              : pose.look(task.index, weight(task.weights));
    if (job_.watch.task_done) job_.watch.task_done(job_.watch.tool, task, job_.jets);
    return status;
  }
  TimeJet<T> level() { return graph_.feet().node < 0 ? TimeJet<T>(T(0)) : block_.feet().level.x; }
  Register& at(int k) { return s_.registers[std::size_t(k)]; }
  std::span<JointJet<T>> jets(int k, std::size_t joints) { return at(k).jets.first(joints); }
  const TimeJet<T>& weight(int k) const { return s_.weights[std::size_t(k)]; }

  Status carry_out(const GraphTask& task, std::size_t joints) {
    switch (task.kind) {
      case GraphTask::Kind::kSample:
        return sample(task, joints);
      case GraphTask::Kind::kPhysical:
        return physical(task, joints);
      case GraphTask::Kind::kBlend:
        return blend(task, joints);
      case GraphTask::Kind::kCrossfade:
        return fade(task.out, weight(task.weights), joints);
      case GraphTask::Kind::kMirror:
        return mirror(task, joints);
      case GraphTask::Kind::kLayer:
        return layer(task, joints);
      case GraphTask::Kind::kKeep:
        copy(task.out, task.from, joints);
        return {};
      case GraphTask::Kind::kBeginOffset:
        return begin_offset(task);
      case GraphTask::Kind::kOffset:
        return offset(task, joints);
      case GraphTask::Kind::kLeave:
        leave(task);
        return {};
      case GraphTask::Kind::kLeft:
        return left(task, joints);
      case GraphTask::Kind::kTravel:
        steer(task);
        return {};
      case GraphTask::Kind::kFeet:
      case GraphTask::Kind::kLook:
        break;  // finish()
    }
    return {};
  }
  void copy(int from, int to, std::size_t joints) {
    copy_jets<T>(at(from).jets, jets(to, joints));
    std::copy(at(from).curves.begin(), at(from).curves.end(), at(to).curves.begin());
    at(to).travel = at(from).travel;
  }

  Status sample(const GraphTask& task, std::size_t joints) {
    const Graph::BoundClip& clip = graph_.clips()[std::size_t(task.index)];
    Register& out = at(task.out);
    if (Status status = SamplingJob<T>{clip.clip, task.time, jets(task.out, joints)}.Run(); !status)
      return status;
    out.travel = {};
    const bool moves = graph_.node(clip.node).root_motion;
    Vec3<T> place;
    T heading;
    if (clip.clip->loops) {
      const TravelVelocity<T> uniform = take_uniform(*clip.clip, task.time, out.jets[0]);
      if (moves) out.travel = uniform;
    } else if (moves && has_heading(out.jets[0])) {
      out.travel = take_travel(out.jets[0], place, heading);
    }
    return CurveJob<T>{clip.clip, task.time, graph_.curve_slots(), out.curves}.Run();
  }
  Status physical(const GraphTask& task, std::size_t joints) {
    Register& out = at(task.out);
    s_.shows_physical = true;
    copy_jets<T>(job_.physical, jets(task.out, joints));
    Vec3<T> place;
    T heading;
    if (has_heading(out.jets[0])) {
      out.travel = take_travel(out.jets[0], place, heading);
      block_.header().place[0] = double(place.x());
      block_.header().place[1] = double(place.y());
      block_.header().heading = double(heading);
    }
    const TimeJet<T> height = level();  // which the character will be lifted by
    out.jets[0].translation.z() -= height.value;
    out.jets[0].velocity.z() -= height.rate;
    out.jets[0].acceleration.z() -= height.acceleration;
    for (std::size_t k = 0; k < out.curves.size(); ++k)
      out.curves[k] = TimeJet<T>(T(graph_.curve_slots()[k].rest));
    return {};
  }

  /// V = Σw·V, V' = Σ(w·V' + w'·V): `into` begins as nothing.
  static void add(const TravelVelocity<T>& v, const TimeJet<T>& w, TravelVelocity<T>& into) {
    for (int k = 0; k < 3; ++k) {
      into.velocity[k] += w.value * v.velocity[k];
      into.change[k] += w.value * v.change[k] + w.rate * v.velocity[k];
    }
  }
  Status blend(const GraphTask& task, std::size_t joints) {
    BlendLayer<T> layers[BlendSpace::kMaxClips];
    CurveLayer<T> curves[BlendSpace::kMaxClips];
    TravelVelocity<T> sum;
    for (int k = 0; k < task.count; ++k) {
      const TimeJet<T>& w = weight(task.weights + k);
      layers[k] = {jets(task.out + k, joints), w};
      curves[k] = {at(task.out + k).curves, w};
      add(at(task.out + k).travel, w, sum);
    }
    const std::size_t count = task.count;
    at(task.out).travel = sum;
    if (Status status = CurveBlendingJob<T>{{curves, count}, graph_.curve_slots(), at(task.out).curves}.Run();
        !status)
      return status;
    return BlendingJob<T>{{layers, count}, s_.rest, jets(task.out, joints)}.Run();
  }
  /// From register k to the next one.
  Status fade(int k, const TimeJet<T>& w, std::size_t joints) {
    const TimeJet<T> rest = TimeJet<T>(T(1)) - w;
    TravelVelocity<T> sum;
    add(at(k).travel, rest, sum);
    add(at(k + 1).travel, w, sum);
    at(k).travel = sum;
    for (std::size_t c = 0; c < at(k).curves.size(); ++c)
      at(k).curves[c] = rest * at(k).curves[c] + w * at(k + 1).curves[c];
    EaseWeight<T> ease;
    static_cast<TimeJet<T>&>(ease) = w;
    crossfade<T>(jets(k, joints), jets(k + 1, joints), ease, jets(k, joints), s_.rest);
    return {};
  }

  Status mirror(const GraphTask& task, std::size_t joints) {
    TravelVelocity<T>& travel = at(task.out).travel;
    for (const int k : {1, 2}) {  // to the left, and the turn
      travel.velocity[k] = -travel.velocity[k];
      travel.change[k] = -travel.change[k];
    }
    return MirrorJob<T>{&graph_.template mirror<T>(), at(task.out).jets, jets(task.out, joints)}.Run();
  }
  void steer(const GraphTask& task) {
    const GraphTravel& in = graph_.node(task.index).travel;
    const TimeJet<T>& w = weight(task.weights);
    TravelVelocity<T>& travel = at(task.out).travel;
    for (int k = 0; k < 3; ++k) {
      if (in.parameters[k] < 0) continue;
      const TimeJet<T>& asked = block_.parameter(in.parameters[k]).x;
      const TimeJet<T> own(travel.velocity[k], travel.change[k], T(0));
      const TimeJet<T> sum = own + w * (in.adds ? asked : asked - own);
      travel.velocity[k] = sum.value;
      travel.change[k] = sum.rate;
    }
  }
  Status layer(const GraphTask& task, std::size_t joints) {
    const GraphLayer& in = graph_.node(task.index).layers[std::size_t(task.layer)];
    const Graph::BoundLayer& bound = graph_.layer(task.index, task.layer);
    const TimeJet<T>& w = weight(task.weights);
    const std::span<const T> mask =
        bound.mask < 0 ? std::span<const T>() : std::span<const T>(s_.masks[std::size_t(bound.mask)]);
    const std::span<JointJet<T>> below = jets(task.out, joints), upper = jets(task.out + 1, joints);
    if (in.mode == LayerMode::kOverride) {
      const TimeJet<T> root = (mask.empty() ? T(1) : mask[0]) * w;
      TravelVelocity<T> sum;
      add(at(task.out).travel, TimeJet<T>(T(1)) - root, sum);
      add(at(task.out + 1).travel, root, sum);
      at(task.out).travel = sum;
      const CurveLayer<T> curves[] = {{at(task.out).curves},
                                      {at(task.out + 1).curves, w, {}, BlendMode::kOverride}};
      if (Status status = CurveBlendingJob<T>{curves, graph_.curve_slots(), at(task.out).curves}.Run();
          !status)
        return status;
    }
    const std::span<const Transform<T>> reference =
        s_.references[std::size_t(graph_.slot(task.index)) + std::size_t(task.layer)];
    if (in.mode == LayerMode::kMeshAdditive) return add_in_model(below, upper, reference, w, mask);
    const BlendMode mode = in.mode == LayerMode::kAdditive ? BlendMode::kAdditive : BlendMode::kOverride;
    const BlendLayer<T> layers[] = {{below}, {upper, w, mask, mode, reference}};
    return BlendingJob<T>{layers, s_.rest, below}.Run();
  }
  Status add_in_model(std::span<JointJet<T>> below, std::span<JointJet<T>> upper,
                      std::span<const Transform<T>> reference, const TimeJet<T>& w, std::span<const T> mask) {
    const std::size_t n = below.size();
    const std::span<const int> parents(graph_.parents().data(), n);
    const std::span<MovingRotation<T>> scratch(s_.rotations.data(), 2 * n);
    const std::span<JointJet<T>> still(s_.left.data(), n);
    for (std::size_t j = 0; j < n; ++j) still[j] = {.rotation = reference[j].rotation};
    subtract_in_model<T>(parents, still, upper, scratch, upper);
    return MeshAdditiveJob<T>{parents, below, upper, w, mask.empty() ? mask : mask.first(n), scratch}.Run();
  }

  InertialState<T> offset_state(T elapsed, T duration) {
    return {s_.offset, graph_.joint_count(), graph_.translated(), elapsed, duration};
  }
  Status begin_offset(const GraphTask& task) {
    GraphMachineState<T>& m = block_.machine(task.index);
    const Graph::BoundMachine& bound = graph_.machines()[std::size_t(task.index)];
    const GraphTransition& t = graph_.node(bound.node).transitions[std::size_t(task.layer)];
    InertialState<T> state = offset_state(T(0), m.duration);
    const Register &before = at(task.from), &after = at(task.out);
    if (Status status = begin_inertial<T>(before.jets, after.jets, m.duration, state); !status) return status;
    keep_offset(state, block_.offset(bound.offset));
    for (std::size_t c = 0; c < before.curves.size(); ++c)
      block_.curve_offsets(bound.offset)[c] = before.curves[c] - after.curves[c];
    for (int k = 0; k < 3; ++k) {
      m.travel.velocity[k] = before.travel.velocity[k] - after.travel.velocity[k];
      m.travel.change[k] = before.travel.change[k] - after.travel.change[k];
    }
    if (t.budget > 0 && job_.muscles.duration) ask_muscles(state, t, after, m);
    return {};
  }
  /// The host, about the motion gone to, where the character stands.
  void ask_muscles(const InertialState<T>& state, const GraphTransition& t, const Register& after,
                   GraphMachineState<T>& m) {
    const std::span<JointJet<T>> there(s_.left.data(), std::size_t(graph_.joint_count()));
    std::copy_n(after.jets.begin(), there.size(), there.begin());
    there[0] = joint_jet<T>(moving_transform(travel_jet(after.travel)) * moving_transform(there[0]));
    const T least = std::min(T(kLeastFade), m.duration);
    const T asked = job_.muscles.duration(job_.muscles.host, {there, &state, T(t.budget), least, m.duration});
    if (asked < m.duration) m.duration = std::max(asked, least);
  }
  /// [joint] which part of the duration it takes; empty: all of it.
  std::span<const T> profile_of(const Graph::BoundMachine& machine, int transition) {
    const int mask = machine.profiles[std::size_t(transition)];
    if (mask < 0) return {};
    const T share = T(graph_.node(machine.node).transitions[std::size_t(transition)].share);
    for (std::size_t j = 0; j < s_.profile.size(); ++j)
      s_.profile[j] = T(1) - (T(1) - share) * s_.masks[std::size_t(mask)][j];
    return s_.profile;
  }
  Status offset(const GraphTask& task, std::size_t joints) {
    const GraphMachineState<T>& m = block_.machine(task.index);
    const Graph::BoundMachine& bound = graph_.machines()[std::size_t(task.index)];
    // A change overwrites the machine's times before what it did before is made.
    const T elapsed = task.at_change ? T(task.time.value) : m.elapsed,
            duration = task.at_change ? T(task.time.rate) : m.duration;
    InertialState<T> state = offset_state(elapsed, duration);
    if (!state.running()) return {};
    recall_offset(block_.offset(bound.offset), state);
    const QuinticOffset<T> left = QuinticOffset<T>::at(elapsed, duration);
    Register& out = at(task.out);
    for (std::size_t c = 0; c < out.curves.size(); ++c)
      out.curves[c] += left(block_.curve_offsets(bound.offset)[c]);
    for (int k = 0; k < 3; ++k) {
      const TimeJet<T> x = left(TimeJet<T>(m.travel.velocity[k], m.travel.change[k], T(0)));
      out.travel.velocity[k] += x.value;
      out.travel.change[k] += x.rate;
    }
    const std::span<const T> profile = profile_of(bound, task.layer);
    return InertializeJob<T>{jets(task.out, joints), &state, profile, jets(task.out, joints)}.Run();
  }

  void leave(const GraphTask& task) {
    const Graph::BoundMachine& bound = graph_.machines()[std::size_t(task.index)];
    const Register& from = at(task.from);
    keep_pose<T>(from.jets, s_.rest, graph_.translated(), block_.offset(bound.offset));
    std::copy(from.curves.begin(), from.curves.end(), block_.curve_offsets(bound.offset).begin());
    block_.machine(task.index).travel = from.travel;
  }
  Status left(const GraphTask& task, std::size_t joints) {
    const GraphMachineState<T>& m = block_.machine(task.index);
    const Graph::BoundMachine& bound = graph_.machines()[std::size_t(task.index)];
    const T elapsed = T(task.time.value), duration = T(task.time.rate);
    const int to = task.out + 1;  // the new motion goes there, the old one takes its place
    copy(task.out, to, joints);
    Register& old = at(task.out);
    const std::span<JointJet<T>> left(s_.left.data(), joints);
    recall_pose<T>(block_.offset(bound.offset), s_.rest, graph_.translated(), left);
    const ExtrapolateJob<T> job{left, elapsed, T(kSlowing), T(kLoss), jets(task.out, joints)};
    if (Status status = job.Run(); !status) return status;
    const DyingRate<T> dying = DyingRate<T>::at(elapsed, T(kSlowing), T(kLoss));
    for (int k = 0; k < 3; ++k) {
      const TimeJet<T> x = dying(TimeJet<T>(T(0), m.travel.velocity[k], m.travel.change[k]));
      old.travel.velocity[k] = x.rate;
      old.travel.change[k] = x.acceleration;
    }
    const std::span<const TimeJet<T>> curves = block_.curve_offsets(bound.offset);
    for (std::size_t c = 0; c < curves.size(); ++c) old.curves[c] = dying(curves[c]);
    return fade(task.out, EaseWeight<T>::at(elapsed, duration), joints);
  }
  void travel();
  JointJet<T> travel_jet(const TravelVelocity<T>& travel);

  const GraphPoseJob<T>& job_;
  const Graph& graph_;
  GraphBlock<T> block_;
  GraphScratch<T>& s_;
  MovingTransform<T> place_;                  ///< where the character stands
  static constexpr double kLeastFade = 0.08;  ///< s
};

/// A velocity and acceleration in heading axes, in the world's.
template <class T>
void in_world(const TravelVelocity<T>& t, double heading, Vec3<double>& v, Vec3<double>& a) {
  const double c = portable::cos(heading), s = portable::sin(heading), turn = double(t.velocity[2]);
  const double x = double(t.velocity[0]), y = double(t.velocity[1]);
  const double ax = double(t.change[0]) - turn * y, ay = double(t.change[1]) + turn * x;
  v << c * x - s * y, s * x + c * y, 0;
  a << c * ax - s * ay, s * ax + c * ay, 0;
}

/// Where the character stands, and how it moves over the ground with that travel.
template <class T>
JointJet<T> Pose<T>::travel_jet(const TravelVelocity<T>& now) {
  const GraphHeader<T>& header = block_.header();
  Vec3<double> v, a;
  in_world(now, header.heading, v, a);
  JointJet<T> travel;
  const double half = header.heading / 2;
  travel.rotation = Quat<T>(T(portable::cos(half)), T(0), T(0), T(portable::sin(half)));
  travel.omega = {T(0), T(0), now.velocity[2]};
  travel.alpha = {T(0), T(0), now.change[2]};
  const TimeJet<T> height = level();
  travel.translation = {T(header.place[0]), T(header.place[1]), height.value};
  travel.velocity = v.cast<T>();
  travel.acceleration = a.cast<T>();
  travel.velocity.z() = height.rate;
  travel.acceleration.z() = height.acceleration;
  return travel;
}

/// Moves the character and puts its body there.
template <class T>
void Pose<T>::travel() {
  const Register& pose = at(0);
  copy_jets<T>(pose.jets, job_.jets);
  std::copy_n(pose.curves.begin(), std::min(job_.curves.size(), pose.curves.size()), job_.curves.begin());
  GraphHeader<T>& header = block_.header();
  const TravelVelocity<T> before = header.travel, &now = pose.travel;
  const double h = double(s_.h);
  Vec3<double> v0, a0, v1, a1;
  in_world(before, header.heading, v0, a0);
  if (h > 0)
    header.heading += h / 2 * double(before.velocity[2] + now.velocity[2]) +
                      h * h / 12 * double(before.change[2] - now.change[2]);
  in_world(now, header.heading, v1, a1);
  if (h > 0)
    for (int k = 0; k < 2; ++k) header.place[k] += h / 2 * (v0[k] + v1[k]) + h * h / 12 * (a0[k] - a1[k]);
  header.travel = now;
  place_ = moving_transform(travel_jet(now));
  job_.jets[0] = joint_jet<T>(place_ * moving_transform(job_.jets[0]));
}

}  // namespace

template <class T>
Status GraphPoseJob<T>::Validate() const {
  if (Status status = check_block<T>(graph, state, true); !status) return status;
  if (Status status = check_scratch(*graph, scratch); !status) return status;
  if (jets.empty() || jets.size() > std::size_t(graph->joint_count()))
    return Status::error(Code::kInvalidArgument, "no joints to pose, or more than the graph has");
  bool wants_physical = false;
  for (int k = 0; k < scratch->task_count; ++k)
    wants_physical |= scratch->tasks[std::size_t(k)].kind == GraphTask::Kind::kPhysical;
  if (wants_physical && physical.size() < std::size_t(graph->joint_count()))
    return Status::error(Code::kInvalidArgument, "the graph asks for the physical pose, which is not given");
  return {};
}

template <class T>
Status GraphPoseJob<T>::Run() const {
  if (Status status = Validate(); !status) return status;
  return Pose<T>(*this).run();
}

template struct GraphPoseJob<float>;
template struct GraphPoseJob<double>;

}  // namespace sinew
