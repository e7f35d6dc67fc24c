#include "convert/human.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <span>

namespace sinew::convert {
namespace {

struct Row {
  const char* name;
  double male, female;
};

// N·m/kg. From dynamometer means (Anderson 2007, Šarabon 2021, Sugimoto 2014, Delp 1996, neck: Ann Biomed Eng
// 2014 and 220 women of Jyväskylä, shoulder: isokinetic studies), raised where running asks more than a
// dynamometer shows (muscle model and inverse dynamics of Rajagopal 2016 and Gait2392). Toes, clavicles:
// low confidence.
constexpr Row kRows[] = {{"ankle_plantarflexion", 3.3, 3.0},
                         {"ankle_dorsiflexion", 0.65, 0.5},
                         {"subtalar_inversion", 0.75, 0.6},
                         {"subtalar_eversion", 0.5, 0.4},
                         {"toes_flexion", 0.35, 0.28},
                         {"toes_extension", 0.12, 0.1},
                         {"knee_extension", 3.5, 2.8},
                         {"knee_flexion", 1.6, 1.2},
                         {"hip_extension", 3.3, 2.9},
                         {"hip_flexion", 2.3, 2.0},
                         {"hip_abduction", 2.2, 1.9},
                         {"hip_adduction", 2.2, 1.8},
                         {"hip_internal_rotation", 1.0, 0.8},
                         {"hip_external_rotation", 1.0, 0.8},
                         {"lumbar_extension", 4.0, 3.0},
                         {"lumbar_flexion", 2.5, 1.8},
                         {"lumbar_lateral", 2.4, 1.8},
                         {"lumbar_rotation", 1.3, 0.95},
                         {"neck_extension", 0.7, 0.5},
                         {"neck_flexion", 0.4, 0.28},
                         {"neck_lateral", 0.45, 0.3},
                         {"neck_rotation", 0.2, 0.14},
                         {"clavicle_elevation", 1.2, 0.75},
                         {"clavicle_depression", 0.8, 0.5},
                         {"clavicle_protraction", 1.0, 0.6},
                         {"clavicle_retraction", 1.0, 0.6},
                         {"shoulder_flexion", 1.15, 0.65},
                         {"shoulder_extension", 1.3, 0.75},
                         {"shoulder_abduction", 0.95, 0.5},
                         {"shoulder_adduction", 1.2, 0.7},
                         {"shoulder_internal_rotation", 0.7, 0.38},
                         {"shoulder_external_rotation", 0.5, 0.28},
                         {"elbow_flexion", 0.95, 0.55},
                         {"elbow_extension", 0.75, 0.42},
                         {"forearm_supination", 0.18, 0.09},
                         {"forearm_pronation", 0.16, 0.08},
                         {"wrist_flexion", 0.18, 0.11},
                         {"wrist_extension", 0.11, 0.065},
                         {"wrist_radial_deviation", 0.15, 0.09},
                         {"wrist_ulnar_deviation", 0.14, 0.085}};

struct Point {
  double age, value;
};

double at_age(std::span<const Point> points, double age) {
  if (age <= points.front().age) return points.front().value;
  for (std::size_t i = 1; i < points.size(); ++i)
    if (age <= points[i].age) {
      const Point &a = points[i - 1], &b = points[i];
      return a.value + (b.value - a.value) * (age - a.age) / (b.age - a.age);
    }
  return points.back().value;
}

/// Strength per kg against an adult's (Anderson 2007 for the old; children: low confidence).
constexpr Point kStrengthOfAge[] = {{10, 0.75}, {18, 1.0}, {50, 1.0}, {75, 0.6}};
/// Median body-mass index, kg/m² (WHO 2007 growth reference; adults 18.5–25).
constexpr Point kMassIndex[] = {{5, 15.3},  {8, 15.8},  {10, 16.5}, {12, 17.6},
                                {15, 19.9}, {18, 21.7}, {20, 22.5}};

/// Shares of body mass. Adults: de Leva 1996. Children: Jensen 1986. The neck is 18 % of head and neck, the
/// toes 15 % of the foot, a clavicle 1 % of the body taken from the upper trunk.
struct Shares {
  double age, head_neck, upper_trunk, middle_trunk, lower_trunk, upper_arm, forearm, hand, thigh, shank, foot;
};
constexpr Shares kMale = {18, 0.0694, 0.1596, 0.1633, 0.1117, 0.0271, 0.0162, 0.0061, 0.1416, 0.0433, 0.0137};
constexpr Shares kFemale = {18,     0.0668, 0.1545, 0.1465, 0.1247, 0.0255,
                            0.0138, 0.0056, 0.1478, 0.0481, 0.0129};
// The trunk is split as the adult male's.
constexpr Shares kChildren[] = {
    {6, 0.1816, 0.1576, 0.1612, 0.1103, 0.0240, 0.0130, 0.0080, 0.0848, 0.0459, 0.0190},
    {12, 0.1008, 0.1528, 0.1564, 0.1070, 0.0319, 0.0170, 0.0090, 0.1098, 0.0529, 0.0210},
    {15, 0.0671, 0.1529, 0.1565, 0.1070, 0.0350, 0.0170, 0.0080, 0.1211, 0.0561, 0.0210}};

const Shares& shares(const Human& human) {
  if (human.age > 0 && human.age < 16.5)
    return *std::min_element(std::begin(kChildren), std::end(kChildren),
                             [&](const Shares& a, const Shares& b) {
                               return std::abs(a.age - human.age) < std::abs(b.age - human.age);
                             });
  return human.female ? kFemale : kMale;
}

}  // namespace

std::map<std::string, double> muscle_rows(const Human& human) {
  const double factor = human.age > 0 ? at_age(kStrengthOfAge, human.age) : 1;
  std::map<std::string, double> rows;
  for (const Row& row : kRows) rows[row.name] = factor * (human.female ? row.female : row.male);
  return rows;
}

double reference_stature(const Human& human) {
  return human.female ? 1.65 : 1.75;
}

double mass_from_height(double height, const Human& human) {
  const double index = human.age > 0 ? at_age(kMassIndex, human.age) : 22.5;
  const double human_height = human.age > 0 ? height : std::clamp(height, 1.4, 2.1);
  return index * height * height * (height / human_height);
}

double mass_share(Role role, const Human& human) {
  const Shares& s = shares(human);
  switch (role) {
    case Role::kNone:
      return 0;
    case Role::kPelvis:
      return s.lower_trunk;
    case Role::kSpine:
      return s.middle_trunk;
    case Role::kChest:
      return s.upper_trunk - 0.02;
    case Role::kNeck:
      return 0.18 * s.head_neck;
    case Role::kHead:
      return 0.82 * s.head_neck;
    case Role::kClavicleL:
    case Role::kClavicleR:
      return 0.01;
    case Role::kUpperArmL:
    case Role::kUpperArmR:
      return s.upper_arm;
    case Role::kForearmL:
    case Role::kForearmR:
      return s.forearm;
    case Role::kHandL:
    case Role::kHandR:
      return s.hand;
    case Role::kThighL:
    case Role::kThighR:
      return s.thigh;
    case Role::kShinL:
    case Role::kShinR:
      return s.shank;
    case Role::kFootL:
    case Role::kFootR:
      return 0.85 * s.foot;
    case Role::kToesL:
    case Role::kToesR:
      return 0.15 * s.foot;
  }
  return 0;
}

double density(Role role) {
  // Limbs: Drillis & Contini 1966. Head, trunk (lungs included): common textbook values.
  switch (role) {
    case Role::kNeck:
    case Role::kHead:
      return 1110;
    case Role::kUpperArmL:
    case Role::kUpperArmR:
      return 1086;
    case Role::kForearmL:
    case Role::kForearmR:
      return 1127;
    case Role::kHandL:
    case Role::kHandR:
      return 1148;
    case Role::kThighL:
    case Role::kThighR:
      return 1089;
    case Role::kShinL:
    case Role::kShinR:
      return 1095;
    case Role::kFootL:
    case Role::kFootR:
    case Role::kToesL:
    case Role::kToesR:
      return 1107;
    default:
      return 1030;
  }
}

}  // namespace sinew::convert
