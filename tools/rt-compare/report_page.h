#pragma once

namespace rt {

/// report_page.html, .css and .js as they are in the source folder: see embed_page.cmake.
extern const char* const kReportPage;
extern const char* const kReportStyle;
extern const char* const kReportScript;

} // namespace rt
