#include "collection/overview.hpp"

#include <fmt/format.h>

#include <array>
#include <map>
#include <string>

#include "tactree/support/output_file.hpp"
#include "tactree/support/uri.hpp"
#include "tactree/viewer/markdown.hpp"

namespace tactree::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::array kManifestColumns = {
    "name",
    "result",
    "input",
    "digest",
    "blob_digest",
    "bytes",
    "points",
    "spacing_m",
    "size_x_m",
    "size_y_m",
    "size_z_m",
    "confidence",
    "ambiguous_points",
    "holes",
    "open_boundaries",
    "largest_gap_m",
    "seconds",
    "warnings",
    "error",
};

struct PageColumn {
  const char* key;
  const char* title;
};
constexpr std::array kPageColumns = {
    PageColumn{"name", "scan"},
    PageColumn{"result", "result"},
    PageColumn{"size_x_m", "x, m"},
    PageColumn{"size_y_m", "y, m"},
    PageColumn{"size_z_m", "z, m"},
    PageColumn{"points", "points"},
    PageColumn{"bytes", "bytes"},
    PageColumn{"confidence", "confidence of the outside"},
    PageColumn{"ambiguous_points", "ambiguous points"},
    PageColumn{"holes", "holes"},
    PageColumn{"open_boundaries", "open boundaries"},
    PageColumn{"largest_gap_m", "largest gap, m"},
    PageColumn{"seconds", "seconds"},
};

constexpr const char* kStyle = R"(<style>
main, body { max-width: none; }
th button { font: inherit; font-weight: bold; cursor: pointer; }
td img { width: 256px; height: 144px; }
</style>
)";

constexpr const char* kSorting = R"(<script>
for (const button of document.querySelectorAll("th button")) {
  let direction = -1;
  button.onclick = () => {
    direction = -direction;
    const body = document.querySelector("tbody");
    const column = button.parentElement.cellIndex;
    const rows = Array.from(body.rows, (row) => [row.cells[column].textContent, row]);
    const compare = new Intl.Collator(undefined, { numeric: true }).compare;
    const difference = (a, b) => (a === "" || b === "" || isNaN(a) || isNaN(b) ? compare(a, b) : a - b);
    rows.sort(([a], [b]) => direction * difference(a, b));
    for (const [, row] of rows) body.append(row);
  };
}
</script>
)";

/// A value as text; several, such as the warnings, separated by "; ".
std::string cell_text(const ObjectRow& row, const char* key) {
  const auto value = row.find(key);
  if (value == row.end()) {
    return "";
  }
  if (!value->is_array()) {
    return value->is_string() ? value->get<std::string>() : value->dump();
  }
  std::string text;
  for (const ObjectRow& element : *value) {
    text += (text.empty() ? "" : "; ") +
            (element.is_string() ? element.get<std::string>() : element.dump());
  }
  return text;
}

std::string quoted_csv(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  return quoted + '"';
}

std::string manifest_csv(std::span<const ObjectRow> rows) {
  std::string text = fmt::format("{}\n", fmt::join(kManifestColumns, ","));
  for (const ObjectRow& row : rows) {
    std::string line;
    for (const char* const column : kManifestColumns) {
      line += (line.empty() ? "" : ",") + quoted_csv(cell_text(row, column));
    }
    text += line + "\n";
  }
  return text;
}

std::string page_row(const ObjectRow& row) {
  const std::string name = text_of(row, "name");
  const bool is_built = row.contains("blob_digest") && text_of(row, "result") != kResultMissing;
  std::string cells =
      is_built
          ? fmt::format(R"(<td><a href="{0}.png"><img loading="lazy" src="{0}.png" alt=""></a>)",
                        "./" + support::encoded_uri(name))
          : "<td>";
  for (const PageColumn& column : kPageColumns) {
    const auto value = row.find(column.key);
    cells += "<td>" + (value != row.end() && value->is_number_float()
                           ? fmt::format("{:.4g}", value->get<double>())
                           : viewer::escaped_html(cell_text(row, column.key)));
  }
  return fmt::format("<tr>{}<td>{}{}\n", cells, viewer::escaped_html(cell_text(row, "warnings")),
                     viewer::escaped_html(cell_text(row, "error")));
}

std::string index_page(std::span<const ObjectRow> rows) {
  std::map<std::string, std::size_t> counts;
  std::string body;
  for (const ObjectRow& row : rows) {
    ++counts[text_of(row, "result")];
    body += page_row(row);
  }
  std::string sums = fmt::format("{} objects", rows.size());
  for (const auto& [result, count] : counts) {
    sums += fmt::format(", {} {}", count, viewer::escaped_html(result));
  }
  std::string head = "<th>preview";
  for (const PageColumn& column : kPageColumns) {
    head += fmt::format("<th><button>{}</button>", column.title);
  }
  return viewer::html_page(
      "Collection",
      fmt::format("{}<h1>Collection</h1>\n<p>{}. A click on the title of a column sorts the "
                  "table.\n<table>\n<thead><tr>{}<th>warnings and errors\n<tbody>\n{}</table>\n{}",
                  kStyle, sums, head, body, kSorting));
}

}  // namespace

std::vector<ObjectRow> read_rows(const fs::path& output,
                                 std::span<const CollectionObject> objects) {
  std::vector<ObjectRow> rows;
  for (const CollectionObject& object : objects) {
    const ObjectFiles files(output, object);
    ObjectRow row = read_row(files).value_or(ObjectRow::object());
    std::error_code ignored;
    const std::string result = text_of(row, "result");
    if (result.empty() || (result != kResultFailed && !fs::exists(files.blob, ignored))) {
      row["result"] = kResultMissing;
      row["error"] = files.blob.string() + ": does not exist (run the build of its part again)";
    }
    row["name"] = object.name;
    row.erase("report");
    rows.push_back(std::move(row));
  }
  return rows;
}

void write_overview(const fs::path& output, std::span<const ObjectRow> rows) {
  support::write_file(output / "manifest.csv", manifest_csv(rows));
  support::write_file(output / "index.html", index_page(rows));
}

}  // namespace tactree::cli
