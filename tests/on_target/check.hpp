#pragma once
// A test program for a controller: no library, no heap. The same sources run on the host.

#include <cstdint>

namespace tactree::test {

/// Counts, and prints a failure with its condition and place.
void check(bool good, const char* sentence, const char* file, std::uint32_t line);
/// The same for a known answer; prints both.
void check_answer(std::uint32_t found, std::uint32_t known, const char* file, std::uint32_t line);
void print(const char* text);
void print_number(std::uint32_t number);
void print_hexadecimal(std::uint32_t number);

// The parts of core_test; main() of the image or of the host program calls them.
void test_arithmetic();
void test_memory();
void test_golden_blobs();
void test_corrupt_blobs();

/// Runs the four and prints the sum. Returns 0 if all passed.
[[nodiscard]] int run_core_tests();

/// Numbers that look random and are the same everywhere.
class Numbers {
 public:
  explicit Numbers(std::uint32_t seed) : state_(seed) {}
  std::uint32_t next() {
    state_ = state_ * 1664525U + 1013904223U;
    return state_ ^ (state_ >> 15U);
  }
  /// Between low and high.
  float between(float low, float high) {
    return low + (high - low) * (static_cast<float>(next() >> 8U) * 0x1p-24F);
  }

 private:
  std::uint32_t state_;
};

}  // namespace tactree::test

#define TACTREE_CHECK(condition) ::tactree::test::check((condition), #condition, __FILE__, __LINE__)
#define TACTREE_CHECK_ANSWER(found, known) \
  ::tactree::test::check_answer((found), (known), __FILE__, __LINE__)
