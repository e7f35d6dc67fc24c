#include "render/overlay.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "render/pen.h"

namespace sinew::render {
namespace {

constexpr double kMargin = 24;
constexpr double kSpan = 5;  ///< s of the torque curve

std::string text(const char* format, double a, double b = 0) {
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, format, a, b);
  return buffer;
}

/// Median of the last steps, µs: readable, and one that waited for the processor does not count.
double usual_cost(const scene::Recording& rec, std::size_t index) {
  std::vector<float> last;
  for (std::size_t i = index >= 8 ? index - 8 : 0; i <= index; ++i)
    last.push_back(rec.frames[i].characters[0].microseconds);
  std::nth_element(last.begin(), last.begin() + static_cast<std::ptrdiff_t>(last.size() / 2), last.end());
  return double(last[last.size() / 2]);
}

std::string name_of(const scene::Recording& rec, std::size_t character) {
  const bool named = character < rec.names.size() && !rec.names[character].empty();
  return named ? rec.names[character] : rec.characters[character]->skeleton.name;
}

void draw_state(const Pen& pen, const Rect& at, const scene::Recording& rec, std::size_t index) {
  const scene::Frame& frame = rec.frames[index];
  const scene::CharacterFrame& c = frame.characters[0];
  const Skeleton& skeleton = rec.characters[0]->skeleton;
  const double left = at.x + 18, right = at.x + at.width - 18;
  pen.box(at);
  const std::string heading = rec.frames[index].characters.size() > 1 ? name_of(rec, 0) : rec.title;
  pen.write(left, at.y + 32, 20, pen.fitted(20, heading, 200, true), pen.text, true);
  pen.write_right(right, at.y + 32, 15, text("%.2f s", frame.time), pen.dim);
  const bool playback = c.unknown_dofs == 0;
  const Color state = playback ? pen.calm : pen.warm;
  double x = left + pen.write(left, at.y + 67, 28, text("%.0f", c.unknown_dofs), state, true) + 8;
  pen.write(x, at.y + 67, 15, text("of %.0f DOFs unknown", c.total_dofs), pen.text);
  const std::string word = playback ? "playback" : "solved";
  pen.badge(right - pen.width(13, word, true) - 1.3 * 13, at.y + 66, 13, word, state);
  pen.write(left, at.y + 93, 15, text("%.0f µs a step", usual_cost(rec, index)), pen.dim);
  pen.write_right(right, at.y + 93, 15, text("strength %.0f %%", 100.0 * double(c.strength)), pen.dim);
  const int j = c.most_loaded_joint;
  const float load = j >= 0 ? c.load[static_cast<std::size_t>(j)] : 0;
  if (j >= 0)
    pen.write(left, at.y + 118, 15, pen.fitted(15, skeleton.joints[static_cast<std::size_t>(j)].name, 150),
              pen.dim);
  pen.write_right(right, at.y + 118, 15, text("%.0f %% of its limit", 100.0 * double(load)),
                  load >= 0.995f ? pen.stress(1) : pen.dim);
  pen.ramp({left, at.y + 130, right - left, 4}, double(load));
}

constexpr double kRow = 26;            ///< of the cast
constexpr std::size_t kMostRows = 10;  ///< fits above the caption

/// Where there are several: a row for each with its load and its unknown DOFs. The other panels speak of the
/// first.
void draw_cast(const Pen& pen, const Rect& room, const scene::Recording& rec, std::size_t index) {
  const std::vector<scene::CharacterFrame>& all = rec.frames[index].characters;
  const std::size_t rows = std::min(all.size(), kMostRows);
  const std::size_t each = all.size() > rows ? rows - 1 : rows;  // the last row may be for the rest
  const double left = room.x + 18, right = room.x + room.width - 18;
  pen.box({room.x, room.y, room.width, kRow * static_cast<double>(rows) + 16});
  const auto row = [&](std::size_t i, const std::string& name, int unknown, int dofs) {
    const double y = room.y + 8 + kRow * static_cast<double>(i) + 18;
    pen.write(left, y, 14, pen.fitted(14, name, 120), pen.dim);
    pen.write_right(right, y, 14, text("%.0f of %.0f", unknown, dofs), unknown > 0 ? pen.warm : pen.calm);
    return y;
  };
  for (std::size_t i = 0; i < each; ++i) {
    const double y = row(i, name_of(rec, i), all[i].unknown_dofs, all[i].total_dofs);
    const int j = all[i].most_loaded_joint;
    pen.ramp({left + 130, y - 7, 70, 4}, j >= 0 ? double(all[i].load[static_cast<std::size_t>(j)]) : 0);
  }
  if (each == rows) return;
  int unknown = 0, dofs = 0;
  for (std::size_t i = each; i < all.size(); ++i) unknown += all[i].unknown_dofs, dofs += all[i].total_dofs;
  row(each, text("and %.0f more", static_cast<double>(all.size() - each)), unknown, dofs);
}

void draw_legend(const Pen& pen, const Rect& at) {
  pen.box(at);
  pen.write(at.x + 14, at.y + 20, 12, "load / muscle limit", pen.dim);
  pen.write_right(at.x + at.width - 14, at.y + 20, 12, "100 %", pen.dim);
  pen.ramp({at.x + 14, at.y + 28, at.width - 28, 6}, 1);
}

/// Joint of the torque curve: the scene's, or the most loaded over the recording.
std::size_t plotted_joint(const scene::Recording& rec) {
  if (rec.plotted_joint >= 0) return static_cast<std::size_t>(rec.plotted_joint);
  std::vector<float> total(rec.characters[0]->skeleton.joints.size(), 0);
  for (const scene::Frame& f : rec.frames)
    for (std::size_t i = 0; i < total.size(); ++i) total[i] += f.characters[0].load[i];
  return static_cast<std::size_t>(std::max_element(total.begin(), total.end()) - total.begin());
}

/// A step of the vertical scale that gives two to four marks: 1, 2 or 5 times a power of ten.
double nice_step(double top) {
  const double decade = std::pow(10, std::floor(std::log10(top / 2)));
  for (const double m : {5.0, 2.0})
    if (m * decade * 2 <= top) return m * decade;
  return decade;
}

void draw_chart(const Pen& pen, const Rect& at, const scene::Recording& rec, std::size_t index) {
  const std::size_t joint = plotted_joint(rec);
  const scene::CharacterFrame& now = rec.frames[index].characters[0];
  pen.box(at);
  const std::string name = rec.characters[0]->skeleton.joints[joint].name;
  pen.write(at.x + 18, at.y + 28, 15, pen.fitted(15, "Torque of " + name, 250, true), pen.text, true);
  pen.write_right(at.x + at.width - 18, at.y + 28, 15, text("%.0f N·m", double(now.torque[joint])),
                  now.load[joint] >= 0.995f ? pen.stress(1) : pen.calm, true);

  const double begin = std::max(0.0, rec.frames[index].time - kSpan);
  double low = 0, high = 1;
  for (const scene::Frame& f : rec.frames) {
    const scene::CharacterFrame& c = f.characters[0];
    high = std::max(high, 1.12 * double(c.torque[joint]));
    low = std::min(low, 1.12 * double(c.torque[joint]));
    if (std::isfinite(c.limit[joint])) high = std::max(high, 1.12 * double(c.limit[joint]));
  }
  if (low < 0) low = -std::max(high, -low), high = -low;  // both directions: symmetric
  const double left = at.x + 54, right = at.x + at.width - 18, top = at.y + 44,
               bottom = at.y + at.height - 26;
  const auto px = [&](double t) { return left + (right - left) * (t - begin) / kSpan; };
  const auto py = [&](double v) { return bottom + (top - bottom) * (v - low) / (high - low); };
  const double step = nice_step(high);
  for (double v = low < 0 ? -std::floor(-low / step) * step : 0; v <= high + 1e-9; v += step) {
    pen.line(left, py(v), right, py(v), 1, pen.faint);
    pen.write_right(left - 8, py(v) + 4, 11, text("%.0f", v + 0.0), pen.dim);
  }
  for (double t = std::ceil(begin); t <= begin + kSpan + 1e-9; t += 1) {
    const std::string label = text("%.0f s", t);
    const double x = px(t), half = pen.width(11, label) / 2;
    if (x - half >= left - 10 && x + half <= right + 6) pen.write(x - half, bottom + 17, 11, label, pen.dim);
  }

  cairo_t* cr = pen.cairo();
  const double u = pen.unit();
  cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
  const std::size_t first = static_cast<std::size_t>(std::max(1.0, std::ceil(begin * rec.frame_rate)));
  // A tick for every frame, not a line: the limit jumps where another axis of the joint is closest to its
  // own.
  const double half_frame = 0.5 / rec.frame_rate;
  for (const double side : {1.0, -1.0}) {
    if (side < 0 && low >= 0) continue;
    for (std::size_t i = first; i <= index; ++i) {
      const double limit = double(rec.frames[i].characters[0].limit[joint]), t = rec.frames[i].time;
      if (std::isfinite(limit))
        pen.line(px(t - half_frame), py(side * limit), px(t + half_frame), py(side * limit), 1.4,
                 pen.warm.faded(0.8));
    }
  }
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
  for (std::size_t i = first + 1; i <= index; ++i) {
    const scene::CharacterFrame &a = rec.frames[i - 1].characters[0], &b = rec.frames[i].characters[0];
    pen.line(px(rec.frames[i - 1].time), py(double(a.torque[joint])), px(rec.frames[i].time),
             py(double(b.torque[joint])), 2.2, b.load[joint] >= 0.995f ? pen.stress(1) : pen.calm);
  }
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_BUTT);
  if (index > 0) {
    cairo_new_path(cr);
    cairo_arc(cr, px(rec.frames[index].time) * u, py(double(now.torque[joint])) * u, 4 * u, 0, 2 * M_PI);
    pen.set(now.load[joint] >= 0.995f ? pen.stress(1) : pen.calm);
    cairo_fill(cr);
  }
}

/// Share of all characters' DOFs that are unknown.
double unknown_share(const scene::Frame& frame) {
  int unknown = 0, dofs = 0;
  for (const scene::CharacterFrame& c : frame.characters) unknown += c.unknown_dofs, dofs += c.total_dofs;
  return dofs > 0 ? static_cast<double>(unknown) / dofs : 0;
}

/// Share of unknown DOFs over the whole recording: the past in colour, what comes fainter.
void draw_timeline(const Pen& pen, const Rect& at, const scene::Recording& rec, std::size_t index) {
  pen.box(at);
  const std::string label = "unknown DOFs";
  pen.write(at.x + 14, at.y + at.height / 2 + 4.5, 12, label, pen.dim);
  const double left = at.x + 14 + pen.width(12, label) + 14, right = at.x + at.width - 16;
  const double base = at.y + at.height - 6, room = at.height - 11;
  const std::size_t count = rec.frames.size();
  const double step = (right - left) / double(count), u = pen.unit();
  const auto solved = [&](std::size_t i) { return unknown_share(rec.frames[i]) > 0; };
  for (std::size_t i = 0; i < count;) {  // one area for each run of one colour
    const std::size_t begin = i;
    cairo_move_to(pen.cairo(), (left + step * double(begin)) * u, base * u);
    for (; i < count && solved(i) == solved(begin) && (i <= index) == (begin <= index); ++i) {
      const double y = (base - 2 - (room - 2) * unknown_share(rec.frames[i])) * u;
      cairo_line_to(pen.cairo(), (left + step * double(i)) * u, y);
      cairo_line_to(pen.cairo(), (left + step * double(i + 1)) * u, y);
    }
    cairo_line_to(pen.cairo(), (left + step * double(i)) * u, base * u);
    pen.set((solved(begin) ? pen.warm : pen.calm).faded(begin <= index ? 1 : 0.28));
    cairo_fill(pen.cairo());
  }
  const double x = left + step * (double(index) + 0.5);
  pen.line(x, at.y + 4, x, at.y + at.height - 4, 1.6, pen.text);
}

/// One or two lines in the lower left, broken between words.
void draw_caption(const Pen& pen, const Rect& room, const std::string& caption) {
  constexpr double kSize = 19, kPad = 20, kLine = 25;
  const double most = room.width - 2 * kPad;
  std::vector<std::string> lines{caption};
  if (pen.width(kSize, caption) > most) {
    std::size_t cut = caption.rfind(' ');
    while (cut != std::string::npos && cut > 0 && pen.width(kSize, caption.substr(0, cut)) > most)
      cut = caption.rfind(' ', cut - 1);
    if (cut != std::string::npos && cut > 0) lines = {caption.substr(0, cut), caption.substr(cut + 1)};
  }
  double width = 0;
  for (std::string& line : lines) {
    line = pen.fitted(kSize, line, most);
    width = std::max(width, pen.width(kSize, line));
  }
  const double height = 20 + kLine * double(lines.size());
  const double y = room.y + room.height - height;
  pen.box({room.x, y, width + 2 * kPad, height});
  for (std::size_t i = 0; i < lines.size(); ++i)
    pen.write(room.x + kPad, y + 29 + kLine * double(i), kSize, lines[i], pen.text);
}

}  // namespace

Layout::Layout(int pixels_wide, int pixels_high)
    : unit(std::min(pixels_high / 720.0, pixels_wide / 860.0)),
      width(pixels_wide / unit),
      height(pixels_high / unit) {
  constexpr double kGap = 10;
  state = {kMargin, kMargin, 330, 146};
  cast = {kMargin, state.y + state.height + kGap, state.width, kRow * kMostRows + 16};
  legend = {width - kMargin - 210, kMargin, 210, 44};
  timeline = {kMargin, height - 16 - 34, width - 2 * kMargin, 34};
  const double lowest = timeline.y - kGap;
  chart = {width - kMargin - 364, lowest - 186, 364, 186};
  caption = {kMargin, lowest - 70, chart.x - kMargin - 2 * kGap, 70};
}

void draw_overlay(const scene::Recording& rec, std::size_t index, bool dark, Image& image) {
  if (rec.frames.empty() || rec.frames[index].characters.empty()) return;
  const Layout layout(image.width, image.height);
  const Pen pen(image, layout.unit, dark);
  draw_state(pen, layout.state, rec, index);
  if (rec.frames[index].characters.size() > 1) draw_cast(pen, layout.cast, rec, index);
  draw_legend(pen, layout.legend);
  draw_chart(pen, layout.chart, rec, index);
  draw_timeline(pen, layout.timeline, rec, index);
  if (const std::string& caption = rec.frames[index].caption; !caption.empty())
    draw_caption(pen, layout.caption, caption);
}

void draw_title(const Asset& asset, bool dark, Image& image) {
  const Skeleton& s = asset.skeleton;
  int dofs = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(s.body_count); ++i)
    dofs += dof_count(s.joints[i].type);
  const Layout layout(image.width, image.height);
  const Pen pen(image, layout.unit, dark);
  const std::string facts =
      text("%.0f joints · %.0f DOFs · ", double(s.joints.size()), dofs) + text("%.1f kg", s.total_mass());
  const std::string name = pen.fitted(20, s.name, 420, true);
  const double width = std::max(pen.width(20, name, true), pen.width(14, facts)) + 36;
  pen.box({kMargin, kMargin, width, 66});
  pen.write(kMargin + 18, kMargin + 30, 20, name, pen.text, true);
  pen.write(kMargin + 18, kMargin + 52, 14, facts, pen.dim);
}

}  // namespace sinew::render
