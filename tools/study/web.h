// Files of tools/study/web, built into the program.
#pragma once

namespace sinew::study::web {

extern const char* const kReport;  ///< report.html with @UPLOT_CSS@, @UPLOT_JS@ and @DATA@ to fill in
extern const char* const kChartScript;
extern const char* const kChartStyle;

}  // namespace sinew::study::web
