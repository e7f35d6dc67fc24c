// Conditions that no values make true: each is split into its cases, and each case into intervals.
#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "graph/condition.h"

namespace sinew::graph_tools {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr std::size_t kMostCases = 512;

/// Values between two ends, which may belong to it or not.
struct Interval {
  double least = -kInfinite, most = kInfinite;
  bool with_least = true, with_most = true;

  bool empty() const { return least > most || (least == most && !(with_least && with_most)); }
  void cut_below(double at, bool with) {
    if (at > least) with_least = with;
    if (at == least) with_least = with_least && with;
    least = std::max(least, at);
  }
  void cut_above(double at, bool with) {
    if (at < most) with_most = with;
    if (at == most) with_most = with_most && with;
    most = std::min(most, at);
  }
};

/// What a step of a condition stands for: a parameter, a time, an event.
using Name = std::pair<ConditionCode, std::uint16_t>;

/// A comparison of something named with a number, or a truth (compared with ½); nothing: always possible.
struct Term {
  Name name{};
  ConditionCode code = ConditionCode::kLess;
  double number = 0;
  bool swapped = false;  ///< the number stands first
  bool negated = false;
};
using Case = std::vector<Term>;   ///< all of them
using Cases = std::vector<Case>;  ///< one of them

/// The values that there are.
Interval range_of(const Name& name, const GraphDefinition& graph) {
  switch (name.first) {
    case ConditionCode::kTime:
    case ConditionCode::kRemaining:
      return {0, kInfinite};
    case ConditionCode::kPhase:
      return {0, 1};
    case ConditionCode::kEvent:
    case ConditionCode::kFading:
      return {0, 1};
    default:
      break;
  }
  const GraphParameter& p = graph.parameters[name.second];
  if (p.type != ParameterType::kFloat) return {0, 1};
  std::size_t mask = 0;
  const int physical = physics_value(p.name, mask);
  if (physical < 0) return {-1e6, 1e6};
  const std::string measured = kPhysicsNames[physical];
  if (measured == "physics.tilt") return {0, 3.1416};  // π, and what its rounding may add
  if (measured == "physics.face_up") return {-1.0001, 1.0001};
  return {measured == "physics.height" ? -1e6 : 0, 1e6};
}

bool is_possible(const Case& all, const GraphDefinition& graph) {
  std::map<Name, std::pair<Interval, std::vector<double>>> values;  // and those that it must not be
  for (const Term& t : all) {
    auto [at, is_new] = values.try_emplace(t.name);
    auto& [interval, others] = at->second;
    if (is_new) interval = range_of(t.name, graph);
    if (t.code == ConditionCode::kEqual) {
      if (t.negated) {
        others.push_back(t.number);
      } else {
        interval.cut_below(t.number, true);
        interval.cut_above(t.number, true);
      }
      continue;
    }
    const bool or_equal = (t.code == ConditionCode::kLessEqual) != t.negated;
    if (t.swapped != t.negated)
      interval.cut_below(t.number, or_equal);
    else
      interval.cut_above(t.number, or_equal);
  }
  return std::all_of(values.begin(), values.end(), [](const auto& value) {
    const auto& [interval, others] = value.second;
    if (interval.empty()) return false;
    return interval.least < interval.most ||
           std::find(others.begin(), others.end(), interval.least) == others.end();
  });
}

/// The cases of a condition, or of its negation, read from its end; none: too many.
class Splitter {
 public:
  explicit Splitter(const std::vector<ConditionStep>& steps) : steps_(steps), at_(steps.size()) {}

  std::optional<Cases> truth(bool negated) {
    const ConditionStep& step = steps_[--at_];
    switch (step.code) {
      case ConditionCode::kNot:
        return truth(!negated);
      case ConditionCode::kAnd:
      case ConditionCode::kOr: {
        std::optional<Cases> b = truth(negated), a = truth(negated);
        if (!a || !b) return {};
        return (step.code == ConditionCode::kAnd) != negated ? both(*a, *b) : either(std::move(*a), *b);
      }
      case ConditionCode::kLess:
      case ConditionCode::kLessEqual:
      case ConditionCode::kEqual:
        return comparison(step.code, negated);
      case ConditionCode::kNumber:
        return constant((step.value != 0) != negated);
      default:  // a truth by name: above ½, or below
        return Cases{
            {Term{{step.code, step.index}, ConditionCode::kEqual, negated ? 0.0 : 1.0, false, false}}};
    }
  }

 private:
  static Cases constant(bool value) { return value ? Cases{Case{}} : Cases{}; }
  static std::optional<Cases> either(Cases a, const Cases& b) {
    a.insert(a.end(), b.begin(), b.end());
    if (a.size() > kMostCases) return {};
    return a;
  }
  static std::optional<Cases> both(const Cases& a, const Cases& b) {
    if (a.size() * b.size() > kMostCases) return {};
    Cases out;
    for (const Case& x : a)
      for (const Case& y : b) {
        out.push_back(x);
        out.back().insert(out.back().end(), y.begin(), y.end());
      }
    return out;
  }
  Cases comparison(ConditionCode code, bool negated) {
    const ConditionStep b = steps_[--at_], a = steps_[--at_];
    const bool first = a.code == ConditionCode::kNumber, second = b.code == ConditionCode::kNumber;
    if (first && second) {
      const bool value = code == ConditionCode::kLess        ? a.value < b.value
                         : code == ConditionCode::kLessEqual ? a.value <= b.value
                                                             : a.value == b.value;
      return constant(value != negated);
    }
    if (!first && !second) {
      if (a.code != b.code || a.index != b.index) return constant(true);
      return constant((code != ConditionCode::kLess) != negated);  // with itself
    }
    const ConditionStep& named = first ? b : a;
    return {{Term{{named.code, named.index}, code, double(first ? a.value : b.value), first, negated}}};
  }

  const std::vector<ConditionStep>& steps_;
  std::size_t at_;
};

}  // namespace

bool can_be_true(const std::vector<ConditionStep>& steps, const GraphDefinition& graph) {
  if (steps.empty()) return true;
  const std::optional<Cases> cases = Splitter(steps).truth(false);
  return !cases ||
         std::any_of(cases->begin(), cases->end(), [&](const Case& all) { return is_possible(all, graph); });
}

}  // namespace sinew::graph_tools
