#include "convert/report_text.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <vector>

namespace sinew::convert {
namespace {

using nlohmann::json;

constexpr std::size_t kMostLines = 10, kMostClips = 3;  ///< folded
constexpr double kTorqueChanged = 0.05;                 ///< of the limit: worth naming

[[gnu::format(printf, 1, 2)]] std::string line_of(const char* format, ...) {
  char line[512];
  va_list values;
  va_start(values, format);
  std::vsnprintf(line, sizeof line, format, values);
  va_end(values);
  return line;
}

const json& list_of(const json& report, const char* key) {
  static const json kNone = json::array();
  return report.contains(key) && report[key].is_array() ? report[key] : kNone;
}

std::string listed(const char* title, const json& items) {
  std::string text = title;
  for (const json& item : items) text.append(" ").append(item.get<std::string>());
  return text;
}

std::string clip_line(const json& c) {
  const bool along_chain = c.contains("bytes_per_joint_second") || c.contains("sole_lowest_mm");
  std::string text = line_of("clip %-24s %6.2f s%s, %s max %.3f mm, rms %.3f mm", c.value("name", "").c_str(),
                             c.value("duration_s", 0.0), c.value("loops", false) ? " loop" : "     ",
                             along_chain ? "error along the chain" : "error at each joint",
                             c.value("max_error_mm", 0.0), c.value("rms_error_mm", 0.0));
  if (c.contains("bytes_per_joint_second"))
    text += line_of(
        "; per joint and second %.1f bytes, %.1f in memory; torques within %.1f %% of the limits, rms %.2f "
        "%%",
        c.value("bytes_per_joint_second", 0.0), c.value("memory_per_joint_second", 0.0),
        100 * c.value("largest_torque_error", 0.0), 100 * c.value("rms_torque_error", 0.0));
  for (const char* what : {"contacts", "events", "curves", "markers"})
    if (const int count = c.value(what, 0); count > 0)
      text +=
          "; " + std::to_string(count) + " " + (count == 1 ? std::string(what, std::strlen(what) - 1) : what);
  return text;
}

/// Many clips in a line, and those whose torques the fit changed.
void sum_up(const json& clips, std::vector<std::string>& lines) {
  double seconds = 0, most_mm = 0, worst = 0;
  std::size_t loops = 0, with_contacts = 0, changed = 0;
  std::string worst_clip;
  for (const json& c : clips) {
    seconds += c.value("duration_s", 0.0);
    most_mm = std::max(most_mm, c.value("max_error_mm", 0.0));
    loops += c.value("loops", false) ? 1 : 0;
    with_contacts += c.value("contacts", 0) > 0 ? 1 : 0;
    const double torque = c.value("largest_torque_error", 0.0);
    changed += torque > kTorqueChanged ? 1 : 0;
    if (torque > worst) worst_clip = c.value("name", "");
    worst = std::max(worst, torque);
  }
  lines.push_back(line_of(
      "%zu clips, %.1f s, %zu of them loops, %zu with contacts of feet or hands: error at most %.3f mm",
      clips.size(), seconds, loops, with_contacts, most_mm));
  if (changed > 0)
    lines.push_back(
        line_of("the fit changes torques of %zu by more than %.0f %% of the limits: most in %s, %.0f %%",
                changed, 100 * kTorqueChanged, worst_clip.c_str(), 100 * worst));
}

std::vector<std::string> head_of(const json& r) {
  std::vector<std::string> lines = {
      line_of("%s (%s): %d joints, %d simulated, %d degrees of freedom, %.1f kg", r.value("name", "").c_str(),
              r.value("format", "").c_str(), r.value("joints", 0), r.value("simulated_joints", 0),
              r.value("dofs", 0), r.value("total_mass_kg", 0.0))};
  if (r.contains("unit"))
    lines.push_back(line_of("unit %g m (%s), up %s (%s), height %.2f m",
                            r["unit"].value("meters_per_unit", 0.0), r["unit"].value("from", "").c_str(),
                            r["up"].value("axis", "").c_str(), r["up"].value("from", "").c_str(),
                            r.value("height_m", 0.0)));
  return lines;
}

std::vector<std::string> whole_report(const json& r) {
  std::vector<std::string> lines = head_of(r);
  for (const auto& [key, title] : {std::pair("control_joints", "control joints, no body:"),
                                   {"ride_along_joints", "ride along:"},
                                   {"masks", "masks:"},
                                   {"curves", "curves:"},
                                   {"morph_targets", "morph targets:"}})
    if (!list_of(r, key).empty()) lines.push_back(listed(title, list_of(r, key)));
  for (const json& clip : list_of(r, "clips")) lines.push_back(clip_line(clip));
  for (const json& note : list_of(r, "notes")) lines.push_back("note: " + note.get<std::string>());
  return lines;
}

std::vector<std::string> folded_report(const json& r) {
  std::vector<std::string> lines = head_of(r);
  std::string counts;
  for (const auto& [key, what] : {std::pair("control_joints", "control joints without a body"),
                                  {"ride_along_joints", "joints that ride along"},
                                  {"masks", "masks"},
                                  {"curves", "curves"},
                                  {"morph_targets", "morph targets"}})
    if (const std::size_t count = list_of(r, key).size(); count > 0)
      counts += (counts.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  if (!counts.empty()) lines.push_back(counts);
  const json& clips = list_of(r, "clips");
  if (clips.size() > kMostClips)
    sum_up(clips, lines);
  else
    for (const json& clip : clips) lines.push_back(clip_line(clip));
  const json& notes = list_of(r, "notes");
  const bool all = lines.size() + notes.size() <= kMostLines;
  const std::size_t shown = all ? notes.size() : kMostLines - 1 - lines.size();
  for (std::size_t n = 0; n < shown; ++n) lines.push_back("note: " + notes[n].get<std::string>());
  if (!all) lines.push_back(std::to_string(notes.size() - shown) + " more notes (--verbose)");
  return lines;
}

}  // namespace

std::string report_text(const json& report, Detail detail) {
  std::string text;
  for (const std::string& line : detail == Detail::kWhole ? whole_report(report) : folded_report(report))
    text += line + "\n";
  return text;
}

}  // namespace sinew::convert
