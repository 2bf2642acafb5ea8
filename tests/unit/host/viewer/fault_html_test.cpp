// The fault pages as HTML.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "fault_advice.hpp"
#include "tactree/core/safety/faults.hpp"
#include "tactree/viewer/site.hpp"

namespace tactree::test {
namespace {

using viewer::fault_html;

bool contains(const std::string& html, std::string_view text) {
  return html.find(text) != std::string::npos;
}

TEST(FaultHtml, RendersHeadingsParagraphsAndLists) {
  const std::string html = fault_html("t", "# A\n\ntext `c` *e* **s**\n\n## B\n- one\n- two\n");
  EXPECT_TRUE(contains(html, "<h1>A</h1>"));
  EXPECT_TRUE(contains(html, "<p>text <code>c</code> <em>e</em> <strong>s</strong></p>"));
  EXPECT_TRUE(contains(html, "<h2>B</h2>\n<ul>\n<li>one</li>\n<li>two</li>\n</ul>"));
}

TEST(FaultHtml, RendersTables) {
  const std::string html = fault_html("t", "| a |\n|---|\n| b |\n");
  EXPECT_TRUE(contains(html, "<th>a</th>"));
  EXPECT_TRUE(contains(html, "<td>b</td>"));
  EXPECT_FALSE(contains(html, "---"));
}

TEST(FaultHtml, LinksOnlyToFaultPages) {
  const std::string html = fault_html("t", "| a |\n|---|\n| [b](c.md) [d](../e.md) |\n");
  EXPECT_TRUE(contains(html, "<a href=\"/faults/c\">b</a> d"));
  EXPECT_FALSE(contains(fault_html("t", "[x](javascript:alert)"), "javascript"));
}

TEST(FaultHtml, ShowsIncompleteMarkupAsText) {
  const std::string html = fault_html("<t>", "a < b & *c `d [e](f [g\n");
  EXPECT_TRUE(contains(html, "a &lt; b &amp; *c `d [e](f [g"));
  EXPECT_TRUE(contains(html, "<title>&lt;t&gt;</title>"));
}

TEST(FaultHtml, ShowsRawHtmlAsText) {
  const std::string html =
      fault_html("t", "a <b onclick=\"c()\">d</b>\n\n<script>\ne()\n</script>\n\n![f<g>](h)\n");
  EXPECT_TRUE(contains(html, "a &lt;b onclick=&quot;c()&quot;&gt;d&lt;/b&gt;"));
  EXPECT_TRUE(contains(html, "&lt;script&gt;\ne()\n&lt;/script&gt;"));
  EXPECT_TRUE(contains(html, "f&lt;g&gt;"));
  EXPECT_FALSE(contains(html, "<script"));
  EXPECT_FALSE(contains(html, "<img"));
}

TEST(FaultPages, CoverEveryFaultAndLimit) {
  const auto has = [](const std::string& name) {
    for (const viewer::Asset& page : viewer::fault_pages()) {
      if (page.path == name) {
        return true;
      }
    }
    return false;
  };
  for (std::uint32_t code = 1; code < core::kFaultCodes; ++code) {
    EXPECT_TRUE(has(core::name_of(static_cast<core::Fault>(code)))) << code;
  }
  for (std::uint32_t bit = 0; bit < core::kLimits; ++bit) {
    EXPECT_TRUE(has(std::string("limit-") + core::name_of(static_cast<core::Limit>(1U << bit))));
  }
}

TEST(FaultAdvice, NamesCauseAndRemedyOfEveryFault) {
  for (std::uint32_t code = 1; code < core::kFaultCodes; ++code) {
    const std::string& advice = viewer::fault_advice(static_cast<core::Fault>(code));
    EXPECT_GT(advice.size(), 40U) << code;
    EXPECT_EQ(std::count(advice.begin(), advice.end(), '.') > 1, true) << advice;
    EXPECT_EQ(advice.find_first_of("`*#\n"), std::string::npos) << advice;
  }
  EXPECT_EQ(viewer::fault_advice(core::Fault::kNone), "");
  EXPECT_EQ(
      viewer::fault_advice(core::Fault::kSupply),
      "The supply voltage of the amplifiers left the range supply_min_V .. supply_max_V while "
      "the device was armed or active. Add capacitance or a brake resistor, or lower "
      "force_max_N.");
  const std::string& lost = viewer::fault_advice(core::Fault::kLinkLost);
  EXPECT_TRUE(contains(lost, "On a busy computer")) << lost;
  EXPECT_TRUE(contains(lost, "--link-timeout")) << lost;
}

}  // namespace
}  // namespace tactree::test
