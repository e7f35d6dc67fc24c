#include "cli/terminal.h"

#include <unistd.h>

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace sinew::cli {
namespace {

bool quiet = false;

bool has_colours(int stream) {
  const char *no = std::getenv("NO_COLOR"), *terminal = std::getenv("TERM");
  return isatty(stream) != 0 && (no == nullptr || *no == '\0') &&
         (terminal == nullptr || std::strcmp(terminal, "dumb") != 0);
}

}  // namespace

void set_quiet() {
  quiet = true;
}

bool is_quiet() {
  return quiet;
}

void say(const char* format, ...) {
  if (quiet) return;
  va_list arguments;
  va_start(arguments, format);
  std::vprintf(format, arguments);
  va_end(arguments);
}

std::string styled(const std::string& text, Style style, int stream) {
  if (!has_colours(stream)) return text;
  const char* code = style == Style::kBold ? "1" : style == Style::kRed ? "31" : "32";
  return std::string("\033[") + code + "m" + text + "\033[0m";
}

void say_error(const std::string& message) {
  std::fflush(stdout);
  std::fprintf(stderr, "%s %s\n", styled("sinew:", Style::kRed, STDERR_FILENO).c_str(), message.c_str());
}

}  // namespace sinew::cli
