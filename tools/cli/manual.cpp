#include "cli/manual.h"

#include <cstdio>
#include <filesystem>

#include "cli/completion.h"
#include "cli/definitions.h"
#include "cli/files.h"
#include "cli/man_page.h"
#include "cli/other_programs.h"

namespace sinew::cli {

using convert::Error;

void ManualCommand::add(CLI::App& app) {
  completion_ = app.add_subcommand("completion",
                                   "completion of this command line in a shell\n"
                                   "Examples: source <(sinew completion bash)\n"
                                   "          sinew completion fish > ~/.config/fish/completions/sinew.fish");
  completion_->add_option("shell", shell, "whose script is printed")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  man_ = app.add_subcommand("man",
                            "manual pages, made from what --help says\n"
                            "Examples: sinew man render | man -l -\n"
                            "          sinew man -o out/man1");
  man_->add_option("page", page, "page that is printed: of a command")
      ->type_name("COMMAND")
      ->default_str("sinew");
  man_->add_option("-o,--output", directory, "all pages into a directory instead")->type_name("DIR");
}

bool ManualCommand::parsed() const {
  return completion_->parsed() || man_->parsed();
}

nlohmann::json ManualCommand::described(const CLI::App& app) {
  nlohmann::json all = describe(app);
  for (const nlohmann::json& other : describe_other_programs()) merge(all, other);
  return all;
}

Error ManualCommand::run(const CLI::App& app) const {
  const nlohmann::json all = described(app);
  if (completion_->parsed()) {
    std::fputs(completion(shell, all).c_str(), stdout);
    return {};
  }
  const auto pages = man_pages(all);
  if (directory.empty()) {
    const auto found = pages.find(page.empty() ? "sinew.1" : "sinew-" + page + ".1");
    if (found == pages.end()) return {"there is no command '" + page + "'"};
    std::fputs(found->second.c_str(), stdout);
    return {};
  }
  std::error_code code;
  std::filesystem::create_directories(directory, code);
  for (const auto& [name, text] : pages)
    if (Error error = write_atomically(directory + "/" + name, text)) return error;
  return {};
}

}  // namespace sinew::cli
