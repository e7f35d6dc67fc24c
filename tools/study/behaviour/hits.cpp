#include "study/behaviour/hits.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <mutex>
#include <numbers>
#include <numeric>

#include "scene/run.h"
#include "sinew/skeleton/rotation.h"
#include "study/behaviour/push_map.h"
#include "study/mannequin.h"
#include "study/on_all_processors.h"

namespace sinew::study {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kHitAt = 0.5, kWatchedAfter = 2.5, kQuietAfter = 1;           ///< s
constexpr double kBackWithin = 5 * kDegree;                                    ///< rad
constexpr double kLeastPeak = 2 * kDegree, kMostPeak = 25 * kDegree;           ///< rad
constexpr double kEarliestPeak = 0.06, kLatestPeak = 0.2;                      ///< s
constexpr double kSoonestBack = 0.4, kLatestBack = 0.9, kMostOvershoot = 0.4;  ///< s; of the peak
constexpr double kLeastRankCorrelation = 0.95, kMostApart = 0.1;
constexpr double kLeastJudged = 5, kMostJudged = 40;  ///< N·s

constexpr HitPlace kPlaces[] = {{"chest", Role::kChest},
                                {"shoulder", Role::kChest, Role::kUpperArmL},
                                {"head", Role::kHead},
                                {"thigh", Role::kThighL, Role::kNone, 1}};
constexpr Tone kTones[] = {Tone::kRelaxed, Tone::kAlert, Tone::kBraced};

const char* name_of(Tone tone) {
  constexpr const char* kNames[] = {"rigid", "relaxed", "alert", "braced"};
  return kNames[static_cast<std::size_t>(tone)];
}

/// m, where a place is struck, in the axes of its joint.
Vec3<double> struck_at(const Skeleton& s, const HitPlace& place) {
  const int joint = s.find(place.role);
  if (place.at_joint == Role::kNone) return s.joints[static_cast<std::size_t>(joint)].center_of_mass;
  Transform<double> at;
  for (int i = s.find(place.at_joint); i > joint; i = s.joints[static_cast<std::size_t>(i)].parent)
    at = s.joints[static_cast<std::size_t>(i)].rest * at;
  return at.translation;
}

scene::Scene hit_scene(const HitPlace& place, Tone tone, double hz, double impulse) {
  scene::Scene s = balancing_scene("stand", false, kHitAt + kWatchedAfter, hz);
  s.characters[0].tone = {{0, tone}};
  scene::Push push;
  push.time = kHitAt;
  push.joint = s.characters[0].asset->skeleton.find(place.role);
  push.point = struck_at(s.characters[0].asset->skeleton, place);
  push.impulse = {place.ahead * impulse, 0, 0};
  s.pushes.push_back(push);
  return s;
}

/// Rotation vectors (rad, world) by which a joint's body is off that of another recording, from the last
/// frame before the hit on.
std::vector<Vec3<double>> turns(const scene::Recording& is, const scene::Recording& led, int joint,
                                int from) {
  std::vector<Vec3<double>> out;
  for (std::size_t f = static_cast<std::size_t>(from); f < is.frames.size(); ++f) {
    const auto of = [&](const scene::Recording& r) {
      return Quat<double>(
          r.frames[f].characters[0].model[static_cast<std::size_t>(joint)].rotation.cast<double>());
    };
    out.push_back(rotation_log<double>(of(is) * of(led).conjugate()));
  }
  return out;
}

/// Where it is furthest off; between frames on the parabola through three.
void measure(const std::vector<Vec3<double>>& turned, Hit& hit) {
  const auto furthest = std::max_element(turned.begin(), turned.end(), [](const auto& a, const auto& b) {
    return a.squaredNorm() < b.squaredNorm();
  });
  hit.peak = furthest->norm();
  double at = static_cast<double>(furthest - turned.begin());
  hit.first = turned.size() > 1 ? turned[1].norm() : 0;
  if (!(hit.peak > 0)) return;
  const Vec3<double> axis = *furthest / hit.peak;
  if (furthest != turned.begin() && furthest + 1 != turned.end()) {
    const double before = (furthest - 1)->norm(), after = (furthest + 1)->norm(), lean = (after - before) / 2,
                 bend = before - 2 * hit.peak + after;
    at -= bend < 0 ? lean / bend : 0;
    hit.peak -= bend < 0 ? lean * lean / (2 * bend) : 0;
  }
  hit.peak_time = at / hit.hz;
  std::size_t last_far = 0;
  for (std::size_t f = 0; f < turned.size(); ++f) {
    if (turned[f].norm() > kBackWithin) last_far = f + 1;
    if (turned.begin() + static_cast<std::ptrdiff_t>(f) > furthest)
      hit.overshoot = std::max(hit.overshoot, -turned[f].dot(axis) / hit.peak);
  }
  hit.back = static_cast<double>(last_far) / hit.hz;
}

Hit run_hit(const HitPlace& place, Tone tone, double hz, double impulse, const scene::Recording& led) {
  Hit hit;
  hit.place = place.name;
  hit.tone = tone;
  hit.hz = hz;
  hit.impulse = impulse;
  const scene::Scene s = hit_scene(place, tone, hz, impulse);
  scene::Recording recording;
  scene::Telemetry telemetry;
  if (const convert::Error error = scene::run_scene(s, recording, telemetry, nullptr)) {
    hit.refused = error.message;
    return hit;
  }
  measure(turns(recording, led, s.pushes[0].joint, static_cast<int>(std::lround(kHitAt * hz))), hit);
  for (const scene::TelemetryRow& row : telemetry.rows)
    if (row.time > kHitAt + kQuietAfter) hit.unknowns = std::max(hit.unknowns, row.report.unknown_dofs);
  return hit;
}

/// Spearman's.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto ranks = [](const std::vector<double>& values) {
    std::vector<double> out;
    for (const double v : values)
      out.push_back(
          static_cast<double>(std::count_if(values.begin(), values.end(), [&](double x) { return x < v; })) +
          static_cast<double>(std::count(values.begin(), values.end(), v)) / 2);
    return out;
  };
  const std::vector<double> x = ranks(a), y = ranks(b);
  const double n = static_cast<double>(x.size());
  const double mx = std::accumulate(x.begin(), x.end(), 0.0) / n,
               my = std::accumulate(y.begin(), y.end(), 0.0) / n;
  double xy = 0, xx = 0, yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (x[i] - mx) * (y[i] - my);
    xx += (x[i] - mx) * (x[i] - mx);
    yy += (y[i] - my) * (y[i] - my);
  }
  return xx > 0 && yy > 0 ? xy / std::sqrt(xx * yy) : 0;
}

void judge_hit(const Hit& hit, Findings& findings) {
  const auto bound = [&](const char* what, double value, double least, double most) {
    const std::string name = std::string(hit.place) + ": " + what;
    findings.at_least((name + ", least").c_str(), value, least);
    findings.at_most((name + ", most").c_str(), value, most);
  };
  bound("peak (deg)", hit.peak / kDegree, kLeastPeak / kDegree, kMostPeak / kDegree);
  bound("time of the peak (s)", hit.peak_time, kEarliestPeak, kLatestPeak);
  if (hit.peak > kBackWithin) bound("back within 5 degrees (s)", hit.back, kSoonestBack, kLatestBack);
  findings.at_most((std::string(hit.place) + ": overshoot (share)").c_str(), hit.overshoot, kMostOvershoot);
}

void judge_tone(const std::vector<Hit>& hits, Tone tone, Findings& findings) {
  for (const HitPlace& place : kPlaces) {
    std::map<double, std::pair<std::vector<double>, std::vector<double>>> growth;  // by rate
    for (const Hit& hit : hits) {
      if (hit.tone != tone || std::strcmp(hit.place, place.name) != 0) continue;
      if (!hit.refused.empty()) return findings.refuse(hit.refused);
      growth[hit.hz].first.push_back(hit.impulse);
      growth[hit.hz].second.push_back(hit.peak);
      if (hit.impulse < kLeastJudged || hit.impulse > kMostJudged) continue;
      judge_hit(hit, findings);
      findings.at_most("unknowns 1 s after", hit.unknowns, 0);
      findings.at_least("turn in the frame of the hit (deg)", hit.first / kDegree, 1e-3);
    }
    for (const auto& [hz, grown] : growth)
      findings.at_least((std::string(place.name) + ": rank correlation of peak and impulse").c_str(),
                        rank_correlation(grown.first, grown.second), kLeastRankCorrelation);
  }
}

/// The same hit at several rates: widest span of its peak over the smallest.
void judge_rates(const std::vector<Hit>& hits, Findings& findings) {
  std::map<std::string, std::pair<double, double>> span;
  for (const Hit& hit : hits) {
    if (hit.impulse < kLeastJudged || hit.impulse > kMostJudged) continue;
    const std::string of =
        std::string(hit.place) + ", " + name_of(hit.tone) + ", " + std::to_string(hit.impulse);
    auto& [least, most] = span.try_emplace(of, hit.peak, hit.peak).first->second;
    least = std::min(least, hit.peak);
    most = std::max(most, hit.peak);
  }
  for (const auto& [of, peaks] : span) {
    const std::string name = of.substr(0, of.rfind(',')) + ": peaks apart (share)";
    findings.at_most(name.c_str(), peaks.second / std::max(peaks.first, 1e-9) - 1, kMostApart);
  }
}

}  // namespace

std::vector<Hit> run_hits(const HitPlan& plan, const std::function<void(int, int)>& progress) {
  std::vector<Hit> hits;
  for (const double hz : plan.rates) {
    scene::Recording led;
    scene::Telemetry telemetry;
    const convert::Error error = scene::run_scene(balancing_scene("stand", false, kHitAt + kWatchedAfter, hz),
                                                  led, telemetry, nullptr);
    for (const HitPlace& place : kPlaces)
      for (const Tone tone : kTones)
        for (const double impulse : plan.impulses) {
          Hit& hit = hits.emplace_back();
          hit.place = place.name;
          hit.tone = tone;
          hit.hz = hz;
          hit.impulse = impulse;
          if (error) hit.refused = error.message;
        }
    if (error) continue;
    const std::size_t begin = hits.size() - std::size(kPlaces) * std::size(kTones) * plan.impulses.size();
    std::mutex writing;
    int done = 0;
    const int count = static_cast<int>(hits.size() - begin);
    on_all_processors(count, [&](int n) {
      Hit& hit = hits[begin + static_cast<std::size_t>(n)];
      const auto* place = std::find_if(std::begin(kPlaces), std::end(kPlaces), [&](const HitPlace& p) {
        return std::strcmp(p.name, hit.place) == 0;
      });
      hit = run_hit(*place, hit.tone, hit.hz, hit.impulse, led);
      const std::lock_guard lock(writing);
      if (progress) progress(++done, count);
    });
  }
  return hits;
}

std::vector<HitScene> judge_hits(const std::vector<Hit>& hits) {
  std::vector<HitScene> scenes;
  if (hits.empty()) return scenes;
  for (const Tone tone : kTones) {
    scenes.push_back({std::string("hits_") + name_of(tone), {}});
    judge_tone(hits, tone, scenes.back().findings);
  }
  const auto other_rate = [&](const Hit& hit) { return hit.hz != hits.front().hz; };
  if (std::any_of(hits.begin(), hits.end(), other_rate)) {
    scenes.push_back({"hits_rates", {}});
    judge_rates(hits, scenes.back().findings);
  }
  return scenes;
}

nlohmann::json hits_json(const std::vector<Hit>& hits) {
  nlohmann::json out = nlohmann::json::array();
  for (const Hit& hit : hits)
    out.push_back({{"place", hit.place},
                   {"tone", name_of(hit.tone)},
                   {"hz", hit.hz},
                   {"impulse", hit.impulse},
                   {"peak_deg", hit.peak / kDegree},
                   {"peak_s", hit.peak_time},
                   {"back_s", hit.back},
                   {"overshoot", hit.overshoot},
                   {"unknowns_after_1_s", hit.unknowns}});
  return out;
}

std::string hits_table(const std::vector<Hit>& hits) {
  if (hits.empty()) return "";
  std::string text =
      "hits on who stands, from ahead, thighs from behind: peak (deg) at (s), back within 5 deg (s), "
      "overshoot (%)\n";
  char line[200];
  for (const Hit& hit : hits) {
    std::snprintf(line, sizeof line,
                  "    %3.0f Hz  %-8s %-7s %3.0f N·s  %5.1f at %.3f  back %.2f  over %3.0f  unknowns %d\n",
                  hit.hz, hit.place, name_of(hit.tone), hit.impulse, hit.peak / kDegree, hit.peak_time,
                  hit.back, 100 * hit.overshoot, hit.unknowns);
    text += line;
  }
  return text;
}

}  // namespace sinew::study
