#include "tactree/viewer/markdown.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace tactree::viewer {
namespace {

constexpr const char* kPage = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{}</title><style>
:root {{ color-scheme: light dark; }}
body {{ font: 16px/1.6 system-ui, sans-serif; max-width: 60rem; margin: 3rem auto; padding: 0 1rem; }}
h1 {{ font-size: 1.5rem; }} h2 {{ font-size: 1.15rem; margin-top: 2.5rem; }}
code {{ font-size: 0.95em; }} svg {{ max-width: 100%; height: auto; }}
table {{ border-collapse: collapse; display: block; overflow-x: auto; }}
td {{ padding: 0.15rem 1rem 0.15rem 0; border-bottom: 1px solid #8884; }}
</style></head><body>
{}</body></html>
)";

/// Takes `open`text`close` off the front of `rest`.
bool take_between(std::string_view& rest, std::string_view open, std::string_view close,
                  std::string_view& text) {
  if (!rest.starts_with(open)) {
    return false;
  }
  const std::size_t end = rest.find(close, open.size());
  if (end == rest.npos || end == open.size()) {
    return false;
  }
  text = rest.substr(open.size(), end - open.size());
  rest.remove_prefix(end + close.size());
  return true;
}

/// One line's marks.
class Line {
 public:
  Line(std::string_view rest, const MarkdownTargets& targets) : rest_(rest), targets_(targets) {}

  std::string html() {
    while (!rest_.empty()) {
      const bool taken =
          mark("`", "code") || mark("**", "strong") || mark("*", "em") || picture() || link();
      if (!taken) {
        out_ += html_escaped(rest_.substr(0, 1));
        rest_.remove_prefix(1);
      }
    }
    return std::move(out_);
  }

 private:
  bool mark(std::string_view sign, std::string_view element) {
    std::string_view text;
    if (!take_between(rest_, sign, sign, text)) {
      return false;
    }
    out_ += fmt::format("<{0}>{1}</{0}>", element, html_escaped(text));
    return true;
  }

  bool picture() {
    std::string_view all;
    std::string_view target;
    std::string_view ahead = rest_;
    if (!take_between(ahead, "![", "](", all) || all.find('[') != all.npos) {
      return false;
    }
    const std::size_t end = ahead.find(')');
    if (end == ahead.npos) {
      return false;
    }
    target = ahead.substr(0, end);
    out_ += targets_.picture ? targets_.picture(target) : html_escaped(all);
    rest_ = ahead.substr(end + 1);
    return true;
  }

  bool link() {
    std::string_view text;
    std::string_view ahead = rest_;
    if (!take_between(ahead, "[", "](", text) || text.find('[') != text.npos) {
      return false;
    }
    const std::size_t end = ahead.find(')');
    if (end == ahead.npos) {
      return false;
    }
    const std::string address = targets_.link ? targets_.link(ahead.substr(0, end)) : "";
    out_ += address.empty()
                ? html_escaped(text)
                : fmt::format("<a href=\"{}\">{}</a>", html_escaped(address), html_escaped(text));
    rest_ = ahead.substr(end + 1);
    return true;
  }

  std::string_view rest_;
  const MarkdownTargets& targets_;
  std::string out_;
};

class Writer {
 public:
  explicit Writer(const MarkdownTargets& targets) : targets_(targets) {}

  void line(std::string_view line) {
    if (line.empty()) {
      within("");
    } else if (line.starts_with("## ")) {
      alone("h2", line.substr(3));
    } else if (line.starts_with("# ")) {
      alone("h1", line.substr(2));
    } else if (line.starts_with("- ")) {
      within("ul");
      out_ += "<li>" + marked(line.substr(2)) + "</li>\n";
    } else if (line.starts_with("|--")) {
      // between a table's heading and its rows
    } else if (line.starts_with("|")) {
      within("table");
      out_ += row(line.substr(1));
    } else {
      within("p");
      out_ += marked(line) + "\n";
    }
  }
  std::string take() {
    within("");
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::string marked(std::string_view text) const {
    return Line(text, targets_).html();
  }

  void alone(std::string_view element, std::string_view text) {
    within("");
    out_ += fmt::format("<{0}>{1}</{0}>\n", element, marked(text));
  }

  [[nodiscard]] std::string row(std::string_view cells) const {
    std::string out = "<tr>";
    while (!cells.empty()) {
      const std::size_t end = std::min(cells.find('|'), cells.size());
      out += "<td>" + marked(cells.substr(0, end)) + "</td>";
      cells.remove_prefix(std::min(end + 1, cells.size()));
    }
    return out + "</tr>\n";
  }

  void within(std::string_view element) {
    if (element == element_) {
      return;
    }
    out_ += element_.empty() ? "" : fmt::format("</{}>\n", element_);
    out_ += element.empty() ? "" : fmt::format("<{}>\n", element);
    element_ = element;
  }

  const MarkdownTargets& targets_;
  std::string out_;
  std::string_view element_;
};

}  // namespace

std::string html_escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string markdown_html(std::string_view markdown, const MarkdownTargets& targets) {
  Writer writer(targets);
  while (!markdown.empty()) {
    const std::size_t end = std::min(markdown.find('\n'), markdown.size());
    writer.line(markdown.substr(0, end));
    markdown.remove_prefix(std::min(end + 1, markdown.size()));
  }
  return writer.take();
}

std::string html_page(std::string_view title, std::string_view body) {
  return fmt::format(fmt::runtime(kPage), html_escaped(title), body);
}

}  // namespace tactree::viewer
