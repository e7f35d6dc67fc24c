// What a world has inside in one frame, as the runtime's debug drawing tells it: kept for the renderer.
#pragma once

#include <string>
#include <vector>

#include "sinew/character/debug_draw.h"

namespace sinew::scene {

/// Lines, triangles and words in the order in which they came; places in m, world.
class Drawing final : public DebugRenderer {
 public:
  struct Line {
    Vec3<float> from, to;
    DebugColor color;
  };
  struct Triangle {
    Vec3<float> a, b, c;
    DebugColor color;
  };
  struct Words {
    Vec3<float> at;
    std::string words;
    DebugColor color;
  };

  void line(const Vec3<double>& from, const Vec3<double>& to, DebugColor color) override {
    lines.push_back({from.cast<float>(), to.cast<float>(), color});
  }
  void triangle(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c,
                DebugColor color) override {
    triangles.push_back({a.cast<float>(), b.cast<float>(), c.cast<float>(), color});
  }
  void text(const Vec3<double>& at, const char* words_, DebugColor color) override {
    words.push_back({at.cast<float>(), words_, color});
  }

  std::vector<Line> lines;
  std::vector<Triangle> triangles;
  std::vector<Words> words;
};

}  // namespace sinew::scene
