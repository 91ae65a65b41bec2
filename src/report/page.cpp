#include "paracal/report/page.hpp"

#include <boost/algorithm/string/replace.hpp>

#include "paracal/error.hpp"

namespace paracal::report {
namespace {

constexpr std::string_view kPlace = "PARACAL_REPORT_DATA";

/// JSON that may stand between two tags. '<' occurs in strings only, where JSON has another way to write it.
std::string within_html(const io::Json& data) {
  std::string json = data.dump(-1, ' ', false, io::Json::error_handler_t::replace);
  boost::algorithm::replace_all(json, "<", "\\u003c");
  return json;
}

}  // namespace

std::string page(std::string_view html_template, const io::Json& data) {
  const std::size_t place = html_template.find(kPlace);
  if (place == std::string_view::npos) throw Error("the report template has no place for data");
  std::string html(html_template.substr(0, place));
  html += within_html(data);
  html += html_template.substr(place + kPlace.size());
  return html;
}

}  // namespace paracal::report
