// Conditions of transitions, as text: "speed > 0.5 && !grounded || event(hit)".
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sinew/graph/graph_definition.h"

namespace sinew::graph_tools {

/// What names in conditions stand for.
struct ConditionNames {
  const GraphDefinition* graph = nullptr;        ///< parameters and groups
  std::function<int(const std::string&)> event;  ///< index of an event's name, added where it is new
};

/// The steps of a condition. Throws std::runtime_error that says what is wrong: an unknown name, a number
/// where a truth is asked for, or the reverse.
///
///     or := and ("||" and)*      and := not ("&&" not)*      not := "!" not | comparison
///     comparison := value (("<" | "<=" | ">" | ">=" | "==" | "!=") value)?
///     value := number | parameter | "time" | "remaining" | "fading" | "phase(GROUP)" | "event(NAME)" | "("
///     or ")"
std::vector<ConditionStep> parse_condition(const std::string& text, const ConditionNames& names);

/// Whether there are values for which it holds: numbers within what a game may set (±10⁶), times and phases
/// as they can be, physical values as they are measured. Numbers that are compared with each other, and
/// conditions of more than some hundred cases, are taken to be possible. Never false for what can be true.
bool can_be_true(const std::vector<ConditionStep>& steps, const GraphDefinition& graph);

/// As text again.
std::string condition_text(const std::vector<ConditionStep>& steps, const GraphDefinition& graph);

}  // namespace sinew::graph_tools
