#pragma once
// Messages of errors.

#include <string>

namespace tactree::test {

/// Message of the `Error` that `act()` throws; empty if it throws none.
template <class Error, class Act>
std::string message_of(const Act& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace tactree::test
