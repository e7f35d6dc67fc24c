// The counting program without any effect.
#include "study/effect_cost/modules.h"

namespace sinew::study {

std::unique_ptr<Effect<float>> make_module(const std::string& /*name*/,
                                           const std::vector<std::string>& /*joints*/) {
  return nullptr;
}

bool declare_module(const std::string& /*name*/, World<float>& /*world*/) {
  return false;
}

void begin_contact(const Kinematics<float>& /*a*/, const Kinematics<float>* /*b*/,
                   Contact<float>& /*contact*/) {}

void declare_term(const std::string& /*name*/, StepPlan<float>& /*plan*/) {}

Status add_ties(const std::string& /*name*/, int /*count*/, World<float>& /*world*/) {
  return Status::error(Code::kInvalidArgument, "no effects");
}

}  // namespace sinew::study
