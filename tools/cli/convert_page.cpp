#include "cli/convert_page.h"

#include <cstdio>

#include "import/text.h"

namespace sinew::cli {
namespace {

using import::html_text;
using nlohmann::json;

constexpr const char* kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Converted characters</title><style>
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem; color: #1b2430; background: #fff }
h1 { font-size: 1.5rem } h2 { font-size: 1.15rem; margin-top: 2rem }
.all { display: grid; grid-template-columns: repeat(auto-fill, minmax(21rem, 1fr)); gap: 1rem }
.one { border: 1px solid #d5dbe3; border-radius: 6px; padding: .8rem; overflow-wrap: anywhere }
.one img { width: 100%; border-radius: 4px; background: #2b303a; display: block }
.one h3 { font-size: 1rem; margin: .6rem 0 .2rem } p { margin: .2rem 0 } ul { margin: .3rem 0; padding-left: 1.2rem }
small { color: #5a6675 } .bad { color: #a3161f }
@media (prefers-color-scheme: dark) { body { color: #dfe5ec; background: #14181f } .one { border-color: #333c48 }
  small { color: #93a0af } .bad { color: #ff8b8b } }
</style></head><body>
)";

std::string number(const json& report, const char* key, const char* form) {
  char text[48];
  std::snprintf(text, sizeof text, form, report.value(key, 0.0));
  return text;
}

/// "walk 1.07 s loop, run 0.70 s loop", the first dozen.
std::string clips_of(const json& report) {
  constexpr std::size_t kMost = 12;
  if (!report.contains("clips") || report["clips"].empty()) return "no clips";
  std::string text;
  for (std::size_t k = 0; k < report["clips"].size() && k < kMost; ++k) {
    const json& clip = report["clips"][k];
    text += (k ? ", " : "") + html_text(clip.value("name", "")) + number(clip, "duration_s", " %.2f s") +
            (clip.value("loops", false) ? " loop" : "");
  }
  if (report["clips"].size() > kMost)
    text += " and " + std::to_string(report["clips"].size() - kMost) + " more";
  return text;
}

std::string card(const json& row) {
  const json report = row.value("report", json::object());
  const std::string source = html_text(row.value("source", ""));
  std::string out = "<div class=\"one\">";
  if (row.contains("still"))
    out += "<img loading=\"lazy\" alt=\"" + html_text(report.value("name", "")) + "\" src=\"" +
           html_text(row["still"].get<std::string>()) + "\">";
  out += "<h3>" + html_text(report.value("name", "")) + "</h3><p><small>" + source + ", " +
         row.value("state", "") + "</small></p><p>" + number(report, "joints", "%.0f joints, ") +
         number(report, "simulated_joints", "%.0f simulated, ") +
         number(report, "dofs", "%.0f degrees of freedom, ") + number(report, "total_mass_kg", "%.1f kg");
  if (report.contains("height_m")) out += number(report, "height_m", ", %.2f m");
  out += "</p><p>" + clips_of(report) + "</p>";
  if (report.contains("notes") && !report["notes"].empty()) {
    out += "<details><summary>" + std::to_string(report["notes"].size()) +
           (report["notes"].size() == 1 ? " note" : " notes") + "</summary><ul>";
    for (const json& note : report["notes"]) out += "<li>" + html_text(note.get<std::string>()) + "</li>";
    out += "</ul></details>";
  }
  return out + "</div>\n";
}

}  // namespace

std::string convert_page(const json& report) {
  std::string good, bad;
  for (const json& row : report["files"]) {
    if (row.contains("error"))
      bad += "<li class=\"bad\">" + html_text(row["error"].get<std::string>()) + "</li>\n";
    else
      good += card(row);
  }
  const auto count = [&](const char* key) { return std::to_string(report.value(key, 0)); };
  std::string page = kHead;
  page += "<h1>Converted characters</h1><p>" + count("converted") + " converted, " + count("up_to_date") +
          " up to date, " + count("failed") + " refused</p>\n";
  if (!bad.empty()) page += "<h2>Refused</h2><ul>\n" + bad + "</ul>\n";
  return page + "<h2>Characters</h2><div class=\"all\">\n" + good + "</div></body></html>\n";
}

}  // namespace sinew::cli
