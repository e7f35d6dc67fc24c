#include "retarget/planting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "convert/contact_windows.h"
#include "retarget/reach.h"

namespace sinew::retarget {
namespace {

constexpr double kLeg = 0.9;        ///< m, of the body that the times and lengths below are for
constexpr double kFade = 0.12;      ///< s over which a limb comes down to the floor, and leaves it
constexpr double kEase = 0.1;       ///< s over which a path that was taken off its slip stops drifting
constexpr double kPatch = 0.002;    ///< m: see patch_of
constexpr double kNearZero = 0.06;  ///< m: a floor so near z = 0 is meant to be there
constexpr double kUneven = 0.06;    ///< m between what two feet stand on, on one floor
constexpr double kWalks = 0.3;      ///< m/s: what moves back more slowly does not walk in place
constexpr double kDeepest = 0.12;   ///< of the leg's length: lower hips would be another motion
constexpr double kSettle = 0.1;     ///< s over which hips go down for a leg that would not reach

double smooth(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (10 + u * (6 * u - 15));
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto at = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// A limb over the whole clip.
struct Track {
  Limb limb;
  int from = -1, to = -1;                   ///< end joints
  std::vector<std::array<int, 2>> windows;  ///< first and last frame; the last of a loop may be beyond it
  std::vector<double> weight;               ///< [frame] 1 on the floor
  double floor = 0;                         ///< m, that it stands on in the source
  std::vector<double> height;               ///< [frame] of the source's sole over its floor, m
  std::vector<double> over;                 ///< [frame] the same of the target, before it is planted
  std::vector<Patch> source_patch, patch;   ///< [frame]
  std::vector<Vec3<double>> path;           ///< [frame] of the target's end joint, m
};

class Planter {
 public:
  Planter(const PoseMap& map, const Motion& source, std::span<const ContactWindow> contacts, bool plant)
      : map_(map), source_(source), plant_(plant), frames_(static_cast<int>(source.local.size())) {
    size_ = map.leg / kLeg;
    pace_ = std::sqrt(size_);
    for (const Limb& limb : kLimbs) add_track(limb, contacts);
  }

  Retargeted run() {
    find_floors();
    find_carried();
    out_.motion.rate = source_.rate;
    out_.motion.loops = source_.loops;
    std::vector<std::vector<Transform<double>>>& local = out_.motion.local;
    for (int f = 0; f < frames_; ++f) {
      local.push_back(follow(map_, source_.local[f], source_.model[f]));
      place_hips(map_, hips_at(f), local.back());
    }
    for (Track& track : tracks_) find_path(track);
    shift_hips(true);
    shift_hips(false);
    for (const Track& track : tracks_) reach(track);
    for (const auto& frame : local) out_.motion.model.push_back(model_of(*map_.target, frame));
    return std::move(out_);
  }

 private:
  void add_track(const Limb& limb, std::span<const ContactWindow> contacts) {
    for (const Role role : {limb.upper, limb.middle, limb.end})
      if (map_.from[role].joints.empty() || map_.to[role].joints.empty()) return;
    Track track;
    track.limb = limb;
    track.from = map_.from[limb.end].joints.front();
    track.to = map_.to[limb.end].joints.front();
    const Sole sole(*map_.source, track.from);
    for (const auto& model : source_.model)
      track.source_patch.push_back(patch_of(sole, model, kPatch * size_));
    track.weight.assign(std::size_t(frames_), 0);
    std::vector<double> off(std::size_t(frames_), 1.0);
    for (const ContactWindow& w : contacts) {
      if (!plant_ || !is_below(*map_.source, w.joint, track.from)) continue;
      const int first = static_cast<int>(std::floor(double(w.begin) * source_.rate + 1e-3)),
                last = static_cast<int>(std::ceil(double(w.end) * source_.rate - 1e-3));
      if (last < first || first >= frames_) continue;
      track.windows.push_back({first, source_.loops ? last : std::min(last, frames_ - 1)});
      for (int f = 0; f < frames_; ++f) off[f] *= 1 - nearness(f, track.windows.back());
    }
    std::sort(track.windows.begin(), track.windows.end());
    for (int f = 0; f < frames_; ++f) track.weight[f] = 1 - off[f];
    tracks_.push_back(std::move(track));
  }

  /// 1 within a window, fading to 0 beside it.
  double nearness(int frame, const std::array<int, 2>& window) const {
    const int period = source_.intervals();
    double most = 0;
    for (const int shift : {-1, 0, 1}) {
      if (shift != 0 && !source_.loops) continue;
      const int f = frame + shift * period, outside = std::max({window[0] - f, f - window[1], 0});
      most = std::max(most, smooth(1 - outside / (kFade * pace_ * source_.rate)));
    }
    return most;
  }

  double source_height(const Track& track, int frame) const {
    return source_.model[frame][track.from].translation.z() + track.source_patch[frame].low;
  }

  /// The floor under the source and under the target, and the heights of the source's soles over it. Where a
  /// foot stands a little deeper than the other, it stands on its own.
  void find_floors() {
    std::vector<double> lowest;
    for (int f = 0; f < frames_; ++f) {
      double low = 1e300;
      for (const Track& track : tracks_)
        if (track.limb.leg) low = std::min(low, source_height(track, f));
      lowest.push_back(low);
    }
    source_floor_ = convert::floor_of(lowest);
    out_.floor = plant_ && std::abs(source_floor_) < kNearZero * size_ ? 0 : map_.scale * source_floor_;
    for (Track& track : tracks_) {
      std::vector<double> standing;
      for (int f = 0; f < frames_; ++f)
        if (track.weight[f] == 1) standing.push_back(source_height(track, f));
      const double own = standing.empty() ? source_floor_ : median(std::move(standing));
      track.floor = std::abs(own - source_floor_) < kUneven * size_ ? own : source_floor_;
      for (int f = 0; f < frames_; ++f) {
        const double height = source_height(track, f) - track.floor;
        track.height.push_back(plant_ ? std::max(height, 0.0) : height);
      }
    }
    for (const Track& track : tracks_) {
      if (!track.limb.leg) continue;
      source_ankle_ -= patch_of(Sole(*map_.source, track.from), map_.from_rest, kPatch * size_).low / 2;
      ankle_ -= patch_of(Sole(*map_.target, track.to), map_.to_rest, kPatch * size_ * map_.scale).low / 2;
    }
  }

  void find_carried() {
    std::vector<double> x, y;
    for (const Track& track : tracks_)
      for (int f = 0; f + 1 < frames_ && track.limb.leg; ++f) {
        if (track.weight[f] < 1 || track.weight[f + 1] < 1) continue;
        const Vec3<double> travel =
            source_.model[f + 1][track.from].translation - source_.model[f][track.from].translation;
        const Vec3<double> v = slip(track.source_patch[f], track.source_patch[f + 1], travel) * source_.rate;
        x.push_back(v.x());
        y.push_back(v.y());
      }
    const Vec3<double> way(median(std::move(x)), median(std::move(y)), 0);
    if (way.norm() > kWalks * pace_) out_.carried = map_.scale * way;
  }

  Vec3<double> hips_at(int frame) const {
    const Vec3<double> theirs = hips_of(map_.from, source_.model[frame]);
    return {map_.scale * theirs.x(), map_.scale * theirs.y(),
            out_.floor + ankle_ + map_.scale * (theirs.z() - source_floor_ - source_ankle_)};
  }

  /// Where the end joint goes. (Rounding that path over some milliseconds only made it worse: three
  /// millimetres of sole where heels come down, and no less torque.)
  void find_path(Track& track) {
    const Sole sole(*map_.target, track.to);
    const int hip = map_.to[track.limb.upper].joints.front(),
              their_hip = map_.from[track.limb.upper].joints.front();
    for (int f = 0; f < frames_; ++f) {
      const std::vector<Transform<double>> model = model_of(*map_.target, out_.motion.local[f]);
      track.patch.push_back(patch_of(sole, model, kPatch * size_ * map_.scale));
      Vec3<double> at = model[track.to].translation;
      if (track.limb.leg)
        at = model[hip].translation + map_.scale * (source_.model[f][track.from].translation -
                                                    source_.model[f][their_hip].translation);
      track.over.push_back(track.limb.leg ? map_.scale * track.height[f]
                                          : at.z() + track.patch[f].low - out_.floor);
      track.path.emplace_back(at.x(), at.y(), out_.floor + track.over[f] - track.patch[f].low);
    }
    const std::vector<Vec3<double>> off = corrections(track);
    for (int f = 0; f < frames_; ++f) track.path[f] += (track.limb.leg ? 1 : track.weight[f]) * off[f];
  }

  /// Frame f and those beside it: loops go on, others hold their ends.
  int frame_at(int f) const {
    const int period = source_.intervals();
    if (source_.loops && period > 0) return ((f % period) + period) % period;
    return std::clamp(f, 0, frames_ - 1);
  }

  /// The slip of one interval, beside the floor's own movement.
  Vec3<double> slip_after(const Track& track, int frame) const {
    const int f = source_.loops ? frame % source_.intervals() : frame;
    return slip(track.patch[f], track.patch[f + 1], track.path[f + 1] - track.path[f]) -
           out_.carried / source_.rate;
  }

  /// What a path has to be moved by so that soles are on the floor in the windows and nothing slips there,
  /// as little as possible.
  std::vector<Vec3<double>> corrections(const Track& track) const {
    const std::size_t count = track.windows.size();
    std::vector<Vec3<double>> out(std::size_t(frames_), Vec3<double>::Zero());
    if (count == 0 || frames_ < 2) return out;
    std::vector<std::vector<Vec3<double>>> moved(count);
    for (std::size_t k = 0; k < count; ++k) {
      const auto& [first, last] = track.windows[k];
      std::vector<Vec3<double>>& off = moved[k];
      off.emplace_back(Vec3<double>::Zero());
      Vec3<double> mean = Vec3<double>::Zero();
      for (int f = first; f < last; ++f) {
        off.emplace_back(off.back() - slip_after(track, f));
        mean += off.back();
      }
      mean /= double(off.size());
      for (std::size_t i = 0; i < off.size(); ++i) {
        const int f = first + static_cast<int>(i);
        off[i] -= mean;
        off[i].z() = -track.over[frame_at(f)];
        put(out, f, off[i]);
      }
    }
    for (std::size_t k = 0; k < count; ++k) fill_after(track, k, moved, out);
    if (!source_.loops) fill_before(track, moved.front(), out);
    for (int f = 0; f < frames_ && track.limb.leg; ++f)  // never through the floor
      out[f].z() = std::max(out[f].z(), -track.over[f]);
    return out;
  }

  void put(std::vector<Vec3<double>>& out, int frame, const Vec3<double>& value) const {
    if (!source_.loops) {
      if (frame >= 0 && frame < frames_) out[frame] = value;
      return;
    }
    const int period = source_.intervals(), f = (frame % period + period) % period;
    out[f] = value;
    if (f == 0) out[period] = value;
  }

  /// What a path that drifts at `velocity` (m a frame) has come to after `frames`, if it is eased to rest.
  Vec3<double> eased(const Vec3<double>& velocity, double frames, double length) const {
    const double ease = std::min(length, kEase * pace_ * source_.rate), u = std::min(1.0, frames / ease);
    return velocity * (ease * (u - u * u * u + u * u * u * u / 2));
  }

  static Vec3<double> velocity_at(const std::vector<Vec3<double>>& off, bool end) {
    const std::size_t n = off.size();
    if (n < 2) return Vec3<double>::Zero();
    return end ? Vec3<double>(off[n - 1] - off[n - 2]) : Vec3<double>(off[1] - off[0]);
  }

  void fill_after(const Track& track, std::size_t k, const std::vector<std::vector<Vec3<double>>>& moved,
                  std::vector<Vec3<double>>& out) const {
    const bool is_last = k + 1 == track.windows.size();
    const int begin = track.windows[k][1];
    const Vec3<double> from = moved[k].back(), velocity = velocity_at(moved[k], true);
    if (is_last && !source_.loops) {
      for (int f = begin + 1; f < frames_; ++f) out[f] = from + eased(velocity, f - begin, 1e9);
      return;
    }
    const std::size_t next = is_last ? 0 : k + 1;
    const int end = track.windows[next][0] + (is_last ? source_.intervals() : 0), length = end - begin;
    const Vec3<double> to = moved[next].front(), arrives = velocity_at(moved[next], false);
    for (int f = begin + 1; f < end; ++f) {
      const double u = smooth(double(f - begin) / length);
      put(out, f,
          (1 - u) * (from + eased(velocity, f - begin, length)) + u * (to - eased(arrives, end - f, length)));
    }
  }

  void fill_before(const Track& track, const std::vector<Vec3<double>>& moved,
                   std::vector<Vec3<double>>& out) const {
    const int end = track.windows.front()[0];
    for (int f = 0; f < end; ++f) out[f] = moved.front() - eased(velocity_at(moved, false), end - f, 1e9);
  }

  /// How far the hips have to go down (or, for knees that would fold too far, up: a second pass with `down`
  /// false) in each frame so that standing legs can be where they stand, m.
  std::vector<double> needed_shift(bool down) const {
    std::vector<double> need(std::size_t(frames_), 0.0);
    const double most = kDeepest * map_.leg * map_.scale;
    for (const Track& track : tracks_) {
      if (!track.limb.leg) continue;
      const Reach solver(map_, track.limb);
      const double limit = down ? 0.9975 * solver.longest() : 1.005 * solver.shortest();
      const int hip = map_.to[track.limb.upper].joints.front();
      for (int f = 0; f < frames_; ++f) {
        if (track.weight[f] == 0) continue;
        const Vec3<double> at = model_of(*map_.target, out_.motion.local[f])[hip].translation;
        const Vec3<double> way = at - track.path[f];
        const double level = std::hypot(way.x(), way.y());
        const double high = std::sqrt(std::max(0.0, limit * limit - level * level));
        const double shift = down ? way.z() - high : high - way.z();
        need[f] = std::max(need[f], track.weight[f] * std::min(shift, most));
      }
    }
    return need;
  }

  void shift_hips(bool down) {
    std::vector<double> shift = needed_shift(down);
    if (!plant_ || *std::max_element(shift.begin(), shift.end()) <= 0) return;
    const int radius = std::max(1, static_cast<int>(std::lround(kSettle / 2 * pace_ * source_.rate)));
    const auto around = [&](const std::vector<double>& values, int reach, bool largest) {
      std::vector<double> out(values.size());
      for (int f = 0; f < frames_; ++f) {
        double sum = 0;
        for (int k = -reach; k <= reach; ++k) {
          const int at = frame_at(f + k);
          sum = largest ? std::max(sum, values[at]) : sum + values[at];
        }
        out[f] = largest ? sum : sum / (2 * reach + 1);
      }
      return out;
    };
    shift = around(around(around(shift, 2 * radius, true), radius, false), radius, false);
    for (int f = 0; f < frames_; ++f) {
      const Vec3<double> hips = hips_of(map_.to, model_of(*map_.target, out_.motion.local[f]));
      place_hips(map_, hips + (down ? -1 : 1) * shift[f] * Vec3<double>::UnitZ(), out_.motion.local[f]);
    }
  }

  void reach(const Track& track) {
    Reach solver(map_, track.limb);
    solver.learn_plane(out_.motion.local);
    double furthest = 0;
    for (int f = 0; f < frames_; ++f)
      furthest = std::max(
          furthest,
          (model_of(*map_.target, out_.motion.local[f])[track.to].translation - track.path[f]).norm());
    if (furthest < 1e-7 * size_) return;  // where it is already, to rounding: as it is
    for (int f = 0; f < frames_; ++f)
      if (track.limb.leg || track.weight[f] > 0)
        out_.unreachable +=
            !solver.solve(track.path[f], track.limb.leg ? 1 : track.weight[f], out_.motion.local[f]);
  }

  const PoseMap& map_;
  const Motion& source_;
  bool plant_;
  int frames_;
  double size_ = 1, pace_ = 1;
  double source_floor_ = 0, source_ankle_ = 0, ankle_ = 0;
  std::vector<Track> tracks_;
  Retargeted out_;
};

}  // namespace

Retargeted retarget_motion(const PoseMap& map, const Motion& source, std::span<const ContactWindow> contacts,
                           bool plant) {
  return Planter(map, source, contacts, plant).run();
}

}  // namespace sinew::retarget
