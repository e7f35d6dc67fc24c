#include "convert/fit/clip_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "convert/fit/chain_error.h"
#include "convert/fit/curve_search.h"
#include "sinew/animation/sampling_job.h"

namespace sinew::convert {
namespace {

using Samples = std::vector<std::vector<Transform<double>>>;

/// [frame] of all samples: when they are, 0 at the first and 1 at the last.
std::vector<double> instants_of(const FitInput& input) {
  std::vector<double> instants;
  const double last = static_cast<double>(input.samples.size() - 1);
  for (std::size_t f = 0; f < input.samples.size(); ++f)
    instants.push_back(input.times.empty() ? double(f) / last : input.times[f] / input.times.back());
  return instants;
}

/// Spans of the finest knots: one per interval of even samples; of uneven ones doubled until they are as
/// close as the closest samples.
int finest_spans(const FitInput& input) {
  if (input.times.empty()) return static_cast<int>(input.samples.size()) - 1;
  const double duration = input.times.back();
  double closest = duration;
  for (std::size_t f = 1; f < input.times.size(); ++f)
    closest = std::min(closest, input.times[f] - input.times[f - 1]);
  int spans = std::max(1, static_cast<int>(std::lround(duration * input.sample_rate)));
  while (spans * closest < 0.99 * duration) spans *= 2;  // but for rounding
  return spans;
}

/// What curves have to follow: of a loop all but the last sample, which is the first again, and of its root
/// not what it travels.
Samples to_follow(Samples samples, const std::vector<double>& instants, bool loops,
                  const Vec3<double>& step) {
  if (loops) samples.pop_back();
  for (std::size_t f = 0; f < samples.size(); ++f) samples[f][0].translation -= instants[f] * step;
  return samples;
}

CurveBudget budget_of(const FitOptions& options) {
  CurveBudget budget;
  budget.error = options.max_error_mm / 1000;
  budget.skin_distance = options.skin_distance;
  budget.angular = options.angular_acceleration;
  budget.linear = options.linear_acceleration;
  budget.share = options.acceleration_share;
  budget.degree = options.degree;
  return budget;
}

/// Tracks of like knots make a group; what rounding has left no motion is a constant.
void add_groups(const CurveSearch& search, int degree, Clip& clip) {
  clip.constants = search.constants();
  std::map<std::pair<int, bool>, std::vector<const FittedTrack*>> groups;
  for (const CurveSearch::Channel& channel : search.channels()) {
    const FittedTrack& track = channel.track;
    if (track.moves()) {
      groups[{track.controls(), track.rotation()}].push_back(&track);
      continue;
    }
    Transform<double> still = clip.constants[track.joint()].cast<double>();
    track.play(0, still);
    clip.constants[track.joint()] = still.cast<float>();
  }
  for (const auto& [key, tracks] : groups) {
    Clip::Group& group = clip.groups.emplace_back();
    group.rotation = key.second;
    group.degree = degree;
    group.control_count = tracks.front()->controls();
    group.knot_interval =
        clip.duration / static_cast<float>(clip.loops ? group.control_count : group.control_count - degree);
    for (const FittedTrack* track : tracks) {
      group.tracks.push_back({track->joint()});
      group.packings.push_back(track->packing());
    }
    for (int c = 0; c < group.control_count; ++c)
      for (const FittedTrack* track : tracks) track->append_control(c, group.controls);
  }
}

/// As FitReport::reference.
Clip reference_of(CurveSearch& search, const Clip& clip) {
  Clip reference = clip;
  reference.groups.clear();
  for (const CurveSearch::Channel& channel : search.channels()) {
    const KnotGrid& grid = search.reference_grid(channel);
    Clip::Group& group = reference.groups.emplace_back();
    group.rotation = channel.track.rotation();
    group.degree = grid.degree();
    group.control_count = grid.controls();
    group.knot_interval = clip.duration / static_cast<float>(grid.spans());
    group.tracks = {{channel.track.joint()}};
    for (const Eigen::Vector4f& control : channel.track.smooth_controls(grid))
      group.controls.insert(group.controls.end(), control.data(), control.data() + (group.rotation ? 4 : 3));
  }
  return reference;
}

/// The clip as samplers play it, against the samples.
void measure(const Clip& clip, const FitInput& input, const std::vector<double>& instants,
             double skin_distance, FitReport& report) {
  Samples samples = input.samples;
  if (clip.loops) samples.pop_back();
  ChainError chain(samples, input.parents, skin_distance);
  std::vector<JointMotion> played(clip.constants.size(), JointMotion(samples.size()));
  std::vector<Transform<double>> pose(clip.constants.size());
  for (std::size_t f = 0; f < samples.size(); ++f) {
    (void)SamplingJob<double>{&clip, instants[f] * clip.duration, {}, pose}.Run();
    for (std::size_t j = 0; j < pose.size(); ++j) played[j][f] = pose[j];
  }
  for (std::size_t j = 0; j < played.size(); ++j) chain.set(static_cast<int>(j), std::move(played[j]));
  chain.update();
  for (int j = 0; j < chain.joints(); ++j) {
    const int frame = chain.worst_frame(j);
    report.joints[j] = {1000 * chain.error(j, frame), 1000 * chain.rms(j)};
    if (report.joints[j].max_mm <= report.max_mm) continue;
    report.max_mm = report.joints[j].max_mm;
    report.worst_joint = j;
    report.worst_time = instants[frame] * double(clip.duration);
  }
  report.rms_mm = 1000 * chain.rms();
}

}  // namespace

Clip fit_clip(const FitInput& input, const FitOptions& options, FitReport& report) {
  const int frames = static_cast<int>(input.samples.size());
  Clip clip;
  clip.name = input.name;
  clip.joint_count = static_cast<int>(input.samples.front().size());
  clip.duration =
      static_cast<float>(input.times.empty() ? (frames - 1) / input.sample_rate : input.times.back());
  clip.loops = input.loops && frames > 6;
  report = {};
  report.joints.resize(input.samples.front().size());
  for (const Transform<double>& x : input.samples.front()) clip.constants.push_back(x.cast<float>());
  if (frames < 2) return clip;

  Vec3<double> step = Vec3<double>::Zero();
  if (clip.loops) step = input.samples.back()[0].translation - input.samples.front()[0].translation;
  clip.root_step = step.cast<float>();
  const std::vector<double> instants = instants_of(input);
  CurveSearch search(to_follow(input.samples, instants, clip.loops, step), instants, finest_spans(input),
                     input.parents, input.rest, clip.duration, clip.loops, budget_of(options));
  search.run();
  add_groups(search, options.degree, clip);
  measure(clip, input, instants, options.skin_distance, report);
  report.reference = reference_of(search, clip);
  return clip;
}

}  // namespace sinew::convert
