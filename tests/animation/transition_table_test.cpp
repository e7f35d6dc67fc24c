// What ways of changing clips do to the accelerations of real motion capture: 300 changes between random
// instants of two clips, the worst joint of each, medians. The jump at the start is measured from poses
// alone, by one-sided differences, so that ways without exact derivatives are judged alike.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <random>

#include "convert/convert.h"
#include "fixtures/paths.h"
#include "sinew/animation/crossfade.h"
#include "sinew/animation/inertialize_job.h"
#include "sinew/animation/sampling_job.h"
#include "sinew/skeleton/rotation.h"

namespace sinew {
namespace {

constexpr unsigned kSeed = 20261125;
constexpr int kChanges = 300;
using Pose = std::vector<JointJet<double>>;

struct Clips {
  Asset a, b;
  std::vector<int> in_b;  ///< [joint of a] the joint of that name, or −1
};

/// One change: the old clip at `from`, the new one at `to`, while they play on.
struct Change {
  const Clips& clips;
  double from, to, T;

  Pose old(double t) const { return at(clips.a, from + t); }
  Pose next(double t) const {
    const Pose all = at(clips.b, to + t);
    Pose out;
    for (const int j : clips.in_b) out.push_back(all[j < 0 ? 0 : j]);
    return out;
  }
  static Pose at(const Asset& asset, double t) {
    Pose out(asset.skeleton.joints.size());
    EXPECT_TRUE((SamplingJob<double>{&asset.clips[0], t, out}.Run().ok()));
    return out;
  }
};

/// The pose of a way of changing, t seconds after the start.
using Way = std::function<Pose(const Change&, double t)>;

Way faded(double (*ease)(double)) {
  return [ease](const Change& c, double t) {
    Pose a = c.old(t), b = c.next(t);
    crossfade<double>(a, b, {ease(std::min(1.0, t / c.T)), 0, 0}, b);
    return b;
  };
}

/// Offsets as rotation vectors in parent axes, each component or its length by a curve.
template <class Curve>
Way offset_by(Curve curve) {
  return [curve](const Change& c, double t) {
    const Pose a = c.old(0), b = c.next(0);
    Pose out = c.next(t);
    for (std::size_t j = 0; j < out.size(); ++j) {
      const Vec3<double> x = rotation_log<double>(a[j].rotation * b[j].rotation.conjugate());
      const Vec3<double> v = a[j].rotation * a[j].omega - b[j].rotation * b[j].omega;
      out[j].rotation = rotation_exp<double>(curve(x, v, c.T, t)) * out[j].rotation;
    }
    return out;
  };
}
/// Critically damped springs, half-life T/2.
Vec3<double> spring(const Vec3<double>& x, const Vec3<double>& v, double T, double t) {
  const double y = 2 * std::log(2.0) / (T / 2);
  return std::exp(-y * t) * (x + (v + y * x) * t);
}
/// Bollo, "Inertialization", GDC 2018: along the offset, outward velocity dropped.
Vec3<double> bollo(const Vec3<double>& offset, const Vec3<double>& rate, double T, double t) {
  const double x = offset.norm();
  if (x < 1e-12) return Vec3<double>::Zero();
  const double v = std::min(0.0, rate.dot(offset) / x);
  const double t1 = v < 0 ? std::min(T, -5 * x / v) : T;
  if (t >= t1) return Vec3<double>::Zero();
  const double a = std::max(0.0, (-8 * v * t1 - 20 * x) / (t1 * t1));
  const double A = -(a * t1 * t1 + 6 * v * t1 + 12 * x) / (2 * std::pow(t1, 5)),
               B = (3 * a * t1 * t1 + 16 * v * t1 + 30 * x) / (2 * std::pow(t1, 4)),
               C = -(3 * a * t1 * t1 + 12 * v * t1 + 20 * x) / (2 * std::pow(t1, 3));
  return offset / x * (((((A * t + B) * t + C) * t + a / 2) * t + v) * t + x);
}

Pose inertialized(const Change& c, double t) {
  Pose out = c.next(t);
  std::vector<double> numbers(inertial_numbers(int(out.size()), 0));
  InertialState<double> state{numbers, int(out.size()), 0};
  EXPECT_TRUE(begin_inertial<double>(c.old(0), c.next(0), c.T, state).ok());
  state.elapsed = t;
  EXPECT_TRUE((InertializeJob<double>{out, &state, {}, out}.Run().ok()));
  return out;
}

/// `exact`: what was going on goes on with its acceleration; otherwise rates die away from their value alone.
Way dead_blend(bool exact) {
  return [exact](const Change& c, double t) {
    Pose a = c.old(0), out = c.next(t);
    for (JointJet<double>& jet : a)
      if (!exact) jet.alpha = -7 * jet.omega;  // then the second pole has nothing to do: v = v₀·e^(−7t)
    ExtrapolateJob<double> job;
    job.from = a;
    job.elapsed = t;
    job.out = a;
    EXPECT_TRUE(job.Run().ok());
    const double u = std::min(1.0, t / c.T),
                 w = exact ? EaseWeight<double>::at(t, c.T).value : u * u * (3 - 2 * u);
    crossfade<double>(a, out, {w, 0, 0}, out);
    return out;
  };
}

struct Judged {
  double peak = 0;      ///< rad/s² by 60 Hz differences
  double jump[2] = {};  ///< rad/s and rad/s² at the start
};

/// Of the worst joint, the root left out: how a root is brought in line is a question of its own.
Judged judge(const Way& way, const Change& c) {
  Judged found;
  constexpr double h = 4e-4, frame = 1 / 60.0;
  // One-sided differences of six poses: errors h⁴ and h⁵ times a sixth derivative.
  constexpr double first[] = {-137 / 60.0, 5, -5, 10 / 3.0, -5 / 4.0, 1 / 5.0},
                   second[] = {15 / 4.0, -77 / 6.0, 107 / 6.0, -13, 61 / 12.0, -5 / 6.0};
  const Pose before = c.old(0);
  std::vector<Pose> start, frames;
  for (int k = 0; k < 6; ++k) start.push_back(way(c, k * h));
  for (int k = -3; k * frame < c.T + 4 * frame; ++k)
    frames.push_back(k < 0 ? c.old(k * frame) : way(c, k * frame));
  for (std::size_t j = 1; j < before.size(); ++j) {
    if (c.clips.in_b[j] < 0) continue;
    Vec3<double> omega = Vec3<double>::Zero(), alpha = omega, last = omega;
    for (int k = 0; k < 6; ++k) {
      const Vec3<double> x = rotation_log<double>(start[0][j].rotation.conjugate() * start[k][j].rotation);
      omega += first[k] / h * x;
      alpha += second[k] / (h * h) * x;
    }
    found.jump[0] = std::max(found.jump[0], (omega - before[j].omega).norm());
    found.jump[1] = std::max(found.jump[1], (alpha - before[j].alpha).norm());
    for (std::size_t k = 1; k < frames.size(); ++k) {
      const Quat<double>& p = frames[k - 1][j].rotation;
      const Vec3<double> now = p * rotation_log<double>(p.conjugate() * frames[k][j].rotation) / frame;
      if (k > 1) found.peak = std::max(found.peak, (now - last).norm() / frame);
      last = now;
    }
  }
  return found;
}

double median(std::vector<double> x) {
  std::nth_element(x.begin(), x.begin() + x.size() / 2, x.end());
  return x[x.size() / 2];
}
Judged median_of(const Way& way, const Clips& clips, double T) {
  std::mt19937 random(kSeed);
  std::vector<double> peak, jump[2];
  for (int n = 0; n < kChanges; ++n) {
    const auto any = [&](const Asset& asset) {
      return std::uniform_real_distribution<double>(0.1, asset.clips[0].duration - T - 0.2)(random);
    };
    const double from = any(clips.a), to = any(clips.b);
    const Judged j = judge(way, {clips, from, to, T});
    peak.push_back(j.peak);
    for (int d = 0; d < 2; ++d) jump[d].push_back(j.jump[d]);
  }
  return {median(peak), {median(jump[0]), median(jump[1])}};
}

void load(const std::string& file, Asset& asset) {
  nlohmann::json report;
  const auto fault = convert::convert_files({file}, {{"fit_degree", 5}}, asset, report);
  ASSERT_FALSE(fault) << fault.message;
}

int index_of(const std::string& name, const Skeleton& skeleton) {
  const auto found = std::find_if(skeleton.joints.begin(), skeleton.joints.end(),
                                  [&](const Joint& joint) { return joint.name == name; });
  return found == skeleton.joints.end() ? -1 : static_cast<int>(found - skeleton.joints.begin());
}

void expect_table(const std::string& a, const std::string& b) {
  for (const std::string& file : {a, b})
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  Clips clips;
  load(a, clips.a);
  load(b, clips.b);
  for (const Joint& joint : clips.a.skeleton.joints)
    clips.in_b.push_back(index_of(joint.name, clips.b.skeleton));
  const std::pair<const char*, Way> ways[] = {
      {"the old clip alone", [](const Change& c, double t) { return c.old(t); }},
      {"cut", [](const Change& c, double t) { return c.next(t); }},
      {"crossfade, linear", faded([](double u) { return u; })},
      {"crossfade, smoothstep", faded([](double u) { return u * u * (3 - 2 * u); })},
      {"crossfade, quintic", faded([](double u) { return u * u * u * (10 - 15 * u + 6 * u * u); })},
      {"spring offsets", offset_by(spring)},
      {"Bollo's quintic", offset_by(bollo)},
      {"dead blend, smoothstep", dead_blend(false)},
      {"dead blend, two poles", dead_blend(true)},
      {"InertializeJob", inertialized}};
  std::printf("%s → %s, seed %u, medians of %d changes\n", std::filesystem::path(a).filename().c_str(),
              std::filesystem::path(b).filename().c_str(), kSeed, kChanges);
  std::printf("%-24s %8s %8s | %8s %9s\n", "", "peak 0.2", "peak 0.4", "jump ω", "jump α");
  std::map<std::string, Judged> at;
  for (const auto& [name, way] : ways) {
    const Judged fast = median_of(way, clips, 0.2), slow = median_of(way, clips, 0.4);
    std::printf("%-24s %8.0f %8.0f | %8.3f %9.3f\n", name, fast.peak, slow.peak, fast.jump[0], fast.jump[1]);
    at[name] = fast;
  }
  // What C² ways are wanted to do, 4 rad/s², of which all is error of measuring.
  for (const char* smooth : {"InertializeJob", "dead blend, two poles", "crossfade, quintic"})
    EXPECT_LT(at[smooth].jump[1], 4) << smooth;
  EXPECT_GT(at["crossfade, smoothstep"].jump[1], 20) << "measuring finds no jump where there is one";
}

const std::string kDebian = "/usr/share/assimp/models/BVH/";

TEST(TransitionTable, DebiansMotionCapture) {
  expect_table(kDebian + "01_01.bvh", kDebian + "01_03.bvh");
}
TEST(TransitionTable, WalkToWashing) {
  expect_table(shared_dir() + "/assets/bvh/cmu_12_01_walk.bvh", shared_dir() + "/assets/bvh/cmu_13_26.bvh");
}

}  // namespace
}  // namespace sinew
