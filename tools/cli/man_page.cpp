#include "cli/man_page.h"

#include <algorithm>
#include <cctype>

#include "sinew/skeleton/version.h"

namespace sinew::cli {
namespace {

using nlohmann::json;

/// Words in lines that are short in a file, too.
std::string folded(const std::string& words) {
  constexpr std::size_t kWidth = 60;
  std::string out, line;
  for (std::size_t begin = 0; begin < words.size();) {
    const std::size_t end = std::min(words.find_first_of(" \n", begin), words.size());
    if (!line.empty() && line.size() + 1 + end - begin > kWidth) {
      out += line + "\n";
      line.clear();
    }
    if (end > begin) line += (line.empty() ? "" : " ") + words.substr(begin, end - begin);
    begin = end + 1;
  }
  return out + line;
}

/// What CLI11 says of a range of numbers, in words.
std::string range_text(const std::string& range) {
  if (range == "POSITIVE") return "; above 0";
  if (range == "NONNEGATIVE") return "; not below 0";
  const std::size_t open = range.find('[');
  return open == std::string::npos ? "" : "; within " + range.substr(open);
}

/// As roff reads it: dashes that may be copied, no requests by accident.
std::string text(const std::string& plain) {
  std::string out;
  bool starts = true;
  for (const char c : plain) {
    if (starts && (c == '.' || c == '\'')) out += "\\&";
    starts = c == '\n';
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'')
      out += "\\(aq";
    else
      out += c;
  }
  return out;
}

std::string upper(std::string name) {
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

bool is_positional(const json& option) {
  return option["names"][0].get<std::string>()[0] != '-';
}

std::string synopsis(const std::string& command, const json& what) {
  std::string out = ".B " + text(command) + "\n";
  std::string operands;
  for (const json& option : what["options"]) {
    const std::string name = option["names"].back(), value = option["value"];
    if (is_positional(option))
      operands += ".RI " + std::string(option["required"] == true ? "\"\" " : "[ ") + text(upper(name)) +
                  (option["repeats"] == true ? " ..." : "") + (option["required"] == true ? "\n" : " ]\n");
    else if (option["required"] == true)
      out += ".BI " + text(name) + " \" " + text(value) + "\"\n";
  }
  if (!what["commands"].empty()) return out + ".I COMMAND\n.RI [ OPTION ...]\n";
  return out + operands + ".RI [ OPTION ...]\n";
}

std::string option_entry(const json& option) {
  const std::string value = is_positional(option) ? "" : option["value"].get<std::string>();
  std::string out = ".TP\n";
  std::string names;
  for (const json& name : option["names"])
    names += (names.empty() ? "" : ", ") +
             ("\\fB" + text(is_positional(option) ? upper(name) : name.get<std::string>()) + "\\fR");
  out += names + (value.empty() ? "" : " \\fI" + text(value) + "\\fR") +
         (option["repeats"] == true ? " ..." : "") + "\n";
  std::string help = option["help"];
  if (!option["choices"].empty()) {
    std::string choices;
    for (const json& choice : option["choices"])
      choices += (choices.empty() ? "" : ", ") + choice.get<std::string>();
    help += "; one of: " + choices;
  }
  help += range_text(option.value("range", ""));
  if (option["required"] == true) help += " (required)";
  if (const std::string preset = option["default"]; !preset.empty()) help += " (default: " + preset + ")";
  return out + text(folded(help)) + "\n";
}

std::string options_of(const json& command) {
  std::string out;
  for (const json& option : command["options"])
    if (is_positional(option)) out += option_entry(option);
  for (const json& option : command["options"])
    if (!is_positional(option)) out += option_entry(option);
  return out;
}

std::string exit_status(const json& command) {
  std::string out = ".SH EXIT STATUS\n";
  for (const json& code : command["exit_codes"])
    out += ".TP\n.B " + std::to_string(code[0].get<int>()) + "\n" + text(code[1].get<std::string>()) + "\n";
  return out;
}

std::string examples(const json& command) {
  std::string lines = command["example"];
  if (lines.empty()) return "";
  std::string out = ".SH EXAMPLES\n.nf\n";
  for (std::size_t begin = 0; begin < lines.size();) {
    const std::size_t end = std::min(lines.find('\n', begin), lines.size());
    const std::size_t word = lines.find_first_not_of(' ', begin);
    out += text(lines.substr(word, end - word)) + "\n";
    begin = end + 1;
  }
  return out + ".fi\n";
}

std::string head(const std::string& name, const json& what) {
  return ".\\\" Made by `sinew man` from the definitions of the command line.\n.TH " + text(upper(name)) +
         " 1 \"\" \"Sinew " + version() + "\" \"Sinew\"\n.SH NAME\n" + text(name) + " \\- " +
         text(folded(what["description"])) + "\n";
}

std::string command_page(const json& command) {
  const std::string name = "sinew-" + command["name"].get<std::string>();
  const std::string typed = "sinew " + command["name"].get<std::string>();
  std::string out = head(name, command) + ".SH SYNOPSIS\n" + synopsis(typed, command) + ".SH OPTIONS\n" +
                    options_of(command);
  for (const json& below : command["commands"]) {
    const std::string full = typed + " " + below["name"].get<std::string>();
    out += ".SH " + text(upper(below["name"])) + "\n" + synopsis(full, below) + ".PP\n" +
           text(folded(below["description"])) + "\n";
    if (const std::string example = below["example"]; !example.empty())
      out += ".PP\n.nf\n" + text(example) + "\n.fi\n";
    out += options_of(below);
    if (below["exit_codes"] != command["exit_codes"])
      for (const json& code : below["exit_codes"])
        if (std::find(command["exit_codes"].begin(), command["exit_codes"].end(), code) ==
            command["exit_codes"].end())
          out += ".PP\nExit status " + std::to_string(code[0].get<int>()) + ": " +
                 text(code[1].get<std::string>()) + ".\n";
  }
  return out + exit_status(command) + examples(command) + ".SH SEE ALSO\n.BR sinew (1)\n";
}

std::string program_page(const json& program) {
  std::string out = head("sinew", program) + ".SH SYNOPSIS\n" + synopsis("sinew", program) + ".SH COMMANDS\n";
  std::string pages;
  for (const json& command : program["commands"]) {
    const std::string name = command["name"], page = "sinew\\-" + text(name);
    out += ".TP\n.BR " + page + " (1)\n" + text(folded(command["description"])) + "\n";
    pages += (pages.empty() ? ".BR " : ",\n.BR ") + page + " (1)";
  }
  out += ".SH OPTIONS\n" + options_of(program) + exit_status(program);
  out +=
      ".SH ENVIRONMENT\n.TP\n.B NO_COLOR\nIf set to anything, nothing is coloured.\nElsewhere than on a "
      "terminal nothing "
      "is either.\n";
  return out + examples(program) + ".SH SEE ALSO\n" + pages + "\n";
}

}  // namespace

std::map<std::string, std::string> man_pages(const json& description) {
  std::map<std::string, std::string> pages = {{"sinew.1", program_page(description)}};
  for (const json& command : description["commands"])
    pages["sinew-" + command["name"].get<std::string>() + ".1"] = command_page(command);
  return pages;
}

}  // namespace sinew::cli
