#include "client/report/report.hpp"

#include <nlohmann/json.hpp>

#include "cli/version.hpp"
#include "client/render_json.hpp"
#include "client/report/data.hpp"
#include "client/report/drawing.hpp"
#include "client/report/html.hpp"
#include "client/report/resources.hpp"
#include "client/report/sections.hpp"

namespace landmarkdb::client {

std::string report_html(const ReportInput& input, const QueryResult& result) {
  const Drawing drawing = make_drawing(input.cloud, input.options.up, result);
  const std::string program = "landmarkdb " + std::string(cli::program_version());
  return fill_template(
      kReportHtml,
      {{"generator", html_text(program)},
       {"title", html_text(std::string(status_name(result.status)) + ": " + input.cloud_name)},
       {"css", std::string(kReportCss)},
       {"js", std::string(kReportJs)},
       {"verdict", verdict_html(input, result)},
       {"figure", figure_html(drawing, result)},
       {"sections", explanation_html(result) + poses_html(result) + counts_html(input, result)},
       {"data", json_for_script(drawing_json(drawing))},
       {"footer", "Made by " + html_text(program) + ". Nothing in this page is fetched."}});
}

}  // namespace landmarkdb::client
