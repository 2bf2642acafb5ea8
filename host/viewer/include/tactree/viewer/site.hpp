#pragma once
// What the server answers to which path. Nothing is looked up in the file system: the page and the
// pages of the faults are part of the program, the rest is made of the models and the session.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tactree/viewer/point_tree.hpp"
#include "tactree/viewer/source.hpp"

namespace tactree::viewer {

struct Answer {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  std::string file_name;  ///< empty: to be shown, else: to be kept under this name
};

/// A text file that is part of the program.
struct Asset {
  std::string_view path;
  std::string_view type;
  std::string_view content;
};

/// The built page: "/", "/assets/..."; a page that says what is missing where it was not built.
[[nodiscard]] std::span<const Asset> page_assets();
/// "/faults/NAME": Markdown.
[[nodiscard]] std::span<const Asset> fault_pages();
/// Was the page built?
[[nodiscard]] bool has_page();

/// A page of docs/faults as HTML, with its links to other such pages.
[[nodiscard]] std::string fault_html(std::string_view title, std::string_view markdown);

class Site {
 public:
  /// The views' bytes and the source must outlive the site.
  Site(std::vector<core::BlobView> models, const Source& source);

  /// Of a path without query. May take long for is_slow() paths; any thread.
  ///   /                      the page            /assets/...
  ///   /faults/ /faults/NAME  why the force is off
  ///   /model/I               the nodes of model I, JSON
  ///   /model/I/points/NODE   PackedPoints
  ///   /model/I/octants/LEVEL level and edge, then corners: little-endian u32, float32s
  ///   /trace.csv             the ticks so far
  [[nodiscard]] Answer answer(std::string_view path) const;
  [[nodiscard]] static bool is_slow(std::string_view path);

 private:
  [[nodiscard]] Answer answer_model(std::string_view path) const;

  std::vector<core::BlobView> models_;
  std::vector<PointTree> trees_;
  const Source& source_;
};

}  // namespace tactree::viewer
