#include "sinew/character/sleep.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

/// A state whose target moves is not at rest, however slow it is, unless it has no use for a target.
template <class T>
bool rests(const CharacterState<T>& s, const LevelOfDetail& detail) {
  if (s.pushed() || s.crowded) return false;
  for (const Effect<T>* effect : s.problem.effects)
    if (!effect->passive()) return false;  // wind rises again
  if (!s.passive()) {
    const auto same = [](const JointJet<T>& a, const JointJet<T>& b) {
      return a.rotation.coeffs() == b.rotation.coeffs() && a.translation == b.translation;
    };
    if (!std::equal(s.target.begin(), s.target.end(), s.last_target().begin(), same)) return false;
  }
  const double time = double(s.tree.scale.time), speed = detail.sleep_speed * time,
               spin = detail.sleep_spin / time;
  for (int i = 0; i < s.tree.bodies; ++i)
    if (s.history.velocity[i].squaredNorm() > T(speed * speed) ||
        s.history.rotation_rate[i].squaredNorm() > T(2 * spin * spin))
      return false;
  return true;
}

}  // namespace

template <class T>
bool is_woken(const CharacterState<T>& s) {
  return s.levels.wake || s.pushed();
}

template <class T>
void put_to_sleep(std::span<CharacterState<T>* const> members, std::span<const int> indices,
                  std::span<Coupling<T>* const> ties, const LevelOfDetail& detail, T h) {
  if (detail.sleep_after <= 0) return;
  bool all = std::none_of(ties.begin(), ties.end(), [](const Coupling<T>* c) { return c->closes(); });
  const bool may = all;
  for (const CharacterState<T>* s : members)  // who plays is no burden, and may leap at any time
    if (s->driven && s->undisturbed()) return;
  for (CharacterState<T>* s : members) {
    s->levels.still = may && rests(*s, detail) ? s->levels.still + static_cast<float>(h) : 0;
    all = all && double(s->levels.still) >= detail.sleep_after * double(s->tree.scale.time);
  }
  if (!all) return;
  for (CharacterState<T>* s : members) {
    s->levels.asleep = true;
    s->levels.nap = indices[0];
    s->levels.did = Level::kAsleep;
    s->history.stop();
    for (auto* rates : {&s->rate, &s->rate_before})
      std::fill(rates->begin(), rates->end(), std::array<T, 6>{});
    s->report_totals(Vec3<double>::Zero());
    std::fill(s->unknown.begin(), s->unknown.end(), std::uint8_t{0});
    s->report.unknown_dofs = s->report.outer_passes = s->report.factorisations = s->report.substeps = 0;
  }
}

SINEW_SLEEP_INSTANCES(template, float)
SINEW_SLEEP_INSTANCES(template, double)

}  // namespace sinew
