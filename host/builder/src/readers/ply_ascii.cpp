#include <fmt/format.h>

#include "number.hpp"
#include "ply_body.hpp"
#include "remedies.hpp"

namespace tactree::builder {
namespace {

class AsciiBody {
 public:
  AsciiBody(InputFile& file, ScanBuilder& builder) : file_(file), builder_(builder) {}

  void read(const PlyElement& element) {
    if (element.properties.empty()) return;
    element_ = &element;
    const PlyRole role = role_of(element);
    slots_.assign(element.properties.size(), kNoSlot);
    if (role == PlyRole::kVertex) {
      for (const PlyField& field : vertex_fields(element)) slots_[field.property] = field.slot;
    }
    for (std::uint64_t row = 0; row < element.count; ++row) {
      const std::string_view line = next_row(row);
      if (role == PlyRole::kVertex) {
        read_vertex(line);
      } else if (role != PlyRole::kOther) {
        read_face(line, role);
      }
    }
  }

 private:
  /// Reads the next line that is not blank.
  std::string_view next_row(std::uint64_t row) {
    std::string_view line;
    while (file_.next_line(line)) {
      if (!trim(line).empty()) return line;
    }
    throw_truncated(file_, *element_, row);
  }

  void read_vertex(std::string_view rest) {
    PointRow row{};
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      if (element_->properties[i].is_list) {
        skip_list(rest);
        continue;
      }
      const std::string_view word = next_word(rest);
      if (slots_[i] != kNoSlot && !parse_number(word, row[slots_[i]])) fail_number(word);
    }
    if (!trim(rest).empty()) {
      fail(fmt::format("the row has more values than the {} that the header names", slots_.size()));
    }
    builder_.add_point(row);
  }

  void read_face(std::string_view rest, PlyRole role) {
    const std::size_t corner_list = index_property(*element_);
    for (std::size_t i = 0; i <= corner_list; ++i) {
      if (!element_->properties[i].is_list) {
        (void)next_word(rest);
      } else if (i < corner_list) {
        skip_list(rest);
      } else {
        read_corners(rest);
      }
    }
    if (role == PlyRole::kFace) {
      builder_.add_face(corners_, file_.line_number());
      return;
    }
    StripReader strip(builder_, file_.line_number());
    for (const std::int64_t corner : corners_) strip.add(corner);
  }

  void read_corners(std::string_view& rest) {
    corners_.clear();
    for (std::uint64_t left = list_length(rest); left > 0; --left) {
      const std::string_view word = next_word(rest);
      std::int64_t corner = 0;
      if (!parse_corner(word, corner)) fail_number(word);
      corners_.push_back(corner);
    }
  }

  void skip_list(std::string_view& rest) {
    for (std::uint64_t left = list_length(rest); left > 0; --left) (void)next_word(rest);
  }

  std::uint64_t list_length(std::string_view& rest) {
    const std::string_view word = next_word(rest);
    std::int64_t length = 0;
    if (!parse_integer(word, length) || length < 0) {
      fail(fmt::format("\"{}\" is not the length of a list", printable(word)));
    }
    return static_cast<std::uint64_t>(length);
  }

  std::string_view next_word(std::string_view& rest) {
    const std::string_view word = take_word(rest);
    if (word.empty()) {
      fail(fmt::format("the row of \"{}\" has fewer values than the header names", element_->name));
    }
    return word;
  }

  [[noreturn]] void fail_number(std::string_view word) const {
    fail(fmt::format("\"{}\" is not a number", printable(word)));
  }

  [[noreturn]] void fail(const std::string& cause) const {
    throw ReadError(file_.name(), file_.line_place(), cause, kCopyDamaged);
  }

  InputFile& file_;
  ScanBuilder& builder_;
  const PlyElement* element_ = nullptr;
  std::vector<Slot> slots_;  // per property
  std::vector<std::int64_t> corners_;
};

}  // namespace

std::uint64_t read_ply_ascii(InputFile& file, std::span<const PlyElement> elements,
                             ScanBuilder& builder) {
  AsciiBody body(file, builder);
  for (const PlyElement& element : elements) body.read(element);
  std::uint64_t rows = 0;
  std::string_view line;
  while (file.next_line(line)) rows += trim(line).empty() ? 0U : 1U;
  return rows;
}

}  // namespace tactree::builder
