#include "graph/condition.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace sinew::graph_tools {
namespace {

using Steps = std::vector<ConditionStep>;

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what);
}

template <class List, class Name>
int place_of(const List& list, const std::string& wanted, Name name) {
  for (std::size_t k = 0; k < list.size(); ++k)
    if (name(list[k]) == wanted) return static_cast<int>(k);
  return -1;
}

struct Value {
  Steps steps;
  bool truth = false;  ///< else a number
  std::string text;
};

class Parser {
 public:
  Parser(const std::string& text, const ConditionNames& names) : text_(text), names_(names) {}

  Steps parse() {
    const Value value = disjunction();
    skip();
    if (at_ != text_.size()) fail("does not understand '" + text_.substr(at_) + "' in \"" + text_ + "\"");
    return truth(value).steps;
  }

 private:
  void skip() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }
  bool take(const std::string& token) {
    skip();
    if (text_.compare(at_, token.size(), token) != 0) return false;
    at_ += token.size();
    return true;
  }
  void expect(const std::string& token) {
    if (!take(token)) fail("'" + token + "' is missing in \"" + text_ + "\"");
  }
  static const Value& truth(const Value& value) {
    if (!value.truth) fail("'" + value.text + "' is a number: compare it with something");
    return value;
  }
  static const Value& number(const Value& value) {
    if (value.truth) fail("'" + value.text + "' is true or false and cannot be compared");
    return value;
  }
  static Value join(Value a, const Value& b, ConditionCode code) {
    a.steps.insert(a.steps.end(), b.steps.begin(), b.steps.end());
    a.steps.push_back({code, 0, 0});
    a.truth = true;
    return a;
  }

  Value disjunction() {
    if (++depth_ > 32) fail("condition is nested too deep");
    Value value = conjunction();
    while (take("||")) {
      truth(value);
      value = join(value, truth(conjunction()), ConditionCode::kOr);
    }
    --depth_;
    return value;
  }
  Value conjunction() {
    Value value = negation();
    while (take("&&")) {
      truth(value);
      value = join(value, truth(negation()), ConditionCode::kAnd);
    }
    return value;
  }
  Value negation() {
    skip();
    if (text_.compare(at_, 2, "!=") != 0 && take("!")) {
      if (++depth_ > 32) fail("condition is nested too deep");
      Value value = truth(negation());
      --depth_;
      value.steps.push_back({ConditionCode::kNot, 0, 0});
      return value;
    }
    return comparison();
  }
  Value comparison() {
    const Value a = value();
    struct Operator {
      const char* token;
      ConditionCode code;
      bool swapped, negated;
    };
    static constexpr Operator kOperators[] = {
        {"<=", ConditionCode::kLessEqual, false, false}, {">=", ConditionCode::kLessEqual, true, false},
        {"==", ConditionCode::kEqual, false, false},     {"!=", ConditionCode::kEqual, false, true},
        {"<", ConditionCode::kLess, false, false},       {">", ConditionCode::kLess, true, false}};
    for (const Operator& op : kOperators) {
      if (!take(op.token)) continue;
      number(a);
      const Value b = number(value());
      Value out = op.swapped ? join(b, a, op.code) : join(a, b, op.code);
      if (op.negated) out.steps.push_back({ConditionCode::kNot, 0, 0});
      return out;
    }
    return a;
  }
  Value value() {
    skip();
    if (take("(")) {
      const Value inner = disjunction();
      expect(")");
      return inner;
    }
    if (at_ >= text_.size()) fail("\"" + text_ + "\" ends too early");
    const char c = text_[at_];
    if (std::isdigit(static_cast<unsigned char>(c)) || c == '-' || c == '.') return literal();
    return name();
  }
  Value literal() {
    char* end = nullptr;
    const float v = std::strtof(text_.c_str() + at_, &end);
    const std::size_t length = static_cast<std::size_t>(end - text_.c_str()) - at_;
    if (length == 0 || !std::isfinite(v)) fail("no number at '" + text_.substr(at_) + "'");
    Value out{{{ConditionCode::kNumber, 0, v}}, false, text_.substr(at_, length)};
    at_ += length;
    return out;
  }
  std::string word() {
    skip();
    const std::size_t begin = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_' ||
                                  text_[at_] == '.' || text_[at_] == '-'))
      ++at_;
    if (at_ == begin) fail("does not understand '" + text_.substr(begin) + "' in \"" + text_ + "\"");
    return text_.substr(begin, at_ - begin);
  }
  Value name() {
    const std::string word = this->word();
    const auto step = [&](ConditionCode code, int index) {
      return Steps{{code, static_cast<std::uint16_t>(index), 0}};
    };
    if (word == "true" || word == "false")
      return {{{ConditionCode::kNumber, 0, word == "true" ? 1.f : 0.f}}, true, word};
    if (word == "phase" || word == "event") {
      expect("(");
      const std::string inner = this->word();
      expect(")");
      if (word == "event") return {step(ConditionCode::kEvent, names_.event(inner)), true, word};
      const int group = place_of(names_.graph->groups, inner, [](const std::string& s) { return s; });
      if (group < 0) fail("no clip is synchronised as '" + inner + "'");
      return {step(ConditionCode::kPhase, group), false, word};
    }
    const int parameter = names_.graph->find_parameter(word);
    if (parameter >= 0) {
      const bool number = names_.graph->parameters[std::size_t(parameter)].type == ParameterType::kFloat;
      return {step(ConditionCode::kParameter, parameter), !number, word};
    }
    if (word == "time") return {step(ConditionCode::kTime, 0), false, word};
    if (word == "remaining") return {step(ConditionCode::kRemaining, 0), false, word};
    if (word == "fading") return {step(ConditionCode::kFading, 0), true, word};
    fail("no parameter '" + word + "'");
  }

  const std::string& text_;
  const ConditionNames& names_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

std::string shown(float v) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", double(v));
  return text;
}

std::string leaf(const ConditionStep& step, const GraphDefinition& graph) {
  switch (step.code) {
    case ConditionCode::kParameter:
      return graph.parameters[step.index].name;
    case ConditionCode::kTime:
      return "time";
    case ConditionCode::kRemaining:
      return "remaining";
    case ConditionCode::kPhase:
      return "phase(" + graph.groups[step.index] + ")";
    case ConditionCode::kEvent:
      return "event(" + graph.events[step.index] + ")";
    case ConditionCode::kFading:
      return "fading";
    default:
      return shown(step.value);
  }
}

}  // namespace

std::vector<ConditionStep> parse_condition(const std::string& text, const ConditionNames& names) {
  Steps steps = Parser(text, names).parse();
  int height = 0, most = 0;
  for (const ConditionStep& step : steps) {
    if (step.code < ConditionCode::kLess)
      most = std::max(most, ++height);
    else if (step.code != ConditionCode::kNot)
      --height;
  }
  if (most > GraphDefinition::kDeepestCondition) fail("\"" + text + "\" needs more than 16 values at once");
  return steps;
}

std::string condition_text(const std::vector<ConditionStep>& steps, const GraphDefinition& graph) {
  std::vector<std::string> stack;
  for (const ConditionStep& step : steps) {
    if (step.code < ConditionCode::kLess) {
      stack.push_back(leaf(step, graph));
    } else if (step.code == ConditionCode::kNot) {
      stack.back() = "!(" + stack.back() + ")";
    } else {
      const std::string b = stack.back();
      stack.pop_back();
      static constexpr const char* kNames[] = {"<", "<=", "==", "&&", "||"};
      const bool logic = step.code >= ConditionCode::kAnd;
      const std::string joined =
          stack.back() + " " + kNames[static_cast<int>(step.code) - static_cast<int>(ConditionCode::kLess)] +
          " " + b;
      stack.back() = logic ? "(" + joined + ")" : joined;
    }
  }
  return stack.empty() ? "always" : stack.back();
}

}  // namespace sinew::graph_tools
