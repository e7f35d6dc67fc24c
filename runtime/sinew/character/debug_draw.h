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

/// 0 … 255 a channel, not premultiplied.
struct DebugColor {
  std::uint8_t r = 255;  ///< red
  std::uint8_t g = 255;  ///< green
  std::uint8_t b = 255;  ///< blue
  std::uint8_t a = 255;  ///< 255: opaque; less where what is behind shall be seen

  /// Every member is the same.
  bool operator==(const DebugColor&) const = default;
};

/// Where what is drawn goes. Places in m, world. Strings are valid during the call only.
class DebugRenderer {
 public:
  virtual ~DebugRenderer() = default;
  /// As wide as the host likes.
  virtual void line(const Vec3<double>& from, const Vec3<double>& to, DebugColor color) = 0;
  /// Seen from both sides.
  virtual void triangle(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                        DebugColor color) = 0;
  /// One line of words, ASCII, null-terminated.
  virtual void text(const Vec3<double>& at, const char* words, DebugColor color) = 0;
};

/// What draw() uses for what; muscles go from green over yellow to red by their load.
namespace debug_colors {
constexpr DebugColor kBone{200, 200, 200, 255};    ///< from a joint to its parent
constexpr DebugColor kStatic{110, 110, 110, 255};  ///< obstacles
constexpr DebugColor kAsleep{90, 100, 140, 255};   ///< colliders whose owner sleeps
constexpr DebugColor kPlayed{80, 160, 255, 255};   ///< colliders whose owner was played
constexpr DebugColor kSolved{255, 160, 60, 255};  ///< colliders of who was solved for, awake props, particles
constexpr DebugColor kForce{255, 60, 60, 255};    ///< along a contact's normal
constexpr DebugColor kFriction{255, 120, 220, 255};  ///< force across it
constexpr DebugColor kTouch{255, 230, 80, 255};      ///< the point of a contact
constexpr DebugColor kUnknown{255, 255, 60, 255};    ///< axis of a degree of freedom that was solved for
constexpr DebugColor kCenter{255, 255, 255, 255};    ///< centre of mass and its plumb line to the ground
constexpr DebugColor kSupport{80, 220, 120, 90};     ///< hull of the points that a character stands on
constexpr DebugColor kTarget{120, 255, 200, 255};  ///< what the animation wants, and how far off the pose is
constexpr DebugColor kIsland{190, 140, 255, 255};  ///< from one to another that were solved together; words
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

/// @cond
extern template void draw<float>(const World<float>&, const DebugDrawSettings&, DebugRenderer&);
extern template void draw<double>(const World<double>&, const DebugDrawSettings&, DebugRenderer&);
/// @endcond

}  // namespace sinew
