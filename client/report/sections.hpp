#pragma once

#include <string>

#include "client/report/drawing.hpp"
#include "client/report/report.hpp"

namespace landmarkdb::client {

// The parts of the page, as HTML that holds without any program.
std::string verdict_html(const ReportInput& input, const QueryResult& result);
std::string figure_html(const Drawing& drawing, const QueryResult& result);
std::string explanation_html(const QueryResult& result);
std::string poses_html(const QueryResult& result);
std::string counts_html(const ReportInput& input, const QueryResult& result);

}  // namespace landmarkdb::client
