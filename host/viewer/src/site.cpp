#include "tactree/viewer/site.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <optional>
#include <utility>

#include "tactree/viewer/markdown.hpp"

namespace tactree::viewer {
namespace {

static_assert(std::endian::native == std::endian::little, "points are sent in memory order");

constexpr std::size_t kMaxOctants = 20000;
constexpr std::string_view kFaults = "/faults/";
constexpr std::string_view kModel = "/model/";
constexpr std::string_view kTrace = "/trace.csv";
constexpr std::string_view kReach = "/reach.json";

HttpResponse not_found() { return {404, "text/plain; charset=utf-8", "unknown page\n", {}}; }

HttpResponse binary(const void* bytes, std::size_t size) {
  return {200, "application/octet-stream", std::string(static_cast<const char*>(bytes), size), {}};
}

/// Removes "NUMBER" or "NUMBER/" from the beginning of `path`; nullopt if there is none.
std::optional<std::uint32_t> take_number(std::string_view& path) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(path.data(), path.data() + path.size(), number);
  if (error != std::errc()) {
    return std::nullopt;
  }
  path.remove_prefix(static_cast<std::size_t>(end - path.data()));
  if (!path.empty() && path.front() == '/') {
    path.remove_prefix(1);
  } else if (!path.empty()) {
    return std::nullopt;
  }
  return number;
}

bool take_word(std::string_view& path, std::string_view word) {
  const bool there = path.starts_with(word);
  path.remove_prefix(there ? word.size() : 0);
  return there;
}

HttpResponse octants(const core::BlobView& view, std::uint32_t level) {
  const OctantBoxes boxes = octant_boxes(view, level, kMaxOctants);
  HttpResponse answer = binary(&boxes.level, sizeof(boxes.level));
  answer.body.append(reinterpret_cast<const char*>(&boxes.edge_m), sizeof(boxes.edge_m));
  answer.body.append(reinterpret_cast<const char*>(boxes.corners_m.data()),
                     boxes.corners_m.size() * sizeof(boxes.corners_m[0]));
  return answer;
}

const Asset* find(std::span<const Asset> assets, std::string_view path) {
  const auto found = std::find_if(assets.begin(), assets.end(),
                                  [&](const Asset& asset) { return asset.path == path; });
  return found == assets.end() ? nullptr : &*found;
}

}  // namespace

bool has_page() {
  const Asset* const script = find(page_assets(), "/assets/page.js");
  return script != nullptr && !script->content.empty();
}

std::string fault_html(std::string_view title, std::string_view markdown) {
  MarkdownTargets targets;
  targets.link = [](std::string_view target) -> std::string {
    const bool beside = target.ends_with(".md") && target.find('/') == target.npos;
    return beside ? std::string(kFaults) + std::string(target.substr(0, target.size() - 3)) : "";
  };
  return html_page(title, markdown_html(markdown, targets) +
                              "<p><a href=\"/faults/\">All faults and limits</a></p>\n");
}

Site::Site(std::vector<core::BlobView> models, const Source& source, ScanFacts scan)
    : models_(std::move(models)), scan_(std::move(scan)), source_(source) {
  for (const core::BlobView& view : models_) {
    trees_.emplace_back(view, std::span<const Rgb>(scan_.point_colours));
    scan_.point_colours = std::vector<Rgb>();  // those of the first model only
  }
}

bool Site::is_slow(std::string_view path) {
  return path == kTrace || path == kReach ||
         (path.starts_with(kModel) && path.find("/octants/") != path.npos);
}

HttpResponse Site::answer(std::string_view path) const {
  if (path == kTrace) {
    return {200, "text/csv; charset=utf-8", source_.trace_csv(), "trace.csv"};
  }
  if (path == kReach) {
    return {200, "application/json", source_.reach_json(), {}};
  }
  if (path.starts_with(kModel)) {
    return answer_model(path.substr(kModel.size()));
  }
  if (path.starts_with(kFaults)) {
    const std::string_view name =
        path.size() == kFaults.size() ? "README" : path.substr(kFaults.size());
    const Asset* const page = find(fault_pages(), name);
    return page == nullptr
               ? not_found()
               : HttpResponse{200, "text/html; charset=utf-8", fault_html(name, page->content), {}};
  }
  const Asset* const asset = find(page_assets(), path);
  return asset == nullptr ? not_found()
                          : HttpResponse{200,
                                         std::string(asset->type) + "; charset=utf-8",
                                         std::string(asset->content),
                                         {}};
}

HttpResponse Site::answer_model(std::string_view path) const {
  const auto number = take_number(path);
  if (!number || *number >= models_.size()) {
    return not_found();
  }
  const PointTree& tree = trees_[*number];
  if (path.empty()) {
    const ScanFacts none;
    return {200,
            "application/json",
            tree_json(tree, models_[*number], *number == 0 ? scan_ : none),
            {}};
  }
  const bool wants_points = take_word(path, "points/");
  const bool wants_octants = !wants_points && take_word(path, "octants/");
  const bool wants_materials = !wants_points && !wants_octants && take_word(path, "materials/");
  const bool wants_colours =
      !wants_points && !wants_octants && !wants_materials && take_word(path, "colours/");
  const bool is_known = wants_points || wants_octants || wants_materials || wants_colours;
  const auto which = take_number(path);
  if (!which || !path.empty() || !is_known) {
    return not_found();
  }
  if (wants_octants) {
    return octants(models_[*number], *which);
  }
  if (*which >= tree.nodes().size()) {
    return not_found();
  }
  if (wants_materials) {
    const auto materials = tree.materials(*which);
    return binary(materials.data(), materials.size_bytes());
  }
  if (wants_colours) {
    const auto colours = tree.colours(*which);
    return binary(colours.data(), colours.size_bytes());
  }
  const auto points = tree.points(*which);
  return binary(points.data(), points.size_bytes());
}

}  // namespace tactree::viewer
