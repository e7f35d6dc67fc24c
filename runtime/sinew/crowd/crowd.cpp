#include "sinew/crowd/crowd.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sinew/animation/crossfade.h"
#include "sinew/animation/kernels/layout.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/crowd/instant.h"
#include "sinew/crowd/rig.h"

namespace sinew {
namespace {

/// A cache line; vectors of them are aligned as the kernels want.
struct alignas(64) Line {
  float numbers[16];
};

struct Kernels {
  void (*sample)(const crowd_kernels::Instant&, const crowd_kernels::JetRows&);
  void (*check)(const check_kernels::Rig&, const check_kernels::Batch&);
};

Kernels kernels_of(InstructionSet set, int lanes) {
  namespace of_clip = crowd_kernels;
  namespace of_motion = check_kernels;
  const bool eight = lanes == 8;
#ifdef __x86_64__
  if (set == InstructionSet::kAvx512)
    return eight ? Kernels{of_clip::avx512::sample8, of_motion::avx512::check8}
                 : Kernels{of_clip::avx512::sample16, of_motion::avx512::check16};
  if (set == InstructionSet::kAvx2)
    return eight ? Kernels{of_clip::avx2::sample8, of_motion::avx2::check8}
                 : Kernels{of_clip::avx2::sample16, of_motion::avx2::check16};
#endif
  (void)set;
  return eight ? Kernels{of_clip::baseline::sample8, of_motion::baseline::check8}
               : Kernels{of_clip::baseline::sample16, of_motion::baseline::check16};
}

/// 1 / limit; a muscle that has nothing is overloaded by anything.
float inverse(float limit) {
  return limit > 0 ? 1 / limit : std::numeric_limits<float>::max();
}

}  // namespace

struct Crowd::Impl {
  /// What one part of the frame works in.
  struct Chunk {
    Line *scratch, *rows;
    crowd_kernels::Instant* instant;
    Transform<float>* unwanted;  ///< takes the poses of lanes that do not take part
  };

  Skeleton skeleton;
  CrowdSettings settings;
  CrowdRig rig;
  Kernels kernels;
  int lanes, batches, joints, lines;  ///< lines: of one array [dof][lane]
  std::vector<CrowdTrack> tracks;     ///< [character]
  std::vector<float> strength;        ///< [character] see set_strength()
  std::vector<std::uint8_t> active;
  std::vector<std::uint8_t> stale;                        ///< [character] jets are not those of its track
  std::vector<JointJet<float>> jets;                      ///< [character][joint]
  std::vector<Transform<float>> models;                   ///< [character][joint]
  std::vector<Line> inverse_plus, inverse_minus, torque;  ///< [batch][dof][lane]
  std::vector<Line> peak;                                 ///< [batch][lane]
  std::vector<Line> velocity;                             ///< [batch][3][lane] of the roots
  std::vector<Line> scratch;                              ///< [chunk] room for the kernels
  std::vector<Line> rows;                                 ///< [chunk] jets of a batch
  std::vector<crowd_kernels::Instant> instant;            ///< [chunk]
  std::vector<Transform<float>> unwanted;                 ///< [chunk][joint]
  std::vector<int> overloaded;
  double step = 0;

  Impl(const Skeleton& s, const CrowdSettings& c)
      : skeleton(s), settings(c), rig(skeleton, settings), joints(int(s.joints.size())) {
    lanes = c.lanes != 0 ? c.lanes : (c.instruction_set == InstructionSet::kAvx512 ? 16 : 8);
    kernels = kernels_of(c.instruction_set, lanes);
    batches = (c.capacity + lanes - 1) / lanes;
    lines = (rig.tree.dofs * lanes + 15) / 16;
    const std::size_t padded = std::size_t(batches) * lanes;
    tracks.resize(padded);
    strength.resize(padded);
    active.resize(padded);
    stale.resize(padded);
    jets.resize(padded * joints);
    models.resize(padded * joints);
    for (auto* array : {&inverse_plus, &inverse_minus, &torque}) array->resize(std::size_t(batches) * lines);
    peak.resize(batches);
    velocity.resize(std::size_t(batches) * velocity_lines());
    scratch.resize(c.chunks * scratch_lines());
    rows.resize(c.chunks * row_lines());
    instant.resize(c.chunks);
    unwanted.resize(std::size_t(c.chunks) * joints);
    overloaded.reserve(c.capacity);
    for (std::size_t i = 0; i < padded; ++i) {
      rest(int(i));
      set_strength(int(i), 1);
    }
  }

  std::size_t scratch_lines() const {
    const std::size_t bytes =
        std::max(crowd_kernels::sample_scratch_bytes(joints),
                 check_kernels::check_scratch_bytes(rig.tree.bodies, joints, int(rig.support.points.size())));
    return (bytes + sizeof(Line) - 1) / sizeof(Line);
  }
  std::size_t row_lines() const { return crowd_kernels::row_bytes(joints) / sizeof(Line); }
  int velocity_lines() const { return (3 * lanes + 15) / 16; }
  JointJet<float>* jets_of(int character) { return jets.data() + std::size_t(character) * joints; }
  Transform<float>* model_of(int character) { return models.data() + std::size_t(character) * joints; }
  std::size_t dof_place(int character, int dof) const {
    return std::size_t(character / lanes) * lines * 16 + std::size_t(dof) * lanes + character % lanes;
  }
  static float& number(std::vector<Line>& array, std::size_t place) {
    return array[place / 16].numbers[place % 16];
  }

  void rest(int character) {
    for (int j = 0; j < joints; ++j) {
      const Transform<float> local = skeleton.joints[j].rest.cast<float>();
      JointJet<float>& jet = jets_of(character)[j];
      jet = {};
      jet.rotation = local.rotation;
      jet.translation = local.translation;
      const int parent = skeleton.joints[j].parent;
      model_of(character)[j] = parent < 0 ? local : model_of(character)[parent] * local;
    }
  }
  void set_strength(int character, float of_all) {
    strength[character] = of_all;
    for (int dof = 0; dof < rig.tree.dofs; ++dof) {
      number(inverse_plus, dof_place(character, dof)) = inverse(rig.torque_plus[dof] * of_all);
      number(inverse_minus, dof_place(character, dof)) = inverse(rig.torque_minus[dof] * of_all);
    }
  }

  /// Jets of a character from its track, where it is now.
  void sample(int character) {
    const CrowdTrack& track = tracks[character];
    const std::span out(jets_of(character), joints);
    (void)SamplingJob<float>{track.clip, track.time, out}.Run();
    place_root(track.place, out[0]);
    stale[character] = 0;
  }
  /// Moves the tracks of a batch on and finds where its jets are.
  void sample_batch(int first, const Chunk& chunk, check_kernels::Batch& batch) {
    bool together = true;
    for (int i = first; i < first + lanes; ++i) {
      if (!active[i]) continue;
      if (tracks[i].clip) tracks[i].time = tracks[i].time.after(step);
      stale[i] = tracks[i].clip != nullptr;
      together &= sampled_in_batches(tracks[i]);
    }
    if (together) {
      set_instant({tracks.data() + first, std::size_t(lanes)}, {active.data() + first, std::size_t(lanes)},
                  *chunk.instant);
      crowd_kernels::JetRows out;
      out.rows = chunk.rows->numbers;
      out.joints = joints;
      out.bodies = rig.tree.bodies;
      out.posed = settings.model_poses ? joints : out.bodies;
      out.scratch = chunk.scratch;
      kernels.sample(*chunk.instant, out);
      batch.rows = out.rows;
    } else {
      for (int i = first; i < first + lanes; ++i)
        if (active[i] && stale[i]) sample(i);
      for (int lane = 0; lane < lanes; ++lane) batch.jets[lane] = kernels::layout(jets_of(first + lane));
    }
  }
  void run_batch(int b, const Chunk& chunk) {
    const int first = b * lanes;
    if (std::find(active.begin() + first, active.begin() + first + lanes, 1) ==
        active.begin() + first + lanes)
      return;
    check_kernels::Batch batch;
    sample_batch(first, chunk, batch);
    for (int lane = 0; lane < lanes && settings.model_poses; ++lane)
      batch.model[lane] = kernels::layout(active[first + lane] ? model_of(first + lane) : chunk.unwanted);
    batch.inverse_plus = inverse_plus[std::size_t(b) * lines].numbers;
    batch.inverse_minus = inverse_minus[std::size_t(b) * lines].numbers;
    batch.torque = torque[std::size_t(b) * lines].numbers;
    batch.peak = peak[b].numbers;
    batch.velocity = velocity[std::size_t(b) * velocity_lines()].numbers;
    batch.scratch = chunk.scratch;
    kernels.check(rig.view, batch);
  }
  static void run_chunk(void* context, int index) {
    Impl& self = *static_cast<Impl*>(context);
    const auto begin_of = [&](int c) { return int(std::int64_t(self.batches) * c / self.settings.chunks); };
    const Chunk chunk{self.scratch.data() + index * self.scratch_lines(),
                      self.rows.data() + index * self.row_lines(), &self.instant[index],
                      self.unwanted.data() + std::size_t(index) * self.joints};
    for (int b = begin_of(index); b < begin_of(index + 1); ++b) self.run_batch(b, chunk);
  }
};

Crowd::Crowd(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Crowd::~Crowd() = default;

std::unique_ptr<Crowd> Crowd::create(const Skeleton& skeleton, const CrowdSettings& settings,
                                     Status& status) {
  status = validate(skeleton);
  if (!status) return nullptr;
  const auto refuse = [&](const char* reason) {
    status = Status::error(Code::kInvalidArgument, reason);
    return nullptr;
  };
  if (settings.capacity < 1 || settings.capacity > 10'000'000)
    return refuse("capacity is not within 1 and 10 million");
  if (settings.lanes != 0 && settings.lanes != 8 && settings.lanes != 16) return refuse("lanes are 8 or 16");
  if (settings.chunks < 1 || settings.chunks > 65536) return refuse("chunks are not within 1 and 65536");
  if (!available(settings.instruction_set)) return refuse("this processor lacks the instruction set");
  if (!settings.gravity.allFinite() || !std::isfinite(settings.ground_height))
    return refuse("gravity or ground is not finite");
  if (skeleton.body_count < 1) return refuse("rig has no bodies");
  return std::unique_ptr<Crowd>(new Crowd(std::make_unique<Impl>(skeleton, settings)));
}

namespace {

Status check_index(int character, int capacity) {
  if (character >= 0 && character < capacity) return {};
  return Status::error(Code::kInvalidArgument, "no such character", character);
}

}  // namespace

Status Crowd::play(int character, const CrowdTrack& track) {
  if (Status status = check_index(character, impl_->settings.capacity); !status) return status;
  if (track.clip) {
    if (track.clip->joint_count != impl_->joints)
      return Status::error(Code::kInvalidArgument, "clip has another number of joints than the rig",
                           character);
    if (Status status = SamplingJob<float>{track.clip, track.time}.Validate(); !status) return status;
  }
  if (!track.place.rotation.coeffs().allFinite() || !track.place.translation.allFinite())
    return Status::error(Code::kNotFinite, "place is not finite", character);
  if (!track.clip && impl_->stale[character]) impl_->sample(character);  // the host goes on from there
  impl_->tracks[character] = track;
  impl_->active[character] = 1;
  return {};
}

Status Crowd::set_active(int character, bool active) {
  if (Status status = check_index(character, impl_->settings.capacity); !status) return status;
  impl_->active[character] = active;
  return {};
}

Status Crowd::stop(int character) {
  if (Status status = check_index(character, impl_->settings.capacity); !status) return status;
  impl_->tracks[character] = {};
  impl_->active[character] = impl_->stale[character] = 0;
  impl_->rest(character);
  impl_->set_strength(character, 1);
  return {};
}

Status Crowd::set_strength(int character, float strength) {
  if (Status status = check_index(character, impl_->settings.capacity); !status) return status;
  if (!(strength >= 0)) return Status::error(Code::kInvalidArgument, "strength must be ≥ 0", character);
  impl_->set_strength(character, strength);
  return {};
}

float Crowd::strength(int character) const {
  return impl_->strength[character];
}

Status Crowd::step(double h, const ParallelFor& parallel_for) {
  if (!(h >= 0 && h <= 1)) return Status::error(Code::kOutOfRange, "step is not within 0 and 1 s");
  Impl& impl = *impl_;
  impl.step = h;
  parallel_for(impl.settings.chunks, Impl::run_chunk, &impl);
  impl.overloaded.clear();
  for (int b = 0; b < impl.batches; ++b)
    for (int lane = 0; lane < impl.lanes; ++lane) {
      const int character = b * impl.lanes + lane;
      if (impl.active[character] && !(impl.peak[b].numbers[lane] <= 1)) impl.overloaded.push_back(character);
    }
  return {};
}

std::span<const int> Crowd::overloaded() const {
  return impl_->overloaded;
}
float Crowd::peak_load(int character) const {
  return impl_->peak[character / impl_->lanes].numbers[character % impl_->lanes];
}
float Crowd::torque(int character, int dof) const {
  return Impl::number(impl_->torque, impl_->dof_place(character, dof));
}
int Crowd::dof_count() const {
  return impl_->rig.tree.dofs;
}
std::span<JointJet<float>> Crowd::jets(int character) {
  if (impl_->stale[character]) impl_->sample(character);
  return {impl_->jets_of(character), std::size_t(impl_->joints)};
}
Vec3<float> Crowd::root_velocity(int character) const {
  std::vector<Line>& velocity = impl_->velocity;
  const std::size_t at = std::size_t(character / impl_->lanes) * impl_->velocity_lines() * 16;
  Vec3<float> out;
  for (int a = 0; a < 3; ++a)
    out[a] = Impl::number(velocity, at + std::size_t(a * impl_->lanes + character % impl_->lanes));
  return out;
}
std::span<const Transform<float>> Crowd::model(int character) const {
  return {impl_->model_of(character), std::size_t(impl_->joints)};
}
const CrowdTrack& Crowd::track(int character) const {
  return impl_->tracks[character];
}

}  // namespace sinew
