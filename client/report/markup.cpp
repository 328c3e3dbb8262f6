#include "client/report/markup.hpp"

#include <algorithm>

#include "engine/base/print.hpp"

namespace landmarkdb::client {
namespace {

bool numeric(const std::string& title) { return !title.empty() && title[0] == '#'; }

}  // namespace

void HtmlTable::add(const std::vector<std::string>& cells) {
  rows_ += "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool number = i < titles_.size() && numeric(titles_[i]);
    rows_ += (number ? "<td class=\"n\">" : "<td>") + cells[i] + "</td>";
  }
  rows_ += "</tr>\n";
}

std::string HtmlTable::html(const std::string& caption) const {
  std::string out = "<div class=\"scroll\"><table>";
  if (!caption.empty()) out += "<caption>" + caption + "</caption>";
  out += "<thead><tr>";
  for (const std::string& title : titles_) {
    out += numeric(title) ? "<th scope=\"col\" class=\"n\">" + title.substr(1)
                          : "<th scope=\"col\">" + title;
    out += "</th>";
  }
  return out + "</tr></thead>\n<tbody>\n" + rows_ + "</tbody></table></div>\n";
}

std::string bar(double share) {
  const double percent = 100.0 * std::clamp(share, 0.0, 1.0);
  return "<span class=\"bar\" style=\"width:" + print("%.1f", percent) + "%\"></span>";
}

}  // namespace landmarkdb::client
