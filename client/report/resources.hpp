#pragma once

#include <string_view>

namespace landmarkdb::client {

// web/report.html, .css and .js as they were when the program was built (cmake/embed.cmake).
extern const std::string_view kReportHtml;
extern const std::string_view kReportCss;
extern const std::string_view kReportJs;

}  // namespace landmarkdb::client
