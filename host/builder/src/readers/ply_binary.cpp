#include <fmt/format.h>

#include <algorithm>

#include "ply_body.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kPlyBlockBytes = std::size_t{1} << 16;
constexpr std::uint64_t kMaxCorners = std::uint64_t{1} << 20;
constexpr double kIndexEnd = 4294967296.0;

std::int64_t to_index(double value) {
  return value >= 0.0 && value < kIndexEnd ? static_cast<std::int64_t>(value) : -1;
}

struct FixedField {
  std::size_t offset;
  ScalarType type;
  Slot slot;
};

template <bool Swap>
class BinaryBody {
 public:
  BinaryBody(InputFile& file, ScanBuilder& builder) : file_(file), builder_(builder) {}

  void read(const PlyElement& element) {
    element_ = &element;
    row_ = 0;
    if (role_of(element) == PlyRole::kVertex) {
      return element.has_list() ? read_list_vertices() : read_fixed_vertices();
    }
    if (role_of(element) == PlyRole::kOther && !element.has_list()) {
      return file_.skip(element.count * element.min_row_bytes());  // at most to the end
    }
    if (element.properties.empty()) return;
    for (row_ = 0; row_ < element.count; ++row_) read_row();
  }

 private:
  /// Reads rows of constant size, many at a time.
  void read_fixed_vertices() {
    const std::vector<FixedField> fields = fixed_fields();
    const auto row_bytes = static_cast<std::size_t>(element_->min_row_bytes());
    PointRow row{};
    while (row_ < element_->count) {
      const std::string_view block = file_.peek(std::max(row_bytes, kPlyBlockBytes));
      const std::uint64_t rows =
          std::min<std::uint64_t>(element_->count - row_, block.size() / row_bytes);
      if (rows == 0) throw_truncated(file_, *element_, row_);
      const char* at = block.data();
      for (std::uint64_t i = 0; i < rows; ++i, at += row_bytes) {
        for (const FixedField& field : fields) {
          row[field.slot] = load_scalar<Swap>(at + field.offset, field.type);
        }
        builder_.add_point(row);
      }
      file_.consume(static_cast<std::size_t>(rows) * row_bytes);
      row_ += rows;
    }
  }

  std::vector<FixedField> fixed_fields() const {
    std::vector<FixedField> fields;
    for (const PlyField& field : vertex_fields(*element_)) {
      std::size_t offset = 0;
      for (std::size_t i = 0; i < field.property; ++i) {
        offset += size_of(element_->properties[i].type);
      }
      fields.push_back({offset, element_->properties[field.property].type, field.slot});
    }
    return fields;
  }

  void read_list_vertices() {
    std::vector<Slot> slots(element_->properties.size(), kNoSlot);
    for (const PlyField& field : vertex_fields(*element_)) slots[field.property] = field.slot;
    PointRow row{};
    for (row_ = 0; row_ < element_->count; ++row_) {
      for (std::size_t i = 0; i < slots.size(); ++i) {
        const PlyProperty& property = element_->properties[i];
        if (property.is_list) {
          skip_list(property);
          continue;
        }
        const double value = next_value(property.type);
        if (slots[i] != kNoSlot) row[slots[i]] = value;
      }
      builder_.add_point(row);
    }
  }

  void read_row() {
    const std::size_t corners = index_property(*element_);
    const PlyRole role = role_of(*element_);
    for (std::size_t i = 0; i < element_->properties.size(); ++i) {
      const PlyProperty& property = element_->properties[i];
      if (!property.is_list) {
        need(size_of(property.type));
        file_.consume(size_of(property.type));
      } else if (i != corners || role == PlyRole::kOther) {
        skip_list(property);
      } else if (role == PlyRole::kStrip) {
        read_strip(property);
      } else {
        read_face(property);
      }
    }
  }

  void read_face(const PlyProperty& property) {
    const std::uint64_t place = file_.offset();
    const std::uint64_t count = list_length(property);
    if (count > kMaxCorners) fail(place, fmt::format("a face has {} vertices", count));
    const std::size_t bytes = size_of(property.type);
    const char* at = need(static_cast<std::size_t>(count) * bytes);
    corners_.clear();
    for (std::uint64_t i = 0; i < count; ++i, at += bytes) {
      corners_.push_back(to_index(load_scalar<Swap>(at, property.type)));
    }
    file_.consume(static_cast<std::size_t>(count) * bytes);
    builder_.add_face(corners_, place);
  }

  void read_strip(const PlyProperty& property) {
    StripReader strip(builder_, file_.offset());
    const std::uint64_t count = list_length(property);
    for (std::uint64_t i = 0; i < count; ++i) strip.add(to_index(next_value(property.type)));
  }

  void skip_list(const PlyProperty& property) {
    const std::uint64_t count = list_length(property);
    file_.skip(count * size_of(property.type));
  }

  /// Reads the length of the list that begins here. Checks that the file holds its entries.
  std::uint64_t list_length(const PlyProperty& property) {
    const std::uint64_t place = file_.offset();
    const double length = next_value(property.count_type);
    if (length < 0) {
      fail(place, fmt::format("the list \"{}\" has a negative length", property.name));
    }
    const double room = static_cast<double>(file_.remaining() / size_of(property.type));
    if (length > room) throw_truncated(file_, *element_, row_);
    return static_cast<std::uint64_t>(length);
  }

  double next_value(ScalarType type) {
    const double value = load_scalar<Swap>(need(size_of(type)), type);
    file_.consume(size_of(type));
    return value;
  }

  const char* need(std::size_t bytes) {
    const std::string_view there = file_.peek(bytes);
    if (there.size() < bytes) throw_truncated(file_, *element_, row_);
    return there.data();
  }

  [[noreturn]] void fail(std::uint64_t place, const std::string& cause) const {
    throw ReadError(file_.name(), fmt::format("byte {}", place), cause,
                    "the file is damaged; copy or export it again");
  }

  InputFile& file_;
  ScanBuilder& builder_;
  const PlyElement* element_ = nullptr;
  std::uint64_t row_ = 0;  // of element_
  std::vector<std::int64_t> corners_;
};

}  // namespace

double read_ply_binary(InputFile& file, std::span<const PlyElement> elements, bool swap,
                       ScanBuilder& builder) {
  const auto read_all = [&](auto body) {
    std::uint64_t begin = file.offset();
    for (const PlyElement& element : elements) {
      begin = file.offset();
      body.read(element);
    }
    return file.offset() - begin;
  };
  const PlyElement& last = elements.back();
  const std::uint64_t bytes =
      swap ? read_all(BinaryBody<true>(file, builder)) : read_all(BinaryBody<false>(file, builder));
  if (last.count > 0) return static_cast<double>(bytes) / static_cast<double>(last.count);
  constexpr std::uint64_t kTriangleBytes = 12;
  return static_cast<double>(last.min_row_bytes() + (last.has_list() ? kTriangleBytes : 0));
}

}  // namespace tactree::builder
