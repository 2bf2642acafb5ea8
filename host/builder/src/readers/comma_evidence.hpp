#pragma once
// What a comma in the rows of a text file stands for: between fields, before decimals, or between
// thousands.

#include <cstddef>
#include <string_view>

namespace tactree::builder {

/// Detects rows such as "1,5,2,25,3,0625", which may be three numbers with decimal commas,
/// separated by commas.
class SplitDecimals {
 public:
  /// `names` is the number of columns that a line names, or 0.
  void look_at(std::string_view row, std::size_t names);
  [[nodiscard]] bool are_likely() const { return possible_ && seen_; }

 private:
  bool possible_ = true;
  bool seen_ = false;
};

/// Detects commas between thousands: "5,280 -963 16,996". A number of three decimals would have a
/// comma in every row, and often a zero before it.
class Thousands {
 public:
  void look_at(std::string_view row, char separator);
  [[nodiscard]] bool are_likely() const { return possible_ && with_ && without_; }
  [[nodiscard]] bool have_commas() const { return with_; }

 private:
  bool possible_ = true;
  bool with_ = false;
  bool without_ = false;
};

}  // namespace tactree::builder
