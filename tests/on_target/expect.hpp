#pragma once
// Expectations of a test image; the first failure ends it.

#include "plant_link/semihosting.hpp"

namespace tactree::test {

inline void expect(bool good, const char* sentence) {
  if (!good) {
    firmware::semihosting::print("not so: ");
    firmware::semihosting::print(sentence);
    firmware::semihosting::print("\n");
    firmware::semihosting::exit(1);
  }
}

}  // namespace tactree::test
