#pragma once
// Markdown (CommonMark and GitHub's tables) as HTML, for the fault pages and the evaluation report.
// Raw HTML in the text is shown as text; links and pictures go through MarkdownTargets.

#include <functional>
#include <string>
#include <string_view>

namespace tactree::viewer {

struct MarkdownTargets {
  /// Maps a link's target to an address. If the function or its result is empty, only the text of
  /// the link remains.
  std::function<std::string(std::string_view)> link;
  /// Maps a picture's target to markup, which is inserted unchanged. If empty, the alternative text
  /// is inserted.
  std::function<std::string(std::string_view)> picture;
};

/// The body of a page.
[[nodiscard]] std::string markdown_html(std::string_view markdown, const MarkdownTargets& targets);

/// The text, without markup, of the first paragraph below the heading of the second level; of the
/// document if `heading` is empty. Empty if there is none.
[[nodiscard]] std::string markdown_paragraph(std::string_view markdown, std::string_view heading);

/// A text as HTML shows it, also within an attribute.
[[nodiscard]] std::string escaped_html(std::string_view text);

/// A complete page around `body`. It loads no external resources and follows the browser's dark
/// mode. `title` is escaped, `body` is not.
[[nodiscard]] std::string html_page(std::string_view title, std::string_view body);

}  // namespace tactree::viewer
