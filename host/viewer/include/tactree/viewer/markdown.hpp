#pragma once
// Pages of our own documentation and reports as HTML: headings, paragraphs, lists, tables, `code`,
// *emphasis*, **strong**, [links](target) and ![pictures](target). No other Markdown, and nothing
// of the text becomes markup.

#include <functional>
#include <string>
#include <string_view>

namespace tactree::viewer {

struct MarkdownTargets {
  /// The address of a link's target; empty: its text stays, without a link.
  std::function<std::string(std::string_view)> link;
  /// The markup of a picture's target.
  std::function<std::string(std::string_view)> picture;
};

/// A body of a page. Lines of one kind that follow each other are one element.
[[nodiscard]] std::string markdown_html(std::string_view markdown, const MarkdownTargets& targets);

/// A page around it that needs nothing from elsewhere; in the dark it is dark.
[[nodiscard]] std::string html_page(std::string_view title, std::string_view body);

[[nodiscard]] std::string html_escaped(std::string_view text);

}  // namespace tactree::viewer
