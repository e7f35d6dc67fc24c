// Files of tools/study/web, built into the program.
#pragma once

namespace sinew::study::web {

/// report.html with @MACHINE@, @FIRST@, @WORDS@ and @BODY@ to fill in.
extern const char* const kReport;

}  // namespace sinew::study::web
