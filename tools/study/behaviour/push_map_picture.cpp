// Push maps as pictures: from above, ahead is up.
#include <cmath>
#include <cstdio>

#include "study/behaviour/push_map.h"
#include "study/canvas.h"

namespace sinew::study {
namespace {

constexpr Colour kSteps{0.00, 0.45, 0.70}, kFalls{0.80, 0.40, 0.00},
    kGrid{0.85, 0.85, 0.85};  // Okabe and Ito
constexpr double kRadius = 150, kPanel = 400, kTop = 70, kTable = 190, kHardest = 120;

std::string newtons(double value) {
  if (std::isnan(value)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.0f", value);
  return text;
}

Spot place(double x, double y, double angle, double impulse) {
  const double r = kRadius * std::min(impulse, kHardest) / kHardest;
  return {x - r * std::sin(angle), y - r * std::cos(angle)};
}

void draw_rings(Canvas& canvas, double x, double y) {
  constexpr double kTurn = 6.283185307179586;
  for (const double impulse : {30.0, 60.0, 90.0, 120.0}) {
    std::vector<Spot> ring;
    for (int n = 0; n <= 72; ++n) ring.push_back(place(x, y, kTurn * n / 72, impulse));
    canvas.line(kGrid, 0.8, ring);
    canvas.text(newtons(impulse), x + 3, y - kRadius * impulse / kHardest - 2, 10);
  }
}

void draw_people(Canvas& canvas, double x, double y, double mass) {
  constexpr double kTurn = 6.283185307179586;
  std::vector<Spot> steps, falls;
  for (int n = 0; n <= 72; ++n) {
    const double angle = kTurn * n / 72;
    const PushLimits human = human_limits(angle, mass);
    steps.push_back(place(x, y, angle, human.stay_step));
    falls.push_back(place(x, y, angle, human.step_fall));
  }
  canvas.line(kSteps, 1.2, steps, true);
  canvas.line(kFalls, 1.2, falls, true);
}

void draw_measured(Canvas& canvas, const PushMap& map, double x, double y, const Colour& colour,
                   double PushDirection::*point) {
  std::vector<Spot> through;
  const auto add = [&](const PushDirection& d) {
    through.push_back(place(x, y, d.angle, std::isnan(d.*point) ? map.sweep.impulses.back() : d.*point));
  };
  for (const PushDirection& d : map.directions) add(d);
  if (map.directions.size() > 2) add(map.directions.front());
  canvas.line(colour, 2, through);
  for (std::size_t n = 0; n < map.directions.size(); ++n) {
    const PushDirection& d = map.directions[n];
    const std::string tip = d.name + ": " + newtons(d.*point) + " N·s";
    if (std::isnan(d.*point))
      canvas.ring(colour, through[n], 4);
    else
      canvas.dot(colour, through[n], 4, tip);
  }
}

void draw_table(Canvas& canvas, const PushMap& map, double left, double top) {
  canvas.text("steps from", left + 190, top, 11, 1, true);
  canvas.text("people", left + 240, top, 11, 1);
  canvas.text("falls from", left + 310, top, 11, 1, true);
  canvas.text("people", left + 360, top, 11, 1);
  for (const PushDirection& d : map.directions) {
    top += 17;
    canvas.text(d.name, left + 20, top, 11);
    canvas.text(newtons(d.stay_step_50), left + 190, top, 11, 1, true);
    canvas.text(newtons(d.human.stay_step), left + 240, top, 11, 1);
    canvas.text(newtons(d.step_fall_50), left + 310, top, 11, 1, true);
    canvas.text(newtons(d.human.step_fall), left + 360, top, 11, 1);
  }
}

}  // namespace

convert::Error draw_push_maps(const std::vector<PushMap>& maps, const std::string& file) {
  const double width = std::max(kPanel * double(maps.size()), 620.0) + 20;
  Canvas canvas(file, width, kTop + 2 * kRadius + 60 + kTable);
  canvas.text("Pushes of which half make a standing body step, or fall (N·s, 0.1 s)", 20, 28, 16, 0, true);
  canvas.text(
      "lines: measured; dashed: people (pendulum with human reactions); ring: more than the hardest push; "
      "up: ahead",
      20, 48, 11);
  for (std::size_t n = 0; n < maps.size(); ++n) {
    const double left = 20 + kPanel * double(n), x = left + kPanel / 2, y = kTop + kRadius + 40;
    canvas.text(maps[n].name, x, kTop + 12, 13, 0.5, true);
    draw_rings(canvas, x, y);
    draw_people(canvas, x, y, maps[n].mass);
    draw_measured(canvas, maps[n], x, y, kSteps, &PushDirection::stay_step_50);
    draw_measured(canvas, maps[n], x, y, kFalls, &PushDirection::step_fall_50);
    draw_table(canvas, maps[n], left, y + kRadius + 30);
  }
  return canvas.finish();
}

}  // namespace sinew::study
