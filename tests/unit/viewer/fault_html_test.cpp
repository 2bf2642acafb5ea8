// The pages of the faults, as a browser gets them.

#include <gtest/gtest.h>

#include "tactree/core/faults.hpp"
#include "tactree/viewer/site.hpp"

namespace tactree::test {
namespace {

using viewer::fault_html;

TEST(FaultHtml, WritesWhatThePagesAreMadeOf) {
  const std::string html = fault_html("t", "# A\n\ntext `c` *e* **s**\n\n## B\n- one\n- two\n");
  EXPECT_NE(html.find("<h1>A</h1>"), std::string::npos);
  EXPECT_NE(html.find("<p>\ntext <code>c</code> <em>e</em> <strong>s</strong>\n</p>"),
            std::string::npos);
  EXPECT_NE(html.find("<h2>B</h2>\n<ul>\n<li>one</li>\n<li>two</li>\n</ul>"), std::string::npos);
}

TEST(FaultHtml, WritesTablesAndLinksToPagesBesideIt) {
  const std::string html = fault_html("t", "| a |\n|---|\n| [b](c.md) [d](../e.md) |\n");
  EXPECT_NE(html.find("<a href=\"/faults/c\">b</a> d"), std::string::npos);
  EXPECT_EQ(html.find("---"), std::string::npos);
}

TEST(FaultHtml, NothingBecomesMarkupThatIsNone) {
  const std::string html = fault_html("<t>", "a < b & *c `d [e](f [g\n");
  EXPECT_NE(html.find("a &lt; b &amp; *c `d [e](f [g"), std::string::npos);
  EXPECT_NE(html.find("<title>&lt;t&gt;</title>"), std::string::npos);
}

TEST(FaultPages, EveryFaultAndLimitHasOne) {
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

}  // namespace
}  // namespace tactree::test
