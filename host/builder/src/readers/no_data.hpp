#pragma once
// The height that stands for missing data in a grid, such as -9999.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace tactree::builder {

/// True for the numbers that programs write where they have no data: only nines, and the ends of
/// 16-bit integers.
[[nodiscard]] inline bool is_no_data_value(double z) {
  const double size = std::abs(z);
  return size == 999.0 || size == 9999.0 || size == 99999.0 || size == 999999.0 || z == -32767.0 ||
         z == -32768.0;
}

/// Takes heights one after the other and keeps the extreme ones.
class NoDataHeight {
 public:
  void add(double z) {
    low_.add(z);
    high_.add(-z);
  }
  /// A value for no data that occurs several times, far above or below all other heights.
  [[nodiscard]] std::optional<double> find() const {
    if (is_no_data_value(low_.first) && low_.is_apart(-high_.first)) return low_.first;
    if (is_no_data_value(-high_.first) && high_.is_apart(-low_.first)) return -high_.first;
    return std::nullopt;
  }

 private:
  static constexpr std::uint64_t kLeast = 3;
  static constexpr double kFar = 3.0;  // in ranges of the other heights

  struct Extreme {
    double first = std::numeric_limits<double>::infinity();
    double second = std::numeric_limits<double>::infinity();  // the next distinct one
    std::uint64_t count = 0;                                  // of the first

    void add(double z) {
      if (z < first) {
        second = first;
        first = z;
        count = 1;
      } else if (z == first) {
        ++count;
      } else {
        second = std::min(second, z);
      }
    }
    [[nodiscard]] bool is_apart(double last) const {
      const double others = last - second;
      return count >= kLeast && others > 0.0 && second - first > kFar * others;
    }
  };
  Extreme low_;
  Extreme high_;  // of the negated heights
};

}  // namespace tactree::builder
