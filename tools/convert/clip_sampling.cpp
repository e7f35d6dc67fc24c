#include "convert/clip_sampling.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <set>

#include "convert/fit/chain_error.h"
#include "convert/skin.h"
#include "import/keys.h"

namespace sinew::convert {
namespace {

using import::interpolate;
using import::SourceChannel;
using import::SourceClip;
using import::SourceScene;
using Matrix = Eigen::Matrix4d;

constexpr double kClosest = 1.0 / 120;  ///< s between samples: no body moves so fast that it takes more
constexpr double kSameTime = 0.01;      ///< of a sample's time: 1 mm where 30 keys/s change speed by 3 m/s
constexpr double kMostSamples = 3e7;    ///< joints × frames of a clip: an hour of motion capture, 2 GB

double sampling_rate(const SourceClip& clip) {
  return std::clamp(clip.key_rate > 0 ? clip.key_rate : 30.0, 10.0, 1 / kClosest);
}

/// A key that moves nodes.
struct Key {
  double time = 0;  ///< s
  int tracks = 0;   ///< that have it
};

/// Keys in time; those at less than `merged` s count as one.
std::vector<Key> keys_of(const SourceClip& clip, double merged) {
  std::vector<double> all;
  for (const SourceChannel& c : clip.channels)
    for (const auto* times : {&c.position_times, &c.rotation_times, &c.scale_times})
      if (times->size() > 1) all.insert(all.end(), times->begin(), times->end());
  std::sort(all.begin(), all.end());
  std::vector<Key> keys;
  for (const double t : all)
    if (keys.empty() || t - keys.back().time > merged)
      keys.push_back({t, 1});
    else
      ++keys.back().tracks;
  return keys;
}

/// The keys of a clip that has some between even samples at `rate`, else none: those of most tracks first,
/// then the earlier.
std::vector<Key> uneven_keys(const SourceClip& clip, double rate) {
  constexpr double kMerged = 0.001;  // of a sample's time: numbers in files are no more exact
  if (!(clip.duration > 0)) return {};
  std::vector<Key> keys = keys_of(clip, kMerged / rate);
  const double even = std::round(clip.duration * rate) / clip.duration;  // ends with the clip
  if (std::all_of(keys.begin(), keys.end(), [&](const Key& k) {
        return std::abs(k.time * even - std::round(k.time * even)) <= kSameTime;
      }))
    return {};
  std::stable_sort(keys.begin(), keys.end(), [](const Key& x, const Key& y) { return x.tracks > y.tracks; });
  return keys;
}

/// Adds a time unless it is too close to another.
void add_time(double time, std::set<double>& times) {
  constexpr double kGap = (1 - kSameTime) * kClosest;
  const auto after = times.lower_bound(time);
  if ((after == times.end() || *after - time >= kGap) &&
      (after == times.begin() || time - *std::prev(after) >= kGap))
    times.insert(time);
}

/// The times, and between them instants about 1/rate apart.
std::vector<double> filled(const std::set<double>& times, double rate) {
  std::vector<double> out;
  for (const double time : times) {
    const double from = out.empty() ? 0 : out.back();
    const int parts = std::max(1, static_cast<int>(std::lround((time - from) * rate)));
    for (int k = 1; k < parts; ++k) out.push_back(from + k * (time - from) / parts);
    out.push_back(time);
  }
  return out;
}

/// The weights of morph targets, over the frames that are left. Those of one name move together: the first
/// mesh says how.
void add_morph_keys(const SourceScene& scene, const SourceClip& clip, Rig::Motion& motion,
                    nlohmann::json& report) {
  const double left_out = motion.begin - clip.begin;
  const double duration = motion.time(static_cast<int>(motion.samples.size()) - 1);
  for (const import::SourceMorphChannel& channel : clip.morphs) {
    const import::SourceMesh& mesh = scene.meshes[std::size_t(channel.mesh)];
    for (std::size_t m = 0; m < mesh.morphs.size(); ++m) {
      std::vector<std::pair<double, double>> keys;
      for (std::size_t k = 0; k < channel.times.size(); ++k) {
        const double time = std::clamp(channel.times[k] - left_out, 0.0, duration);
        if (!keys.empty() && time <= keys.back().first) keys.pop_back();
        keys.emplace_back(time, double(channel.weights[k * mesh.morphs.size() + m]));
      }
      const auto [known, is_new] = motion.morph_keys.emplace(morph_curve(mesh, m), keys);
      if (!is_new && known->second != keys)
        report["notes"].push_back("clip '" + clip.name + "': morph targets '" + known->first +
                                  "' of several meshes move apart; all move as the first does");
    }
  }
}

/// All joints at t, local; every joint's node is looked up in `nodes` (-1: not in this file, stays at rest).
std::vector<Transform<double>> pose_at(const SourceScene& scene, const SourceClip& clip, double t,
                                       const std::vector<int>& nodes, const Matrix& to_model,
                                       const Rig& rig) {
  const std::vector<Matrix> world = node_transforms(scene, &clip, t);
  std::vector<Transform<double>> model(rig.joints.size()), local(rig.joints.size());
  for (std::size_t j = 0; j < rig.joints.size(); ++j) {
    const int parent = rig.joints[j].parent;
    const Transform<double> rest_local =
        parent < 0 ? rig.joints[j].rest : rig.joints[parent].rest.inverse() * rig.joints[j].rest;
    model[j] = nodes[j] >= 0 ? rigid(to_model * world[nodes[j]])
                             : (parent < 0 ? rest_local : model[parent] * rest_local);
    local[j] = parent < 0 ? model[j] : model[parent].inverse() * model[j];
    local[j].rotation.normalize();
  }
  return local;
}

using Poses = std::vector<std::vector<Transform<double>>>;  ///< [time][joint]

/// How far lines between the samples of a motion pass by keys; `truth`: the poses at them.
ChainError passed_by(const Rig& rig, const Rig::Motion& motion, const std::vector<Key>& keys,
                     const Poses& truth, double skin_distance) {
  std::vector<int> parents;
  for (const Rig::Joint& joint : rig.joints) parents.push_back(joint.parent);
  ChainError chain(truth, parents, skin_distance);
  std::vector<double> times;
  for (std::size_t f = 0; f < motion.samples.size(); ++f) times.push_back(motion.time(static_cast<int>(f)));
  std::vector<JointMotion> lines(rig.joints.size());
  for (const Key& key : keys) {
    const auto later = std::lower_bound(times.begin() + 1, times.end() - 1, key.time);
    const std::size_t next = static_cast<std::size_t>(later - times.begin());
    const double u = (key.time - times[next - 1]) / (times[next] - times[next - 1]);
    for (std::size_t j = 0; j < lines.size(); ++j) {
      const Transform<double>&a = motion.samples[next - 1][j], &b = motion.samples[next][j];
      lines[j].push_back(
          {a.rotation.slerp(u, b.rotation), a.translation + u * (b.translation - a.translation)});
    }
  }
  for (std::size_t j = 0; j < lines.size(); ++j) chain.set(static_cast<int>(j), std::move(lines[j]));
  chain.update();
  return chain;
}

/// Joint of the largest error at a key.
int worst_joint(const ChainError& chain, int key) {
  int worst = 0;
  for (int j = 1; j < chain.joints(); ++j)
    if (chain.error(j, key) > chain.error(worst, key)) worst = j;
  return worst;
}

/// Samples a motion evenly and, where that passes by `keys` farther than half of the error that is allowed,
/// at the keys that most tracks have and at those that are still passed by. Notes keys that are all the same.
template <class Pose>
void take_samples(const Rig& rig, const SourceClip& clip, const std::vector<Key>& keys, const Pose& pose,
                  const Options& options, Rig::Motion& motion, nlohmann::json& report) {
  constexpr double kShare = 0.5;  // the fit comes on top
  constexpr double kFill = 60;    // 1/s, between keys that are far apart: the curve is to go straight there
  constexpr int kRounds = 8;      // each takes a large part of what is left
  const double stated = motion.sample_rate;
  const int frames = std::max(1, static_cast<int>(std::lround(clip.duration * stated)) + 1);
  if (frames > 1) motion.sample_rate = (frames - 1) / clip.duration;
  for (int f = 0; f < frames; ++f) motion.samples.push_back(pose(motion.time(f)));
  if (keys.empty()) return;
  Poses truth;
  for (const Key& key : keys) truth.push_back(pose(key.time));
  const auto errors = [&] { return passed_by(rig, motion, keys, truth, options.fit_distance_cm / 100); };
  ChainError chain = errors();
  std::set<double> times{0, clip.duration};
  const double even_error = chain.largest();
  const double bound = kShare * options.fit_error_mm / 1000;
  if (even_error > bound) {
    const Rig::Motion even = motion;
    for (const Key& key : keys)
      if (2 * key.tracks >= keys.front().tracks) add_time(key.time, times);
    std::size_t before = 0;
    for (int round = 0; round < kRounds && before != times.size(); ++round) {
      before = times.size();
      motion.sample_rate = stated;
      motion.times = filled(times, std::min(stated, kFill));
      motion.samples.clear();
      for (const double t : motion.times) motion.samples.push_back(pose(t));
      chain = errors();
      for (std::size_t k = 0; k < keys.size(); ++k)
        if (chain.error(worst_joint(chain, int(k)), int(k)) > bound) add_time(keys[k].time, times);
    }
    if (chain.largest() > 0.9 * even_error) {  // what is missed is too close to other keys
      motion = even;
      chain = errors();
    }
  }
  int key = 0;
  for (int k = 1; k < chain.frames(); ++k)
    if (chain.error(worst_joint(chain, k), k) > chain.error(worst_joint(chain, key), key)) key = k;
  const int joint = worst_joint(chain, key);
  const double mm = 1000 * chain.error(joint, key);
  if (mm <= options.fit_error_mm) return;
  char line[160];
  std::snprintf(line, sizeof line, "' passes one by %.3g mm at %.4g s", mm, keys[std::size_t(key)].time);
  report["notes"].push_back("clip '" + motion.name +
                            "': keys less than 1/120 s from others are left out; joint '" +
                            rig.joints[std::size_t(joint)].name + line);
}

/// Joints other than the root whose distance to their parent changes by more than 1 mm over the motion, and
/// the largest change, m.
std::pair<int, double> stretch(const Rig::Motion& motion) {
  int count = 0;
  double largest = 0;
  for (std::size_t j = 1; j < motion.samples.front().size(); ++j) {
    double low = 1e300, high = 0;
    for (const auto& frame : motion.samples) {
      const double length = frame[j].translation.norm();
      low = std::min(low, length);
      high = std::max(high, length);
    }
    count += high - low > 1e-3;
    largest = std::max(largest, high - low);
  }
  return {count, largest};
}

/// Largest turn of a joint between two samples, rad.
double largest_turn(const std::vector<Transform<double>>& a, const std::vector<Transform<double>>& b) {
  double turn = 0;
  for (std::size_t j = 0; j < a.size(); ++j)
    turn = std::max(turn, a[j].rotation.angularDistance(b[j].rotation));
  return turn;
}

/// Whether a motion begins with a reference pose that is no part of it, as the CMU captures converted to BVH
/// do (a T-pose): it leaves faster than joints turn in any throw but a pitcher's, 40 rad/s, and ten times
/// as fast as it then goes on.
bool begins_with_reference_pose(const Rig::Motion& motion) {
  if (motion.samples.size() < 9) return false;
  const auto speed = [&](int f) {  // rad/s
    return largest_turn(motion.samples[f], motion.samples[f + 1]) / (motion.time(f + 1) - motion.time(f));
  };
  return speed(0) > 40 && speed(0) > 10 * speed(1);
}

/// One clip; `keys`: see uneven_keys(); `nodes`: see pose_at().
Rig::Motion sample(const SourceScene& scene, const SourceClip& clip, const std::vector<Key>& keys,
                   const std::vector<int>& nodes, const Matrix& to_model, const Rig& rig,
                   const Options& options, nlohmann::json& report) {
  Rig::Motion motion;
  motion.name = clip.name;
  motion.begin = clip.begin;
  motion.extras = clip.extras;
  motion.sample_rate = sampling_rate(clip);
  bool scaled = false;
  for (const SourceChannel& c : clip.channels)
    for (const Eigen::Vector3d& s : c.scales) scaled = scaled || (s - c.scales.front()).norm() > 1e-3;
  if (scaled)
    report["notes"].push_back("clip '" + clip.name + "': scale keys; positions follow them, sizes do not");
  const auto pose = [&](double t) { return pose_at(scene, clip, t, nodes, to_model, rig); };
  take_samples(rig, clip, keys, pose, options, motion, report);
  const std::size_t frames = motion.samples.size();
  if (const auto [count, largest] = stretch(motion); count > 0)
    report["notes"].push_back(
        "clip '" + clip.name + "': " + std::to_string(count) +
        (count == 1 ? " joint changes its" : " joints change their") + " distance to the parent, by up to " +
        std::to_string(std::lround(1e3 * largest)) + " mm; physics follows the clip there");
  if (begins_with_reference_pose(motion)) {
    const double left_out = motion.time(1);
    motion.samples.erase(motion.samples.begin());
    motion.begin += left_out;
    if (!motion.times.empty()) motion.times.erase(motion.times.begin());
    for (double& t : motion.times) t -= left_out;
    report["notes"].push_back("clip '" + clip.name +
                              "': its first frame is a reference pose, apart from the motion; left out");
  }
  add_morph_keys(scene, clip, motion, report);
  // A loop comes back to its first pose, the root's place aside, and to its first face.
  motion.loops = frames > 8 && largest_turn(motion.samples.back(), motion.samples.front()) < 0.01 &&
                 std::all_of(motion.morph_keys.begin(), motion.morph_keys.end(), [](const auto& curve) {
                   return std::abs(curve.second.back().second - curve.second.front().second) < 0.01;
                 });
  return motion;
}

}  // namespace

std::vector<Matrix> node_transforms(const SourceScene& scene, const SourceClip* clip, double t) {
  std::vector<const SourceChannel*> channel(scene.nodes.size(), nullptr);
  if (clip)
    for (const SourceChannel& c : clip->channels) channel[c.node] = &c;
  std::vector<Matrix> world(scene.nodes.size());
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    Matrix local = scene.nodes[i].local;
    if (const SourceChannel* c = channel[i]) {
      Eigen::Vector3d position = local.block<3, 1>(0, 3);
      Eigen::Matrix3d a = local.block<3, 3>(0, 0);
      Eigen::Vector3d scale = a.colwise().norm();
      if (a.determinant() < 0) scale[0] = -scale[0];
      for (int k = 0; k < 3; ++k) a.col(k) /= std::abs(scale[k]) > 1e-12 ? scale[k] : 1;
      Eigen::Quaterniond rotation(a);
      position = interpolate(c->position_times, c->positions, t, position);
      rotation = interpolate(c->rotation_times, c->rotations, t, rotation).normalized();
      scale = interpolate(c->scale_times, c->scales, t, scale);
      local.setIdentity();
      local.block<3, 3>(0, 0) = rotation.toRotationMatrix() * scale.asDiagonal();
      local.block<3, 1>(0, 3) = position;
    }
    world[i] = scene.nodes[i].parent < 0 ? local : Matrix(world[scene.nodes[i].parent] * local);
  }
  return world;
}

Transform<double> rigid(const Matrix& m) {
  Eigen::Matrix3d a = m.block<3, 3>(0, 0);
  if (a.determinant() < 0) a.col(0) = -a.col(0);
  for (int k = 0; k < 3; ++k)
    if (const double length = a.col(k).norm(); length > 1e-12)
      a.col(k) /= length;
    else
      a = Eigen::Matrix3d::Identity(), k = 3;
  a.col(1) = (a.col(1) - a.col(0).dot(a.col(1)) * a.col(0)).normalized();
  a.col(2) = a.col(0).cross(a.col(1));
  return {Eigen::Quaterniond(a).normalized(), m.block<3, 1>(0, 3)};
}

Error sample_clip(const SourceScene& scene, const SourceClip& clip, const std::vector<int>& nodes,
                  const Matrix& to_model, const Rig& rig, const Options& options, Rig::Motion& out,
                  nlohmann::json& report) {
  const double rate = sampling_rate(clip), most = kMostSamples / double(rig.joints.size());
  bool too_long = clip.duration * rate > most;
  std::vector<Key> keys;
  if (!too_long) keys = uneven_keys(clip, rate);
  too_long |= double(keys.size()) > most;
  if (too_long)
    return {"clip '" + clip.name + "' is too long to convert: " + std::to_string(clip.duration) + " s"};
  out = sample(scene, clip, keys, nodes, to_model, rig, options, report);
  if (out.samples.size() < 2) report["notes"].push_back("clip '" + clip.name + "' is a single pose");
  return {};
}

}  // namespace sinew::convert
