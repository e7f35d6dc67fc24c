#include "sinew/graph/graph_recorder.h"

#include <array>
#include <cstring>

#include "sinew/graph/recorded_frame.h"

namespace sinew {
namespace {

using namespace recorded;

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

template <class T>
std::size_t most_bytes(const Graph& graph) {
  return most_frame_bytes<T>(graph.state_bytes<T>(), graph.joint_count(), graph.feet().node >= 0);
}

/// Of a frame on average.
template <class T>
std::size_t usual_bytes(const Graph& graph) {
  return (graph.feet().node >= 0 ? 150 : 100) * sizeof(T) / sizeof(float);
}

/// Of a page for so many of them.
template <class T>
std::size_t page_bytes(const Graph& graph, std::size_t frames) {
  return rounded(sizeof(PageHead) + graph.state_bytes<T>() + frames * usual_bytes<T>(graph) +
                 most_bytes<T>(graph));  // which has to be free for the next one to begin
}

/// What stands between the graph and its host, and writes down what that answers.
template <class T>
struct Tap {
  const GraphStepJob<T>& job;
  FrameHead<T>& head;
  FrameWriter<T>& out;
  std::array<T, kMostDurations> durations;

  static bool below(const void* self, const Vec3<T>& point, GroundHit<T>& hit) {
    const Tap& tap = *static_cast<const Tap*>(self);
    const bool met = tap.job.ground.below(tap.job.ground.host, point, hit);
    if (tap.head.rays >= kMostRays) {
      tap.head.set(kIncomplete);
    } else {
      ++tap.head.rays;
      tap.out.ray(point, hit, met);
    }
    return met;
  }
  static T duration(void* self, const FadeQuestion<T>& question) {
    Tap& tap = *static_cast<Tap*>(self);
    const T answer = tap.job.muscles.duration(tap.job.muscles.host, question);
    if (tap.head.durations >= kMostDurations)
      tap.head.set(kIncomplete);
    else
      tap.durations[tap.head.durations++] = answer;
    return answer;
  }
};

/// What the frame made use of besides, behind what its rays met.
template <class T>
void keep_rest(const Tap<T>& tap, const GraphScratch<T>& scratch) {
  const GraphStepJob<T>& job = tap.job;
  const std::size_t joints = std::size_t(job.graph->joint_count());
  for (std::uint32_t k = 0; k < tap.head.durations; ++k) tap.out.number(tap.durations[k]);
  if (job.graph->feet().node >= 0) {
    const std::size_t bodies = std::min(job.ground.bodies.size(), kMostBodies);
    if (bodies < job.ground.bodies.size()) tap.head.set(kIncomplete);
    tap.head.bodies = static_cast<std::uint8_t>(bodies);
    for (std::size_t k = 0; k < bodies; ++k) tap.out.body(job.ground.bodies[k]);
  }
  if (scratch.shows_physical && job.physical.size() >= joints) {
    tap.head.set(kPhysical);
    for (std::size_t j = 0; j < joints; ++j) tap.out.jet(job.physical[j]);
  }
}

RingHead ring_of(std::span<const std::byte> bytes) {
  RingHead ring{};
  if (bytes.size() >= sizeof ring) std::memcpy(&ring, bytes.data(), sizeof ring);
  return ring;
}

/// The page that is written.
std::byte* page_of(std::span<std::byte> buffer, std::size_t block_bytes) {
  const RingHead& ring = *reinterpret_cast<RingHead*>(buffer.data());
  return buffer.data() + pages_begin(block_bytes) + ring.page * ring.page_bytes;
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
  const std::size_t wanted = std::size_t(std::max(0, frames)), full = kMostFrames;
  const std::size_t before = pages_begin(graph.state_bytes<T>());
  if (wanted <= 2 * full) return before + (wanted > 0 ? 3 : 0) * page_bytes<T>(graph, (wanted + 1) / 2);
  return before + ((wanted + full - 1) / full + 1) * page_bytes<T>(graph, full);
}

template <class T>
GraphRecorder<T>::GraphRecorder(const Graph& graph, std::span<std::byte> buffer)
    : block_bytes_(graph.state_bytes<T>()), most_(most_bytes<T>(graph)), buffer_(buffer) {
  const std::size_t before = pages_begin(block_bytes_);
  const std::size_t room = buffer.size() < before ? 0 : buffer.size() - before;
  RingHead begun{};
  begun.magic = kMagic;
  begun.hash = graph.hash();
  begun.block_bytes = block_bytes_;
  begun.pages = std::max<std::size_t>(3, room / page_bytes<T>(graph, kMostFrames));
  begun.page_bytes = room / begun.pages / 16 * 16;
  if (reinterpret_cast<std::uintptr_t>(buffer.data()) % 16 != 0 ||
      begun.page_bytes < sizeof(PageHead) + most_ || most_ > kMostFrameBytes) {
    buffer_ = {};
    return;
  }
  const RingHead ring = ring_of(buffer);
  if (ring.same_layout(begun)) return;
  std::memset(buffer_.data(), 0, buffer_.size());
  std::memcpy(buffer_.data(), &begun, sizeof begun);
}

/// Where the next frame is written. `whole`: it begins a page.
template <class T>
std::byte* GraphRecorder<T>::begin_frame(bool whole) {
  RingHead& ring = *reinterpret_cast<RingHead*>(buffer_.data());
  if (whole) {
    if (ring.frames > 0) ring.page = (ring.page + 1) % ring.pages;
    std::memset(page_of(buffer_, block_bytes_), 0, ring.page_bytes);
    *reinterpret_cast<PageHead*>(page_of(buffer_, block_bytes_)) = {ring.frames, 0, sizeof(PageHead)};
  }
  std::byte* page = page_of(buffer_, block_bytes_);
  return page + reinterpret_cast<PageHead*>(page)->bytes;
}

template <class T>
Status GraphRecorder<T>::step(const GraphStepJob<T>& job) {
  if (buffer_.empty() || !job.graph || !job.scratch) return job.Run();
  if (Status status = check_block<T>(job.graph, job.state, true); !status) return status;
  RingHead& ring = *reinterpret_cast<RingHead*>(buffer_.data());
  const std::span<std::byte> after(buffer_.data() + rounded(sizeof(RingHead)), block_bytes_);
  const PageHead& last = *reinterpret_cast<PageHead*>(page_of(buffer_, block_bytes_));
  const bool whole = ring.frames == 0 || last.frames >= kMostFrames || last.bytes + most_ > ring.page_bytes ||
                     changed_bytes(after, job.state) > block_bytes_ / 4;
  std::byte* at = begin_frame(whole);
  FrameHead<T>& head = *new (at) FrameHead<T>;
  FrameWriter<T> out(at + sizeof head);
  head.h = job.h;
  head.joints = static_cast<std::uint16_t>(job.jets.size());
  if (whole) head.set(kWhole);
  head.patches = whole ? out.block(job.state) : out.changes(after, job.state);
  Tap<T> tap{job, head, out, {}};
  GraphStepJob<T> tapped = job;
  if (job.ground.below && job.graph->feet().node >= 0) {
    head.set(kGround);
    tapped.ground.below = Tap<T>::below;
    tapped.ground.host = &tap;
  }
  if (job.muscles.duration) {
    head.set(kMuscles);
    tapped.muscles = {Tap<T>::duration, &tap};
  }
  job.scratch->shows_physical = false;
  const std::byte* rays = out.end();
  const Status status = tapped.Run();
  head.ray_bytes = static_cast<std::uint16_t>(out.end() - rays);
  keep_rest(tap, *job.scratch);
  head.digest = digest_after<T>(job.state, job.jets);
  head.words = static_cast<std::uint16_t>(rounded(std::size_t(out.end() - at), 8) / 8);
  std::memcpy(after.data(), job.state.data(), block_bytes_);
  PageHead& now = *reinterpret_cast<PageHead*>(page_of(buffer_, block_bytes_));
  now.bytes += 8 * std::uint32_t(head.words);
  ++now.frames;
  ++ring.frames;
  return status;
}

template <class T>
GraphReplay<T>::GraphReplay(const Graph& graph, std::span<const std::byte> recording)
    : graph_(graph), bytes_(recording), block_(graph.state_bytes<T>()), status_(index()) {
  if (!status_.ok()) at_.clear();
}

/// Finds the frames, and looks at nothing that they hold.
template <class T>
Status GraphReplay<T>::index() {
  const RingHead ring = ring_of(bytes_);
  const std::size_t before = pages_begin(block_.size());
  if (ring.magic != kMagic) return Status::error(Code::kBadFile, "no recording of a graph");
  if (ring.hash != graph_.hash() || ring.block_bytes != block_.size())
    return Status::error(Code::kBadFile, "recording of another graph, asset or precision");
  if (bytes_.size() < before || ring.pages < 1 || ring.page >= ring.pages ||
      ring.page_bytes < sizeof(PageHead) ||
      (bytes_.size() - before) / ring.pages / 16 * 16 != ring.page_bytes ||
      reinterpret_cast<std::uintptr_t>(bytes_.data()) % 16 != 0)
    return Status::error(Code::kBadFile, "recording is cut off, or does not begin at a multiple of 16");
  const Status damaged = Status::error(Code::kBadFile, "recording is damaged");
  for (std::uint64_t n = 1; n <= ring.pages; ++n) {  // from the oldest page to the one that was written last
    const std::size_t at = before + (ring.page + n) % ring.pages * ring.page_bytes;
    PageHead page;
    std::memcpy(&page, bytes_.data() + at, sizeof page);
    if (page.frames == 0) continue;
    if (at_.empty()) first_ = page.first;
    if (page.first != first_ + at_.size() || page.bytes > ring.page_bytes) return damaged;
    std::size_t frame = sizeof(PageHead);
    for (std::uint32_t k = 0; k < page.frames; ++k) {
      FrameHead<T> head;
      if (frame + sizeof head > page.bytes) return damaged;
      std::memcpy(&head, bytes_.data() + at + frame, sizeof head);
      const std::size_t bytes = 8 * std::size_t(head.words);
      if (bytes < sizeof head || frame + bytes > page.bytes || head.has(kWhole) != (k == 0)) return damaged;
      at_.push_back(at + frame);
      frame += bytes;
    }
  }
  return {};
}

template <class T>
GraphFrame<T> GraphReplay<T>::info(int k) const {
  GraphFrame<T> out;
  if (k < 0 || k >= count()) return out;
  FrameHead<T> head;
  std::memcpy(&head, bytes_.data() + at_[std::size_t(k)], sizeof head);
  out.number = first_ + std::uint64_t(k);
  out.digest = head.digest;
  out.h = head.h;
  out.joints = head.joints;
  out.rays = head.rays;
  out.bodies = head.bodies;
  out.durations = head.durations;
  out.bytes = 8 * std::uint32_t(head.words);
  out.whole = head.has(kWhole);
  out.physical = head.has(kPhysical);
  out.ground = head.has(kGround);
  out.muscles = head.has(kMuscles);
  out.complete = !head.has(kIncomplete);
  return out;
}

/// Gives the recorded answers in their order. Of a ray that is kept which does not follow from where it was
/// cast, so it is read when it is asked for.
template <class T>
struct GraphReplay<T>::Answers {
  FrameReader<T> in;
  std::uint32_t rays_left = 0;
  std::vector<Ray>* rays = nullptr;
  std::span<const T> durations;
  std::size_t next_duration = 0;

  static bool below(const void* self, const Vec3<T>& point, GroundHit<T>& hit) {
    Answers& all = **static_cast<Answers* const*>(self);
    if (all.rays_left == 0) return false;
    --all.rays_left;
    const bool met = all.in.ray(point, hit);
    all.rays->push_back({hit, met});
    return met;
  }
  static T duration(void* self, const FadeQuestion<T>& question) {
    Answers& all = *static_cast<Answers*>(self);
    return all.next_duration < all.durations.size() ? all.durations[all.next_duration++] : question.most;
  }
};

/// Plays a frame from the block before it, which block_ holds but for what the game changed.
template <class T>
Status GraphReplay<T>::play(int k, GraphScratch<T>& scratch, std::span<JointJet<T>> jets, EventSink* events,
                            bool& same) {
  after_ = before_ = -1;
  same = false;
  const GraphFrame<T> frame = info(k);
  if (!frame.complete) return Status::error(Code::kOutOfRange, "frame had more rays or bodies than room", k);
  const std::size_t joints = std::size_t(graph_.joint_count());
  FrameReader<T> in(bytes_.subspan(at_[std::size_t(k)], frame.bytes));
  const FrameHead<T> head = in.head();
  std::array<T, kMostDurations> durations{};
  std::array<MovingTransform<T>, kMostBodies> bodies;
  std::vector<JointJet<T>> physical(frame.physical ? joints : 0);
  in.skip_block(head, block_.size());
  Answers answers{in, frame.rays, &rays_, {}};
  in.skip(head.ray_bytes);
  const std::size_t asked = std::min<std::size_t>(frame.durations, kMostDurations),
                    moving = std::min<std::size_t>(frame.bodies, kMostBodies);
  for (std::size_t n = 0; n < asked; ++n) durations[n] = in.number();
  for (std::size_t n = 0; n < moving; ++n) bodies[n] = in.body();
  for (JointJet<T>& jet : physical) jet = in.jet();
  if (!in.good()) return Status::error(Code::kBadFile, "recording is damaged", k);
  answers.durations = {durations.data(), asked};
  Answers* const host = &answers;
  GraphStepJob<T> job{&graph_, block_, frame.h, &scratch, jets.first(frame.joints), events};
  job.physical = physical;
  if (frame.ground) job.ground = {Answers::below, &host};
  job.ground.bodies = {bodies.data(), moving};
  if (frame.muscles) job.muscles = {Answers::duration, &answers};
  rays_.clear();
  const Status status = job.Run();
  same = answers.in.good() && digest_after<T>(block_, job.jets) == frame.digest;
  after_ = k;
  return status;
}

/// Makes block_ the one before a frame, from that after the one before it, or from nothing where it is whole.
template <class T>
bool GraphReplay<T>::set_block(int k) {
  FrameReader<T> in(bytes_.subspan(at_[std::size_t(k)], info(k).bytes));
  const FrameHead<T> head = in.head();
  return in.take_block(head, block_);
}

template <class T>
Status GraphReplay<T>::before(int k, GraphScratch<T>& scratch, std::span<std::byte> state,
                              std::span<JointJet<T>> jets) {
  if (!status_.ok()) return status_;
  if (k < 0 || k >= count()) return Status::error(Code::kOutOfRange, "no such frame", k);
  if (Status status = check_block<T>(&graph_, state, false); !status) return status;
  if (jets.size() < std::size_t(graph_.joint_count()))
    return Status::error(Code::kInvalidArgument, "not room for all joints", k);
  const Status damaged = Status::error(Code::kBadFile, "recording is damaged", k);
  if (before_ == k) return copy_block(state);
  int from = k;
  while (from > 0 && from - 1 != after_ && !info(from).whole) --from;
  for (; from < k; ++from) {
    bool same = false;
    if (!set_block(from)) return damaged;
    if (Status status = play(from, scratch, jets, nullptr, same); after_ != from) return status;
  }
  if (!set_block(k)) return damaged;
  after_ = -1;
  before_ = k;
  return copy_block(state);
}

template <class T>
Status GraphReplay<T>::copy_block(std::span<std::byte> state) const {
  std::memcpy(state.data(), block_.data(), block_.size());
  return {};
}

template <class T>
Status GraphReplay<T>::frame(int k, GraphScratch<T>& scratch, std::span<std::byte> state,
                             std::span<JointJet<T>> jets, bool& same, EventSink* events) {
  same = false;
  if (Status status = before(k, scratch, state, jets); !status) return status;
  const Status status = play(k, scratch, jets, events, same);
  if (after_ == k) (void)copy_block(state);
  return status;
}

template class GraphRecorder<float>;
template class GraphRecorder<double>;
template class GraphReplay<float>;
template class GraphReplay<double>;

}  // namespace sinew
