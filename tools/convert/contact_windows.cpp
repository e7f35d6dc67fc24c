#include "convert/contact_windows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "sinew/animation/phase_map.h"
#include "sinew/animation/sampling_job.h"

namespace sinew::convert {
namespace {

constexpr double kRate = 120;                    ///< frames a second
constexpr double kStature = 1.75;                ///< m
constexpr double kNear = 0.03;                   ///< m above the floor
constexpr double kUneven = 0.06;                 ///< m between the lowest points of two feet that stand
constexpr double kRises = 0.3, kSlides = 0.35;   ///< m/s of what rests
constexpr double kWalks = 0.3;                   ///< m/s: what moves back more slowly does not walk in place
constexpr double kShortest = 0.06, kGap = 0.05;  ///< s

/// What touches the floor: a joint, and its colliders' points with those of its toes or fingers.
struct Limb {
  int joint = 0;
  std::vector<ContactPoint<double>> points;
};

/// A limb in a frame: height of its lowest point over the floor, and how that point moves.
struct Sole {
  double height = 0;
  Vec3<double> velocity;
};

std::vector<Limb> limbs_of(const Skeleton& skeleton) {
  std::vector<Limb> limbs;
  for (int j = 0; j < skeleton.body_count; ++j) {
    const Role role = skeleton.joints[static_cast<std::size_t>(j)].role;
    const bool ends =
        role == Role::kFootL || role == Role::kFootR || role == Role::kHandL || role == Role::kHandR;
    if (!ends) continue;
    Limb limb{j, points_below(skeleton, j)};
    if (!limb.points.empty()) limbs.push_back(std::move(limb));
  }
  return limbs;
}

/// Model transforms of all bodies at a time.
std::vector<Transform<double>> pose_at(const Skeleton& skeleton, const Clip& clip, double time) {
  std::vector<Transform<double>> local(static_cast<std::size_t>(skeleton.body_count)), model(local.size());
  SamplingJob<double> job;
  job.clip = &clip;
  job.time = time;
  job.poses = local;
  if (!job.Run()) return {};
  for (std::size_t j = 0; j < local.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    model[j] = parent < 0 ? local[j] : model[static_cast<std::size_t>(parent)] * local[j];
  }
  return model;
}

Vec3<double> place(const std::vector<Transform<double>>& pose, const ContactPoint<double>& p) {
  return pose[static_cast<std::size_t>(p.body)] * p.local;
}

const ContactPoint<double>& lowest_of(const std::vector<ContactPoint<double>>& points,
                                      const std::vector<Transform<double>>& pose) {
  return *std::min_element(points.begin(), points.end(), [&](const auto& a, const auto& b) {
    return place(pose, a).z() - a.radius < place(pose, b).z() - b.radius;
  });
}

double middle(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// How a clip that moves in place carries the floor past, m/s; zero for all others.
Vec3<double> treadmill(const std::vector<std::vector<Sole>>& soles, double scale) {
  std::vector<double> x, y;
  for (const std::vector<Sole>& limb : soles)
    for (const Sole& sole : limb)
      if (sole.height < kNear * scale && std::abs(sole.velocity.z()) < kRises * std::sqrt(scale)) {
        x.push_back(sole.velocity.x());
        y.push_back(sole.velocity.y());
      }
  const Vec3<double> way(middle(x), middle(y), 0);
  return way.norm() < kWalks * std::sqrt(scale) ? Vec3<double>(Vec3<double>::Zero()) : way;
}

/// Frames [begin, end) in which something rests, gaps closed and splinters left out.
std::vector<std::array<int, 2>> spans(const std::vector<bool>& rests, bool loops, double speed_scale) {
  const int count = static_cast<int>(rests.size());
  const int gap = static_cast<int>(std::lround(kGap * kRate * speed_scale)),
            shortest = static_cast<int>(std::lround(kShortest * kRate * speed_scale));
  // A loop is looked at from a frame on in which nothing rests.
  const auto first_open = std::find(rests.begin(), rests.end(), false);
  if (first_open == rests.end()) return {{0, count}};
  const int from = loops ? static_cast<int>(first_open - rests.begin()) : 0;
  std::vector<std::array<int, 2>> found;
  for (int k = from; k < from + count; ++k) {
    if (!rests[static_cast<std::size_t>(k % count)]) continue;
    if (!found.empty() && k - found.back()[1] <= gap)
      found.back()[1] = k + 1;
    else
      found.push_back({k, k + 1});
  }
  if (loops && found.size() > 1 && found.front()[0] + count - found.back()[1] <= gap) {
    found.back()[1] = found.front()[1] + count;
    found.erase(found.begin());
  }
  const auto splinter = [&](const std::array<int, 2>& s) { return s[1] - s[0] < shortest; };
  found.erase(std::remove_if(found.begin(), found.end(), splinter), found.end());
  return found;
}

void add_markers(const Skeleton& skeleton, Clip& clip) {
  const auto of = [&](Role role) {
    for (int j = 0; j < skeleton.body_count; ++j)
      if (skeleton.joints[static_cast<std::size_t>(j)].role == role) return j;
    return -1;
  };
  std::vector<PhaseMarker> markers;
  PhaseMap map;
  int cycles = 1;
  if (!phase_markers(clip, of(Role::kFootL), of(Role::kFootR), markers, cycles)) return;
  if (!fit_phase_map(markers, double(clip.duration), cycles, map)) return;
  clip.markers = std::move(markers);
  clip.cycles = cycles;
}

}  // namespace

std::vector<ContactPoint<double>> points_below(const Skeleton& skeleton, int joint) {
  std::vector<ContactPoint<double>> points;
  for (const Collider& c : skeleton.colliders) {
    int above = c.joint;
    while (above > joint) above = skeleton.joints[static_cast<std::size_t>(above)].parent;
    if (above == joint && c.joint < skeleton.body_count) append_contact_points<double>(c, points);
  }
  return points;
}

double floor_of(std::vector<double> lowest) {
  std::sort(lowest.begin(), lowest.end());
  std::size_t most = 0;
  double floor = 0;
  for (std::size_t begin = 0, end = 0; begin < lowest.size(); ++begin) {
    while (end < lowest.size() && lowest[end] < lowest[begin] + 0.01) ++end;
    if (end - begin <= most) continue;
    most = end - begin;
    floor = lowest[(begin + end) / 2];
  }
  return floor;
}

void find_contacts(const Skeleton& skeleton, double height, Clip& clip, nlohmann::json& report) {
  const std::vector<Limb> limbs = limbs_of(skeleton);
  const int frames = static_cast<int>(double(clip.duration) * kRate);
  if (limbs.empty() || frames < 2) return;
  const double scale = std::max(height, 1e-3) / kStature, speed_scale = std::sqrt(scale);
  std::vector<std::vector<Sole>> soles(limbs.size());
  std::vector<double> lowest;
  for (int f = 0; f < frames; ++f) {
    const double t = f / kRate, h = 0.5 / kRate;
    const double before_time = clip.loops ? t - h : std::max(t - h, 0.0);
    const double after_time = clip.loops ? t + h : std::min(t + h, double(clip.duration));
    const auto pose = pose_at(skeleton, clip, t), before = pose_at(skeleton, clip, before_time),
               after = pose_at(skeleton, clip, after_time);
    if (pose.empty() || before.empty() || after.empty()) return;
    for (std::size_t i = 0; i < limbs.size(); ++i) {
      const ContactPoint<double>& p = lowest_of(limbs[i].points, pose);
      soles[i].push_back(
          {place(pose, p).z() - p.radius, (place(after, p) - place(before, p)) / (after_time - before_time)});
    }
    const auto low = std::min_element(soles.begin(), soles.end(), [](const auto& a, const auto& b) {
      return a.back().height < b.back().height;
    });
    lowest.push_back(low->back().height);  // some rigs have a root that stays on the floor, or below it
  }
  const double floor = floor_of(std::move(lowest));
  for (std::vector<Sole>& limb : soles) {
    std::vector<double> heights;
    for (const Sole& sole : limb) heights.push_back(sole.height);
    const double own = floor_of(std::move(heights));
    for (Sole& sole : limb) sole.height -= std::abs(own - floor) < kUneven * scale ? own : floor;
  }
  const Vec3<double> carried = treadmill(soles, scale);
  if (!carried.isZero())
    report["notes"].push_back("clip '" + clip.name + "' moves in place, as at " +
                              std::to_string(carried.norm()).substr(0, 4) + " m/s");
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    std::vector<bool> rests;
    for (const Sole& sole : soles[i]) {
      const Vec3<double> off = sole.velocity - carried;
      rests.push_back(sole.height < kNear * scale && std::abs(off.z()) < kRises * speed_scale &&
                      std::hypot(off.x(), off.y()) < kSlides * speed_scale);
    }
    for (const auto& [begin, end] : spans(rests, clip.loops, speed_scale))
      clip.contacts.push_back(
          {limbs[i].joint, static_cast<float>(begin / kRate), static_cast<float>((end - 1) / kRate)});
  }
  add_markers(skeleton, clip);
}

}  // namespace sinew::convert
