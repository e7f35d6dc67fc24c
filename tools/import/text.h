// Names and messages out of files: what a terminal, a JSON report, a page and a lookup by name can live with.
#pragma once

#include <string>
#include <string_view>

namespace sinew::import {

/// As RFC 3629 has it: no overlong forms, no surrogates.
bool is_utf8(std::string_view text);

/// The text as UTF-8: read as Latin-1 (what old exporters wrote) when it is not. Control characters become
/// spaces.
std::string clean_text(std::string_view text);

/// The text as HTML shows it, also within an attribute.
std::string html_text(std::string_view text);

}  // namespace sinew::import
