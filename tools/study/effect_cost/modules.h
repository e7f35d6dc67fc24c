// The effects that the counting program knows; bare programs are linked with an empty list instead.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sinew/character/world.h"
#include "sinew/effects/contact.h"

namespace sinew::study {

/// An effect of runtime/sinew/effects on the named joints, or null where the program has none of that name.
std::unique_ptr<Effect<float>> make_module(const std::string& name, const std::vector<std::string>& joints);

/// Declares an effect of the whole world; false where the program has none of that name.
bool declare_module(const std::string& name, World<float>& world);
/// Declares a term of the solver, where the program has one of that name.
void declare_term(const std::string& name, StepPlan<float>& plan);

/// See begin_step of contact.h.
void begin_contact(const Kinematics<float>& a, const Kinematics<float>* b, Contact<float>& contact);

/// So many loops between the world's first character and the world; particles of a strand, rows of a strip of
/// cloth, cells of a bar of soft tissue.
Status add_ties(const std::string& name, int count, World<float>& world);

}  // namespace sinew::study
