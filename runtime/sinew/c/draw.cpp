// Debug drawing of the C interface.
#include "sinew/c/call.h"
#include "sinew/c/fields.h"
#include "sinew/character/debug_draw.h"

namespace sinew::c {
namespace {

constexpr auto kSettings = [](auto& c, auto& s, auto&& f) {
  f("", c.skeleton, s.skeleton);
  f("", c.colliders, s.colliders);
  f("", c.contacts, s.contacts);
  f("", c.muscles, s.muscles);
  f("", c.unknowns, s.unknowns);
  f("", c.islands, s.islands);
  f("", c.support, s.support);
  f("", c.targets, s.targets);
  f("force_scale must be 0 to 1000 m/N", c.force_scale, s.force_scale, 0, 1000);
};

std::uint32_t packed(DebugColor color) {
  return std::uint32_t(color.r) << 24 | std::uint32_t(color.g) << 16 | std::uint32_t(color.b) << 8 | color.a;
}

class HostRenderer final : public DebugRenderer {
 public:
  explicit HostRenderer(const sinew_draw_settings& host) : host_(host) {}

  void line(const Vec3<double>& from, const Vec3<double>& to, DebugColor color) override {
    if (host_.line) host_.line(host_.context, from.data(), to.data(), packed(color));
  }
  void triangle(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                DebugColor color) override {
    if (host_.triangle) host_.triangle(host_.context, a.data(), b.data(), c.data(), packed(color));
  }
  void text(const Vec3<double>& at, const char* words, DebugColor color) override {
    if (host_.text) host_.text(host_.context, at.data(), words, packed(color));
  }

 private:
  const sinew_draw_settings& host_;
};

}  // namespace
}  // namespace sinew::c

using namespace sinew;
using namespace sinew::c;

sinew_status sinew_draw_settings_init(sinew_draw_settings* settings) {
  return init<DebugDrawSettings>(settings, kSettings);
}

sinew_status sinew_world_draw(sinew_world world, const sinew_draw_settings* settings) {
  return with_world(world, [&](OwnedWorld& w) {
    if (!settings) return fail(SINEW_INVALID_ARGUMENT, kNull);
    DebugDrawSettings shown;
    if (const sinew_status s = read_settings(settings, shown, kSettings); s != SINEW_OK) return s;
    HostRenderer renderer(*settings);
    draw(w.world, shown, renderer);
    return sinew_status(SINEW_OK);
  });
}
