// What the command line is, told once: help, completion and man pages are made from the options that CLI11
// parses.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sinew::cli {

struct ExitCode {
  int code;
  const char* meaning;
};

/// What the codes of a command ("convert", "study accuracy") mean.
std::vector<ExitCode> exit_codes(const std::string& command);

/// Gives every command below `app` what all have: --quiet, and its exit codes at the end of its help. `path`:
/// the command that `app` is; "" for the program.
void complete_definitions(CLI::App& app, const std::string& path = "");

/// A command as data:
///
///     {"name", "description", "example", "footer", "exit_codes": [[code, meaning]], "commands": [the same
///     …],
///      "options": [{"names": ["-o", "--output"], "value": "FILE", "choices": [], "default", "help",
///      "required": false,
///                   "repeats": false}]}
///
/// Positionals are options whose only name has no dash. `value` is empty for flags.
nlohmann::json describe(const CLI::App& app, const std::string& path = "");

/// Of a program beside `sinew`: completes its definitions and parses, or prints its description where
/// --describe asks for it. An exit code where that was all, or where the arguments are wrong.
std::optional<int> parse_or_describe(CLI::App& app, int argc, char** argv);

/// Adds to a description what another program understands for the same commands.
void merge(nlohmann::json& description, const nlohmann::json& other);

}  // namespace sinew::cli
