#pragma once
// What a test image of one question expects: the first that is not so ends it.

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
