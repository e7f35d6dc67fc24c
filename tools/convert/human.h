// Published figures of the human body: how strong, how heavy, how dense.
#pragma once

#include <map>
#include <string>

#include "sinew/skeleton/skeleton.h"

namespace sinew::convert {

/// Whom the tables are read for.
struct Human {
  bool female = false;
  double age = 0;  ///< years; 0: an adult between 18 and 50
};

/// N·m per kg of body mass at the reference stature, by row name ("knee_extension"): what lets an average
/// adult walk, jog and get up without giving way (README.md, "Muscles"). Scaled for children and the old.
std::map<std::string, double> muscle_rows(const Human& human);

/// The stature that the rows were measured at, m. Torque = row · mass · stature / reference.
double reference_stature(const Human& human);

/// Mass of a body of this height, kg: body-mass index of the age; beyond human heights as the cube of the
/// height, so that the density stays human.
double mass_from_height(double height, const Human& human);

/// Share of a body's mass that a part of this role has, or 0 (kNone). For skeletons without a skin.
double mass_share(Role role, const Human& human);

/// kg/m³ of a body part.
double density(Role role);

/// A cartoon head weighs no more than this share of the body: a six-year-old's.
constexpr double kLargestHeadShare = 0.18;

}  // namespace sinew::convert
