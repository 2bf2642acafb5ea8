#pragma once
// The paths of the server and their content. The page and the fault pages are embedded in the
// program; the rest is generated from the models and the session. No file is read.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tactree/viewer/point_tree.hpp"
#include "tactree/viewer/source.hpp"
#include "tactree/web/types.hpp"

namespace tactree::viewer {

using web::HttpResponse;

/// A text file embedded in the program.
struct Asset {
  std::string_view path;
  std::string_view type;
  std::string_view content;
};

/// The built page ("/", "/assets/..."), or a page with the reason why it was not built.
[[nodiscard]] std::span<const Asset> page_assets();
/// "/faults/NAME": Markdown.
[[nodiscard]] std::span<const Asset> fault_pages();
/// Returns false if the program was built without its page.
[[nodiscard]] bool has_page();

/// A page of docs/faults as HTML; links to other such pages are kept.
[[nodiscard]] std::string fault_html(std::string_view title, std::string_view markdown);

class Site {
 public:
  /// The views' bytes and the source must outlive the site.
  /// `scan` is that of the first model.
  Site(std::vector<core::BlobView> models, const Source& source, ScanFacts scan = {});

  /// The content of a path without query; 404 if the path is unknown. Slow for is_slow() paths. May
  /// be called from any thread.
  ///   /                      the page            /assets/...
  ///   /faults/ /faults/NAME  explanation of faults and limits
  ///   /model/I               the nodes of model I, JSON
  ///   /model/I/points/NODE   PackedPoints
  ///   /model/I/materials/NODE  PointTree::materials()
  ///   /model/I/colours/NODE  PointTree::colours()
  ///   /model/I/octants/LEVEL level and edge, then corners: little-endian u32, float32s
  ///   /trace.csv             the ticks so far
  ///   /reach.json            the border of the device's workspace
  [[nodiscard]] HttpResponse answer(std::string_view path) const;
  [[nodiscard]] static bool is_slow(std::string_view path);

 private:
  [[nodiscard]] HttpResponse answer_model(std::string_view path) const;

  std::vector<core::BlobView> models_;
  std::vector<PointTree> trees_;
  ScanFacts scan_;
  const Source& source_;
};

}  // namespace tactree::viewer
