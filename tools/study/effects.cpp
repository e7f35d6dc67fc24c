#include "study/effects.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>

namespace sinew::study {
namespace {

constexpr int kCountedSteps = 10;  ///< all alike: the mean tells no more

struct Kind {
  const char *effect, *mode;
  const char* instance;              ///< what one is; null: it is on or off
  const char* not_linear = nullptr;  ///< why, where a straight line does not fit
};

constexpr const char* kProducts =
    "the number of products of conjugate gradients depends on what hangs together";

constexpr const char* kBrought =
    "a ball that does not bounce is brought to rest on the floor instead, which costs as much";

constexpr Kind kKinds[] = {
    {"wind", "checked", "collider"},
    {"wind", "pass", "collider"},
    {"buoyancy", "checked", "collider"},
    {"buoyancy", "pass", "collider"},
    {"joint_spring", "checked", "joint"},
    {"joint_spring", "pass", "joint"},
    {"force_field", "checked", "body"},
    {"force_field", "pass", "body"},
    {"gravity", "checked", nullptr},
    {"support", "checked", "capsule on the floor"},
    {"impulses", "checked", "push"},
    {"muscles", "checked", nullptr},  // all joints are compared where one has a limit
    {"muscles", "pass", "degree of freedom"},
    {"joint_limits", "pass", "limit that bears"},
    {"joint_damping", "pass", "degree of freedom"},
    {"dry_friction", "pass", "degree of freedom"},
    {"ground", "solve", "point, with friction"},
    {"obstacle", "solve", "point, with friction"},
    {"self_collision", "solve", "point, with friction", kProducts},
    {"character_contact", "solve", "point, with friction"},
    {"loops", "step", "point of a limp wheel"},
    {"restitution", "step", "ball that bounces", kBrought},
    {"continuous_detection", "step", "ball that may pass a plate"},
    {"prop", "step", "box in flight"},
    {"resting_prop", "step", "box on the floor: 4 points"},
    {"prop_contact", "step", "box on a box on the floor"},
    {"strand", "step", "particle", kProducts},
    {"cloth", "step", "row: 2 particles", kProducts},
    {"soft_tissue", "step", "cell: 4 particles", kProducts},
};

/// What a command prints, its errors thrown away; empty when it failed.
std::string answer(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen((command + " 2>/dev/null").c_str(), "r"), pclose);
  if (!pipe) return {};
  std::string text;
  std::array<char, 256> part{};
  while (std::fgets(part.data(), part.size(), pipe.get())) text += part.data();
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

/// For the shell.
std::string quoted(const std::string& path) {
  std::string out = "'";
  for (const char c : path) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// Nothing is declared where there are no instances: what an empty declaration costs is a test's business.
std::string arguments(const Kind& kind, int instances) {
  const std::string_view effect = kind.effect, mode = kind.mode;
  const bool own_scene = mode == "step" || effect == "support" || effect == "character_contact";
  return fmt::format(" {} {} {}", mode, instances == 0 && !own_scene ? "none" : effect, instances);
}

/// `counted`: answers so far; the step without effects is the same for many.
convert::Error measure(const EffectOptions& options, bool counts, const Kind& kind,
                       std::map<std::string, double>& counted, EffectCost& cost) {
  cost.effect = kind.effect;
  cost.mode = kind.mode;
  if (kind.instance) cost.instance = kind.instance;
  if (kind.not_linear) cost.not_linear = kind.not_linear;
  const int runs = options.quick ? 1 : 5;
  const int steps = (options.quick ? 50 : 2000) / (cost.mode == "step" ? 10 : 1);
  for (std::size_t i = 0; i < kInstances.size(); ++i) {
    const std::string what = arguments(kind, kInstances[i]);
    if (counts && !counted.contains(what)) counted[what] = count_instructions(options, what);
    cost.instructions[i] = counts ? counted[what] : -1;
    cost.microseconds[i] = 1e9;
    for (int run = 0; run < runs; ++run) {
      double microseconds = 0, bytes = 0;
      if (!(std::istringstream(answer(quoted(options.program) + what + " " + std::to_string(steps))) >>
            microseconds >> bytes))
        return {options.program + ": cannot be run"};
      cost.microseconds[i] = std::min(cost.microseconds[i], microseconds);
      cost.bytes[i] = bytes;
    }
  }
  fit(cost);
  return {};
}

std::string machine() {
  std::ifstream in("/proc/cpuinfo");
  std::string processor = "unknown processor";
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) {
      processor = line.substr(line.find(": ") + 2);
      break;
    }
  return processor + ", g++ " + __VERSION__;
}

}  // namespace

double count_instructions(const EffectOptions& options, const std::string& arguments) {
  const std::string file = options.directory + "/callgrind.out." + std::to_string(getpid());
  (void)answer(
      "valgrind --tool=callgrind --collect-atstart=no --toggle-collect=count_here "
      "--callgrind-out-file=" +
      quoted(file) + " " + quoted(options.program) + " " + arguments + " " + std::to_string(kCountedSteps));
  std::ifstream in(file);
  double total = -1;
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("totals: ")) total = std::strtod(line.c_str() + 8, nullptr) / kCountedSteps;
  in.close();
  std::remove(file.c_str());
  return total > 0 ? total : -1;
}

void fit(EffectCost& cost) {
  // y = fixed + each·n, minimising Σ((fit − y)/y)².
  double s[3] = {}, b[2] = {};
  for (std::size_t i = 1; i < kInstances.size(); ++i) {
    const double y = cost.instructions[i] - cost.instructions[0];
    if (!(y > 0)) return;
    const double w = 1 / (y * y), n = kInstances[i];
    s[0] += w;
    s[1] += w * n;
    s[2] += w * n * n;
    b[0] += w * y;
    b[1] += w * n * y;
  }
  cost.each = (s[0] * b[1] - s[1] * b[0]) / (s[0] * s[2] - s[1] * s[1]);
  cost.fixed = (b[0] - s[1] * cost.each) / s[0];
  cost.misfit = 0;
  for (std::size_t i = 1; i < kInstances.size(); ++i) {
    const double y = cost.instructions[i] - cost.instructions[0];
    cost.misfit = std::max(cost.misfit, std::abs(cost.fixed + cost.each * kInstances[i] - y) / y);
  }
}

convert::Error run_effects(const EffectOptions& options, const std::function<void(int, int)>& progress,
                           EffectStudy& out) {
  out.machine = machine();
  out.counted_by = answer("valgrind --version");
  const bool counts = !out.counted_by.empty();
  if (counts) {
    out.bare = count_instructions(options, "bare none 0");
    out.step = count_instructions(options, "checked none 0");
    if (out.step < 0) out.counted_by += ", which cannot run the counting program";
  }
  std::map<std::string, double> counted;
  const int total = static_cast<int>(std::size(kKinds));
  for (int n = 0; n < total; ++n) {
    if (progress) progress(n, total);
    if (!options.mode.empty() && options.mode != kKinds[n].mode) continue;
    if (convert::Error error = measure(options, out.step > 0, kKinds[n], counted, out.costs.emplace_back()))
      return error;
  }
  if (progress) progress(total, total);
  return {};
}

std::string effects_table(const EffectStudy& study) {
  std::string text =
      fmt::format("{}; {}\n\n", study.machine,
                  study.counted_by.empty() ? "valgrind is not installed: no instructions" : study.counted_by);
  if (study.step > 0)
    text +=
        fmt::format("Step without effects {:.0f} instructions, of these kinematics and residual {:.0f}.\n\n",
                    study.step, study.bare);
  text +=
      "| effect | mode | an instance is a | instructions: fixed | per instance | misfit | at 1 / 8 / 64 | "
      "ns per instance | bytes at 1 / 64 |\n|---|---|---|---|---|---|---|---|---|\n";
  for (const EffectCost& c : study.costs) {
    const auto more = [&](std::size_t i) { return c.instructions[i] - c.instructions[0]; };
    text +=
        fmt::format("| {} | {} | {} | ", c.effect, c.mode, c.instance.empty() ? "– (on or off)" : c.instance);
    if (c.instructions[0] < 0)
      text += "– | – | – | – | ";
    else if (c.instance.empty())
      text += fmt::format("{:.0f} | – | – | – | ", more(1));
    else
      text +=
          fmt::format("{:.0f} | {:.0f} | {:.2f} %{} | {:.0f} / {:.0f} / {:.0f} | ", c.fixed, c.each,
                      100 * c.misfit, c.not_linear.empty() ? "" : ": not linear", more(1), more(2), more(3));
    text += fmt::format("{:.0f} | {:.0f} / {:.0f} |\n",
                        1000 * (c.microseconds[3] - c.microseconds[1]) / (kInstances[3] - kInstances[1]),
                        c.bytes[1], c.bytes[3]);
  }
  for (const EffectCost& c : study.costs)
    if (!c.not_linear.empty()) text += fmt::format("\n{} is not linear: {}.", c.effect, c.not_linear);
  return text + "\n";
}

std::string effects_csv(const EffectStudy& study) {
  std::string csv = "effect,mode,instances,instructions,microseconds,bytes\n";
  for (const EffectCost& c : study.costs)
    for (std::size_t i = 0; i < kInstances.size(); ++i)
      csv += fmt::format("{},{},{},{},{:.4f},{:.0f}\n", c.effect, c.mode, kInstances[i],
                         c.instructions[i] < 0 ? "" : fmt::format("{:.1f}", c.instructions[i]),
                         c.microseconds[i], c.bytes[i]);
  return csv;
}

nlohmann::json effects_json(const EffectStudy& study) {
  nlohmann::json costs = nlohmann::json::array();
  for (const EffectCost& c : study.costs) {
    nlohmann::json one{{"effect", c.effect},
                       {"mode", c.mode},
                       {"instance", c.instance},
                       {"instances", kInstances},
                       {"microseconds", c.microseconds},
                       {"bytes", c.bytes}};
    if (c.instructions[0] >= 0) {
      one["instructions"] = c.instructions;
      if (!c.not_linear.empty()) one["not_linear"] = c.not_linear;
      one["fixed"] = c.fixed;
      one["each"] = c.each;
      one["misfit"] = c.misfit;
    }
    costs.push_back(std::move(one));
  }
  return {{"machine", study.machine},
          {"counted_by", study.counted_by},
          {"bare_instructions", study.bare},
          {"step_instructions", study.step},
          {"effects", std::move(costs)}};
}

}  // namespace sinew::study
