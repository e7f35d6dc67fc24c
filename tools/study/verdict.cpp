#include <cstdio>

#include "study/hard_case.h"

namespace sinew::study {
namespace {

std::string compared(const char* what, double value, const char* relation, double bound) {
  char text[200];
  std::snprintf(text, sizeof text, "%s %.3g, %s %.3g wanted", what, value, relation, bound);
  return text;
}

}  // namespace

void Verdict::at_most(const char* what, double value, double bound) {
  require(value <= bound, compared(what, value, "at most", bound));
}

void Verdict::at_least(const char* what, double value, double bound) {
  require(value >= bound, compared(what, value, "at least", bound));
}

std::string excess_of(const Measurement& m) {
  constexpr int kUsual = 8, kMost = 16;
  if (const int usual = m.passes_percentile(0.99); usual > kUsual)
    return compared("99th percentile of passes", usual, "at most", kUsual);
  if (m.most_passes > kMost) return compared("passes of a solve", m.most_passes, "at most", kMost);
  return {};
}

void Verdict::sound() {
  require(measured_.refused.empty(), "refused: " + measured_.refused);
  require(measured_.finite, "NaN or infinity");
  at_most("joint gap (m)", measured_.joint_gap, 1e-5);  // float's rounding some 10 m from the origin
  at_most("turn of a joint about what it is no hinge for (rad)", measured_.joint_angle, 1e-5);
  at_most("share of unconverged steps", measured_.unconverged_share(), 1e-3);
}

void Verdict::general() {
  sound();
  const double most = 1e-3 * measured_.kinetic_most + 1e-6;
  at_most("energy without work (J)", measured_.energy_gain, most);
  at_most("energy that a step's way needs beyond what there is (J)", measured_.leap, most);
}

}  // namespace sinew::study
