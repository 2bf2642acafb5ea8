#include <fmt/format.h>

#include <algorithm>

#include "tactree/viewer/site.hpp"

namespace tactree::viewer {
namespace {

constexpr std::string_view kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{}</title><style>
:root {{ color-scheme: light dark; }}
body {{ font: 17px/1.6 system-ui, sans-serif; max-width: 42rem; margin: 3rem auto; padding: 0 1rem; }}
h1 {{ font-size: 1.5rem; }} h2 {{ font-size: 1.1rem; margin-top: 2rem; }}
code {{ font-size: 0.95em; }} td, th {{ padding: 0.1rem 1rem 0.1rem 0; text-align: left; }}
</style></head><body>
)";

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

/// `[text](page.md)` at the front of `rest`: a link to that page. Only pages beside this one are
/// linked; of others the text stays.
bool take_link(std::string_view& rest, std::string& out) {
  const std::size_t middle = rest.find("](");
  const std::size_t end = middle == rest.npos ? rest.npos : rest.find(')', middle);
  if (end == rest.npos || rest.substr(1, middle - 1).find('[') != rest.npos) {
    return false;
  }
  const std::string_view text = rest.substr(1, middle - 1);
  std::string_view page = rest.substr(middle + 2, end - middle - 2);
  const bool beside = page.ends_with(".md") && page.find('/') == page.npos;
  page.remove_suffix(beside ? 3 : 0);
  out += beside ? fmt::format("<a href=\"/faults/{}\">{}</a>", escaped(page), escaped(text))
                : escaped(text);
  rest.remove_prefix(end + 1);
  return true;
}

/// `mark`text`mark` at the front of `rest`: the text in an element.
bool take_marked(std::string_view& rest, char mark, std::string_view element, std::string& out) {
  const std::size_t end = rest.find(mark, 1);
  if (end == rest.npos || end == 1) {
    return false;
  }
  out += fmt::format("<{0}>{1}</{0}>", element, escaped(rest.substr(1, end - 1)));
  rest.remove_prefix(end + 1);
  return true;
}

std::string line_html(std::string_view rest) {
  std::string out;
  while (!rest.empty()) {
    const char c = rest.front();
    const bool taken = (c == '`' && take_marked(rest, '`', "code", out)) ||
                       (c == '*' && take_marked(rest, '*', "em", out)) ||
                       (c == '[' && take_link(rest, out));
    if (!taken) {
      out += escaped(rest.substr(0, 1));
      rest.remove_prefix(1);
    }
  }
  return out;
}

std::string row_html(std::string_view line) {
  std::string out = "<tr>";
  line.remove_prefix(1);
  while (!line.empty()) {
    const std::size_t end = std::min(line.find('|'), line.size());
    out += "<td>" + line_html(line.substr(0, end)) + "</td>";
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return out + "</tr>\n";
}

/// Lines of one kind that follow each other are one element.
class Writer {
 public:
  explicit Writer(std::string& out) : out_(out) {}

  void line(std::string_view line) {
    if (line.empty()) {
      within("");
    } else if (line.starts_with("## ")) {
      within("");
      out_ += "<h2>" + line_html(line.substr(3)) + "</h2>\n";
    } else if (line.starts_with("# ")) {
      within("");
      out_ += "<h1>" + line_html(line.substr(2)) + "</h1>\n";
    } else if (line.starts_with("- ")) {
      within("ul");
      out_ += "<li>" + line_html(line.substr(2)) + "</li>\n";
    } else if (line.starts_with("|--")) {
      // between a table's heading and its rows
    } else if (line.starts_with("|")) {
      within("table");
      out_ += row_html(line);
    } else {
      within("p");
      out_ += line_html(line) + "\n";
    }
  }
  void end() { within(""); }

 private:
  void within(std::string_view element) {
    if (element == element_) {
      return;
    }
    out_ += element_.empty() ? "" : fmt::format("</{}>\n", element_);
    out_ += element.empty() ? "" : fmt::format("<{}>\n", element);
    element_ = element;
  }

  std::string& out_;
  std::string_view element_;
};

}  // namespace

std::string fault_html(std::string_view title, std::string_view markdown) {
  std::string out = fmt::format(fmt::runtime(kHead), escaped(title));
  Writer writer(out);
  while (!markdown.empty()) {
    const std::size_t end = std::min(markdown.find('\n'), markdown.size());
    writer.line(markdown.substr(0, end));
    markdown.remove_prefix(std::min(end + 1, markdown.size()));
  }
  writer.end();
  return out + "<p><a href=\"/faults/\">All faults and limits</a></p></body></html>\n";
}

}  // namespace tactree::viewer
