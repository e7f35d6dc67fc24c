// What a world has inside, as lines, triangles and words: for a game's debug view, or a file.
//
//     struct Lines final : DebugRenderer {
//       void line(const Vec3<double>& a, const Vec3<double>& b, DebugColor color) override { … }
//       …
//     };
//     Lines lines;
//     draw(world, {}, lines);                              // after a step
//
// The host implements DebugRenderer; there is no graphics library in here. Drawing reads the world and
// changes no bit of it. A program that never calls draw() does not link it, and no step does anything for it.
#pragma once

#include <cstdint>

#include "sinew/skeleton/vector.h"

namespace sinew {

template <class T>
class World;

struct DebugColor {
  std::uint8_t r = 255, g = 255, b = 255, a = 255;

  bool operator==(const DebugColor&) const = default;
};

/// Where what is drawn goes. Places in m, world. Strings are valid during the call only.
class DebugRenderer {
 public:
  virtual ~DebugRenderer() = default;
  virtual void line(const Vec3<double>& from, const Vec3<double>& to, DebugColor color) = 0;
  /// Seen from both sides.
  virtual void triangle(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                        DebugColor color) = 0;
  virtual void text(const Vec3<double>& at, const char* words, DebugColor color) = 0;
};

namespace debug_colors {
constexpr DebugColor kBone{200, 200, 200, 255};
constexpr DebugColor kStatic{110, 110, 110, 255};
constexpr DebugColor kAsleep{90, 100, 140, 255};  ///< colliders, by what the last step did with their owner
constexpr DebugColor kPlayed{80, 160, 255, 255};
constexpr DebugColor kSolved{255, 160, 60, 255};
constexpr DebugColor kForce{255, 60, 60, 255};
constexpr DebugColor kFriction{255, 120, 220, 255};
constexpr DebugColor kTouch{255, 230, 80, 255};
constexpr DebugColor kUnknown{255, 255, 60, 255};
constexpr DebugColor kCenter{255, 255, 255, 255};
constexpr DebugColor kSupport{80, 220, 120, 90};
constexpr DebugColor kTarget{120, 255, 200, 255};
constexpr DebugColor kIsland{190, 140, 255, 255};
}  // namespace debug_colors

/// What draw() shows.
struct DebugDrawSettings {
  bool skeleton = true;   ///< a line from each joint to its parent
  bool colliders = true;  ///< of characters, props, particles and obstacles, as wires; the host's shapes know
                          ///< no outline
  bool contacts = true;   ///< points, forces along the normal and friction; while report_contacts() is on
  bool muscles = true;    ///< a mark at each joint: green unloaded, red at its limit
  bool unknowns = true;   ///< the axes of the degrees of freedom that the last step solved for
  bool islands = true;    ///< who was solved together, and words on what the step did
  bool support = true;    ///< centre of mass, its foot on the ground, what a character stands on
  bool targets = true;    ///< what the animation wants, where the pose is not there
  double force_scale = 1e-3;  ///< m by N
};

/// Draws a world as the last step left it. Allocates. Not during a step.
template <class T>
void draw(const World<T>& world, const DebugDrawSettings& settings, DebugRenderer& renderer);

extern template void draw<float>(const World<float>&, const DebugDrawSettings&, DebugRenderer&);
extern template void draw<double>(const World<double>&, const DebugDrawSettings&, DebugRenderer&);

}  // namespace sinew
