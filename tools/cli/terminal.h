// What the command says to people: reports on standard output, errors on standard error, colours where they
// are wanted.
#pragma once

#include <string>

namespace sinew::cli {

/// From now on say() and progress lines are silent (--quiet). Errors, JSON that was asked for, and what a
/// command is there to print are not reports and stay.
void set_quiet();
bool is_quiet();

/// A report on standard output, as printf.
void say(const char* format, ...) __attribute__((format(printf, 1, 2)));

enum class Style { kBold, kRed, kGreen };

/// The text in a style, if the stream (STDOUT_FILENO or STDERR_FILENO) is a terminal that knows colours and
/// NO_COLOR is not set to anything (no-color.org); else as it is.
std::string styled(const std::string& text, Style style, int stream);

/// "sinew: MESSAGE" as one line on standard error.
void say_error(const std::string& message);

}  // namespace sinew::cli
