#include "comma_evidence.hpp"

#include <algorithm>

#include "number.hpp"
#include "text_fields.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kFewestFields = 3;  // of a point

}  // namespace

void SplitDecimals::look_at(std::string_view row, std::size_t names) {
  std::size_t fields = 0;
  std::string_view field;
  while (take_field(row, ',', field)) {
    const bool fraction = ++fields % 2 == 0;
    const std::string_view digits = field.starts_with('-') ? field.substr(1) : field;
    const bool whole = !digits.empty() && std::all_of(digits.begin(), digits.end(), is_digit);
    possible_ = possible_ && whole && !(fraction && field.starts_with('-'));
    // A field with a leading zero is not a whole number, so it is a fraction.
    seen_ = seen_ || (fraction && field.size() > 1 && field.starts_with('0'));
  }
  possible_ = possible_ && fields % 2 == 0 && fields >= 2 * kFewestFields;
  seen_ = seen_ || (names > 0 && fields >= 2 * names);
}

void Thousands::look_at(std::string_view row, char separator) {
  std::string_view field;
  while (take_field(row, separator, field)) {
    if (field.starts_with('-')) field.remove_prefix(1);
    const std::size_t comma = field.find(',');
    const std::string_view whole = field.substr(0, comma);
    if (!std::all_of(whole.begin(), whole.end(), is_digit)) continue;
    if (comma == std::string_view::npos) {
      without_ = without_ || (whole != "0" && whole.size() <= 3);
      possible_ = possible_ && whole.size() <= 3;
    } else {
      with_ = true;
      possible_ = possible_ && field.size() == comma + 4 && whole != "0" && comma <= 3;
    }
  }
}

}  // namespace tactree::builder
