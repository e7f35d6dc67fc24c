#include "sinew/graph/graph_recorder.h"

#include <cstring>

namespace sinew {
namespace {

constexpr std::uint64_t kMagic = 0x31474e4952574e53u;  // "SNWRING1"
constexpr std::uint32_t kMostRays = 64, kMostBodies = 8;

/// At the begin of a recording.
struct RingHeader {
  std::uint64_t magic, hash, slot_bytes;
  std::uint64_t frames;  ///< ever recorded
};
constexpr std::size_t kHeader = (sizeof(RingHeader) + 15) / 16 * 16;

template <class T>
struct RecordedRay {
  GroundHit<T> hit;
  int met;
};

std::size_t rounded(std::size_t bytes) {
  return (bytes + 15) / 16 * 16;
}

template <class T>
GraphRecordingLayout recording_layout(const Graph& graph) {
  const auto& nodes = graph.definition().nodes;
  const auto any = [&](auto test) { return std::any_of(nodes.begin(), nodes.end(), test); };
  const bool physical = any([](const GraphNode& n) { return n.type == NodeType::kPhysical; });
  const bool budget = any([](const GraphNode& n) {
    return std::any_of(n.transitions.begin(), n.transitions.end(),
                       [](const GraphTransition& t) { return t.budget > 0; });
  });
  const std::size_t joints = std::size_t(graph.joint_count()), feet = graph.feet().node >= 0;
  GraphRecordingLayout at;
  std::size_t end = rounded(sizeof(GraphFrame<T>));
  const auto place = [&](std::size_t bytes) {
    const std::size_t begin = end;
    end += rounded(bytes);
    return begin;
  };
  at.block = place(graph.state_bytes<T>());
  at.rays = place(feet * kMostRays * sizeof(RecordedRay<T>));
  at.bodies = place(feet * kMostBodies * sizeof(MovingTransform<T>));
  at.physical = place(physical ? joints * sizeof(JointJet<T>) : 0);
  at.spare = place(budget ? joints * sizeof(T) : 0);
  at.slot = end;
  return at;
}

/// Number by number: a recording has no bytes of chance.
template <class T>
void copy_jet(const JointJet<T>& from, JointJet<T>& to) {
  to.rotation = from.rotation;
  to.omega = from.omega;
  to.alpha = from.alpha;
  to.translation = from.translation;
  to.velocity = from.velocity;
  to.acceleration = from.acceleration;
}
template <class T>
void copy_hit(const GroundHit<T>& from, GroundHit<T>& to) {
  to.point = from.point;
  to.normal = from.normal;
  to.ground = from.ground;
}

std::uint64_t mixed(std::uint64_t hash, std::uint64_t word) {
  hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
  return hash ^ (hash >> 29);
}
template <class T>
std::uint64_t digest_after(std::span<const std::byte> block, std::span<const JointJet<T>> jets) {
  std::uint64_t hash = digest_of(block);
  const auto mix = [&](const auto& numbers) {
    for (int k = 0; k < numbers.size(); ++k) {
      std::uint64_t word = 0;
      const T number = numbers[k];
      std::memcpy(&word, &number, sizeof number);
      hash = mixed(hash, word);
    }
  };
  for (const JointJet<T>& jet : jets) {
    mix(jet.rotation.coeffs());
    for (const Vec3<T>* v : {&jet.omega, &jet.alpha, &jet.translation, &jet.velocity, &jet.acceleration})
      mix(*v);
  }
  return hash;
}

template <class V>
V* in(std::byte* slot, std::size_t offset) {
  return reinterpret_cast<V*>(slot + offset);
}
template <class V>
const V* in(const std::byte* slot, std::size_t offset) {
  return reinterpret_cast<const V*>(slot + offset);
}

/// Stands between the graph and what its rays meet.
template <class T>
struct Tap {
  GraphGround<T> ground;
  GraphFrame<T>* frame;
  RecordedRay<T>* rays;

  static bool below(const void* self, const Vec3<T>& point, GroundHit<T>& hit) {
    const Tap& tap = *static_cast<const Tap*>(self);
    const bool met = tap.ground.below(tap.ground.host, point, hit);
    if (tap.frame->rays >= kMostRays) {
      tap.frame->complete = false;
      return met;
    }
    RecordedRay<T>& ray = tap.rays[tap.frame->rays++];
    copy_hit(hit, ray.hit);
    ray.met = met;
    return met;
  }
};

/// Gives the recorded answers in their order.
template <class T>
struct Answers {
  const RecordedRay<T>* rays;
  std::uint32_t count;
  mutable std::uint32_t given = 0;

  static bool below(const void* self, const Vec3<T>&, GroundHit<T>& hit) {
    const Answers& answers = *static_cast<const Answers*>(self);
    if (answers.given >= answers.count) return false;
    const RecordedRay<T>& ray = answers.rays[answers.given++];
    copy_hit(ray.hit, hit);
    return ray.met != 0;
  }
};

RingHeader header_of(std::span<const std::byte> bytes) {
  RingHeader header{};
  if (bytes.size() >= sizeof header) std::memcpy(&header, bytes.data(), sizeof header);
  return header;
}

std::size_t slots_in(std::size_t bytes, std::size_t slot) {
  return bytes < kHeader ? 0 : (bytes - kHeader) / slot;
}

}  // namespace

std::uint64_t digest_of(std::span<const std::byte> bytes, std::uint64_t seed) {
  for (std::size_t k = 0; k + 8 <= bytes.size(); k += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + k, 8);
    seed = mixed(seed, word);
  }
  return seed;
}

template <class T>
std::size_t GraphRecorder<T>::bytes_for(const Graph& graph, int frames) {
  return kHeader + std::size_t(std::max(0, frames)) * recording_layout<T>(graph).slot;
}

template <class T>
GraphRecorder<T>::GraphRecorder(const Graph& graph, std::span<std::byte> buffer)
    : at_(recording_layout<T>(graph)), buffer_(buffer) {
  if (reinterpret_cast<std::uintptr_t>(buffer.data()) % 16 != 0 || slots_in(buffer.size(), at_.slot) == 0) {
    buffer_ = {};
    return;
  }
  const RingHeader header = header_of(buffer);
  if (header.magic == kMagic && header.hash == graph.hash() && header.slot_bytes == at_.slot) return;
  std::memset(buffer_.data(), 0, buffer_.size());
  const RingHeader begun{kMagic, graph.hash(), at_.slot, 0};
  std::memcpy(buffer_.data(), &begun, sizeof begun);
}

template <class T>
std::byte* GraphRecorder<T>::next() {
  RingHeader& header = *in<RingHeader>(buffer_.data(), 0);
  std::byte* slot = buffer_.data() + kHeader + header.frames % slots_in(buffer_.size(), at_.slot) * at_.slot;
  std::memset(slot, 0, at_.slot);
  GraphFrame<T>& frame = *in<GraphFrame<T>>(slot, 0);
  frame.number = header.frames++;
  frame.complete = true;
  return slot;
}

template <class T>
void GraphRecorder<T>::keep(const GraphStepJob<T>& job, std::byte* slot) const {
  GraphFrame<T>& frame = *in<GraphFrame<T>>(slot, 0);
  frame.h = job.h;
  frame.joints = static_cast<std::uint32_t>(job.jets.size());
  std::memcpy(slot + at_.block, job.state.data(), std::min(job.state.size(), at_.rays - at_.block));
  const std::size_t joints = std::size_t(job.graph->joint_count());
  if (at_.spare > at_.physical && job.physical.size() >= joints) {
    frame.physical = true;
    for (std::size_t j = 0; j < joints; ++j)
      copy_jet(job.physical[j], in<JointJet<T>>(slot, at_.physical)[j]);
  }
  if (at_.slot > at_.spare && job.spare_acceleration.size() >= joints) {
    frame.spare = true;
    std::copy_n(job.spare_acceleration.begin(), joints, in<T>(slot, at_.spare));
  }
  if (at_.bodies == at_.rays) return;  // no feet
  frame.ground = job.ground.below != nullptr;
  frame.bodies = static_cast<std::uint32_t>(std::min<std::size_t>(job.ground.bodies.size(), kMostBodies));
  frame.complete = job.ground.bodies.size() <= kMostBodies;
  for (std::uint32_t k = 0; k < frame.bodies; ++k) {
    MovingTransform<T>& body = in<MovingTransform<T>>(slot, at_.bodies)[k];
    body.rotation.value = job.ground.bodies[k].rotation.value;
    body.rotation.omega = job.ground.bodies[k].rotation.omega;
    body.rotation.alpha = job.ground.bodies[k].rotation.alpha;
    body.translation = job.ground.bodies[k].translation;
  }
}

template <class T>
Status GraphRecorder<T>::step(const GraphStepJob<T>& job) {
  if (buffer_.empty() || !job.graph) return job.Run();
  if (Status status = check_block<T>(job.graph, job.state, true); !status) return status;
  std::byte* slot = next();
  keep(job, slot);
  GraphFrame<T>& frame = *in<GraphFrame<T>>(slot, 0);
  const Tap<T> tap{job.ground, &frame, in<RecordedRay<T>>(slot, at_.rays)};
  GraphStepJob<T> tapped = job;
  if (frame.ground) {
    tapped.ground.below = Tap<T>::below;
    tapped.ground.host = &tap;
  }
  const Status status = tapped.Run();
  frame.digest = digest_after<T>(job.state, job.jets);
  return status;
}

template <class T>
GraphReplay<T>::GraphReplay(const Graph& graph, std::span<const std::byte> recording)
    : graph_(graph), at_(recording_layout<T>(graph)), bytes_(recording) {}

template <class T>
Status GraphReplay<T>::Validate() const {
  const RingHeader header = header_of(bytes_);
  if (header.magic != kMagic) return Status::error(Code::kBadFile, "no recording of a graph");
  if (header.hash != graph_.hash() || header.slot_bytes != at_.slot)
    return Status::error(Code::kBadFile, "recording of another graph, asset or precision");
  if (slots_in(bytes_.size(), at_.slot) == 0 || (bytes_.size() - kHeader) % at_.slot != 0 ||
      reinterpret_cast<std::uintptr_t>(bytes_.data()) % 16 != 0)
    return Status::error(Code::kBadFile, "recording is cut off, or does not begin at a multiple of 16");
  return {};
}

template <class T>
int GraphReplay<T>::count() const {
  if (!Validate()) return 0;
  return static_cast<int>(
      std::min<std::uint64_t>(header_of(bytes_).frames, slots_in(bytes_.size(), at_.slot)));
}

template <class T>
const std::byte* GraphReplay<T>::slot(int k) const {
  const std::uint64_t first = header_of(bytes_).frames - std::uint64_t(count());
  return bytes_.data() + kHeader + (first + std::uint64_t(k)) % slots_in(bytes_.size(), at_.slot) * at_.slot;
}

template <class T>
GraphFrame<T> GraphReplay<T>::info(int k) const {
  return k >= 0 && k < count() ? *in<GraphFrame<T>>(slot(k), 0) : GraphFrame<T>{};
}

template <class T>
std::span<const std::byte> GraphReplay<T>::before(int k) const {
  if (k < 0 || k >= count()) return {};
  return {slot(k) + at_.block, graph_.state_bytes<T>()};
}

template <class T>
bool GraphReplay<T>::ray(int k, int ray, GroundHit<T>& hit) const {
  if (ray < 0 || static_cast<std::uint32_t>(ray) >= std::min(info(k).rays, kMostRays)) return false;
  const RecordedRay<T>& recorded = in<RecordedRay<T>>(slot(k), at_.rays)[ray];
  copy_hit(recorded.hit, hit);
  return recorded.met != 0;
}

template <class T>
Status GraphReplay<T>::frame(int k, GraphScratch<T>& scratch, std::span<std::byte> state,
                             std::span<JointJet<T>> jets, bool& same, EventSink* events) const {
  same = false;
  if (Status status = Validate(); !status) return status;
  if (k < 0 || k >= count()) return Status::error(Code::kOutOfRange, "no such frame", k);
  if (Status status = check_block<T>(&graph_, state, false); !status) return status;
  const GraphFrame<T> frame = info(k);
  if (!frame.complete) return Status::error(Code::kOutOfRange, "frame had more rays or bodies than room", k);
  if (frame.joints > jets.size()) return Status::error(Code::kInvalidArgument, "fewer joints than posed", k);
  const std::size_t joints = std::size_t(graph_.joint_count());
  std::memcpy(state.data(), before(k).data(), state.size());
  const Answers<T> answers{in<RecordedRay<T>>(slot(k), at_.rays), std::min(frame.rays, kMostRays)};
  GraphStepJob<T> job{&graph_, state, frame.h, &scratch, jets.first(frame.joints), events};
  if (frame.physical) job.physical = {in<JointJet<T>>(slot(k), at_.physical), joints};
  if (frame.spare) job.spare_acceleration = {in<T>(slot(k), at_.spare), joints};
  if (frame.ground) job.ground = {Answers<T>::below, &answers};
  job.ground.bodies = {in<MovingTransform<T>>(slot(k), at_.bodies), std::min(frame.bodies, kMostBodies)};
  const Status status = job.Run();
  same = digest_after<T>(state, job.jets) == frame.digest;
  return status;
}

template class GraphRecorder<float>;
template class GraphRecorder<double>;
template class GraphReplay<float>;
template class GraphReplay<double>;

}  // namespace sinew
